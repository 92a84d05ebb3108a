//! The result of `cost` in words: how settings, costs and ratios are written.

mod answer;
mod notes;
mod scatter;
mod settings;
mod terminal;
mod verdict;

use crate::report::markdown::{findings, opening, section};
use crate::report::table::Table;
use crate::report::words::{self, NOTHING, escape};
use crate::report::{UNRANKED, View};
use crate::solvers::Status;
use crate::verbs::Report;
use crate::verbs::cost::{Cost, CostCurve, CostPoint, CostReached};

const LEGEND: &str = "\
## How to read this

- **Error** is the largest distance of any particle from where it truly is, over the horizon; *floor* means that nothing
  smaller could be told from the truth. **Energy error** is the largest |B - B(0)| / S of the energy balance over the
  run.
- **Reached**: the coarsest setting from which on every finer one of that engine has no larger error than the target.
- **Slope** is that of ln(error) over ln(step), fitted below the coarse steps and above the floor: the order, as found.
- **Pareto**: no other setting of that engine has both a smaller error and fewer force evaluations.
- **Time** is the median of repeated runs, which do not share a core with others; it varies from run to run, and with it the order of
  the rankings. Evaluations do not.
- rapier is explained and not ranked: its distance from the truth is no error, since it follows equations of its own on
  purpose.
";

/// The parts that the terminal and the page have in common.
pub fn view<'a>(report: &'a Report, cost: &Cost, columns: usize) -> View<'a> {
    View {
        columns,
        header: &report.header,
        timesteps: Vec::new(),
        clauses: verdict::clauses(report, cost),
        facts: facts(report, cost),
        lines: terminal::lines(report, cost, columns),
        notes: notes::notes(cost),
        last: Vec::new(),
    }
}

/// The page in Markdown.
pub fn page(report: &Report, cost: &Cost, view: &View) -> String {
    let mut more = vec![("duration", format!("{} s", words::short(cost.duration_s)))];
    more.extend(facts(report, cost));
    let answers = answer::paragraphs(cost).into_iter();
    let answers =
        answers.map(|(label, said)| format!("- **{}**: {}\n", escape(&label), escape(&said)));
    let judged = cost.targets.iter().filter(|target| target.reason.is_none());
    let rankings = judged.map(|target| settings::ranking(report, target));
    [
        opening(view, more),
        section("Answer", answers.collect()),
        report.images(),
        section("Engines", table(report, cost).in_markdown()),
        rankings.collect(),
        settings::all(cost),
        findings(view),
        LEGEND.to_owned(),
    ]
    .concat()
}

/// The table of engines, in the terminal and in Markdown; in the terminal it also has the targets.
fn table<'a>(report: &Report, cost: &'a Cost) -> Table<'a, CostCurve> {
    let header = &report.header;
    let timed = is_timed(cost);
    let paid = if timed { "time" } else { "evaluations" };
    let mut table = Table::new(&cost.curves);
    table.engines(|curve| {
        let mark = match header.mark(&curve.engine) {
            ' ' if !curve.is_ranked() => UNRANKED,
            mark => mark,
        };
        (curve.engine.clone(), mark)
    });
    table.right("order", "order", 4, |curve| {
        curve.order.map(|order| order.to_string())
    });
    table.right("slope", "slope", 2, slope);
    for target in cost.targets.iter().filter(|target| target.reason.is_none()) {
        let header = format!("{}\nh (s), {paid}", answer::label(target));
        table.toned(&header, 1, |curve| terminal::cell(target, curve, timed));
    }
    table.right(
        "smallest\nerror (m)",
        "smallest error (m)",
        3,
        nearest_error,
    );
    table.right("energy\nerror", "smallest energy error", 5, |curve| {
        let energy = |point: &CostPoint| point.energy_error;
        energy(smallest(curve, energy)?).map(words::sci)
    });
    table.right("settings", "settings", 6, tried);
    table
}

/// A target or a floor, at most two digits: `1e-6`, `2.5e-4`.
pub fn metres(value: f64) -> String {
    match value {
        0.0 => "0".to_owned(),
        _ => format!("{value:.1e}").replacen(".0e", "e", 1),
    }
}

/// `h = 0.02 s`, or an adaptive pair's tolerance and mean step.
fn setting(timestep: f64, tolerance: Option<f64>) -> String {
    let h = words::short(timestep);
    match tolerance {
        Some(tolerance) => format!("tolerance {} (mean h = {h} s)", metres(tolerance)),
        None => format!("h = {h} s"),
    }
}

/// The setting in few characters, for tables: `0.02`, `tol 1e-8`.
fn brief(timestep: f64, tolerance: Option<f64>) -> String {
    match tolerance {
        Some(tolerance) => format!("tol {}", metres(tolerance)),
        None => words::short(timestep),
    }
}

fn evaluations(count: u64) -> String {
    words::plural(count, "evaluation")
}

/// `0.10 ms (1,000 evaluations)`, or as much of it as is known.
fn price(reached: &CostReached) -> String {
    let count = reached.force_evaluations.map(evaluations);
    let paid = match (reached.wall_median_s, count) {
        (Some(wall), Some(count)) => format!("{} ({count})", words::seconds(wall)),
        (Some(wall), None) => words::seconds(wall),
        (None, Some(count)) => count,
        (None, None) => return "not timed".to_owned(),
    };
    at_most(reached) + &paid
}

/// The words before a price that is the coarsest setting's.
fn at_most(reached: &CostReached) -> String {
    let words = if reached.at_most { "at most " } else { "" };
    words.to_owned()
}

/// A ratio of costs, two digits: `1.3x`, `18x`, `6,200x`.
fn ratio(value: f64) -> String {
    if !value.is_finite() {
        return NOTHING.into();
    }
    match value {
        v if !(0.0995..995_000.0).contains(&v) => format!("{}x", words::sci(v)),
        v if v < 0.995 => format!("{v:.2}x"),
        v if v < 9.95 => format!("{v:.1}x"),
        v => {
            // The value is below a million, so this is exact.
            let power = 10_f64.powf(v.log10().floor() - 1.0);
            let rounded = (v / power).round() * power;
            format!("{}x", words::count(rounded.round() as u64))
        }
    }
}

/// The point with the smallest error against the truth.
fn nearest(curve: &CostCurve) -> Option<&CostPoint> {
    smallest(curve, |point| point.error_m)
}

/// The completed point where `value` is smallest, the first of equal ones.
fn smallest(curve: &CostCurve, value: fn(&CostPoint) -> Option<f64>) -> Option<&CostPoint> {
    let known = |point: &&CostPoint| point.status == Status::Completed && value(point).is_some();
    let size = |point: &CostPoint| value(point).unwrap_or(f64::INFINITY);
    let points = curve.points.iter().filter(known);
    points.min_by(|a, b| size(a).total_cmp(&size(b)))
}

/// The smallest error, or `floor` where it could not be told from the truth's own.
fn nearest_error(curve: &CostCurve) -> Option<String> {
    let point = nearest(curve)?;
    let floor = point.at_floor.then(|| "floor".to_owned());
    floor.or(point.error_m.map(words::sci))
}

/// How many settings were tried, and how many of them completed where not all did.
fn tried(curve: &CostCurve) -> String {
    let all = curve.points.len();
    let done = |point: &&CostPoint| point.status == Status::Completed;
    match curve.points.iter().filter(done).count() {
        done if done == all => all.to_string(),
        done => format!("{done} of {all}"),
    }
}

/// The fitted order: two decimals.
fn slope(curve: &CostCurve) -> Option<String> {
    Some(match curve.observed_order? {
        order if order.abs() < 99.5 => format!("{order:.2}"),
        order => words::sci(order),
    })
}

/// Whether anything was timed.
pub fn is_timed(cost: &Cost) -> bool {
    let mut points = cost.curves.iter().flat_map(|curve| &curve.points);
    points.any(|point| point.wall_s.is_some())
}

/// The facts about the whole answer, line by line: label and text.
fn facts(report: &Report, cost: &Cost) -> Vec<(&'static str, String)> {
    let errors = cost.horizon_s.map(|horizon| {
        let all = words::short(cost.duration_s);
        let until = match horizon < cost.duration_s {
            true => format!("{} of {all} s", words::short(horizon)),
            false => format!("{all} s, the whole run"),
        };
        format!("the largest distance of a particle from the truth up to {until}")
    });
    let floor = cost.floor_m.map(metres);
    let floor = floor.map(|floor| {
        format!("{floor} m: errors below ten times the truth's own bar are not told apart")
    });
    let mut facts = vec![("truth", words::truth(&report.header.truth))];
    facts.extend(errors.map(|errors| ("errors", errors)));
    facts.extend(floor.map(|floor| ("floor", floor)));
    facts
}

#[cfg(test)]
mod tests {
    use super::{metres, ratio};

    #[test]
    fn ratios_have_two_digits() {
        for (value, text) in [
            (0.5, "0.50x"),
            (1.0, "1.0x"),
            (1.26, "1.3x"),
            (9.949, "9.9x"),
            (9.96, "10x"),
            (17.7, "18x"),
            (994.0, "990x"),
            (6_203.0, "6,200x"),
            (994_000.0, "990,000x"),
            (996_000.0, "1.0e6x"),
            (2.5e7, "2.5e7x"),
            (1e-3, "1.0e-3x"),
            (f64::NAN, "-"),
        ] {
            assert_eq!(ratio(value), text);
        }
    }

    #[test]
    fn targets_are_as_short_as_they_were_typed() {
        for (value, text) in [
            (1e-6, "1e-6"),
            (2.5e-4, "2.5e-4"),
            (0.01, "1e-2"),
            (0.0, "0"),
        ] {
            assert_eq!(metres(value), text);
        }
    }
}
