//! The answers, the rankings and every setting as GitHub shows them.

use super::notes::notes;
use super::{answer, facts, metres, nearest_energy, nearest_error, order, ratio, slope, tried};
use crate::outcome::{Cost, CostCurve, CostPoint, CostRank, CostTarget, Report};
use crate::report::markdown::{checks, escape, heading, images, table};
use crate::report::words::{self, NOTHING};

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

/// One report, with its figures linked as files beside it.
pub fn render(report: &Report, cost: &Cost) -> String {
    let mut text = heading(report);
    text += &scene(report, cost);
    if !cost.targets.is_empty() {
        text += "## Answer\n\n";
        for (label, said) in answer::paragraphs(cost) {
            text += &format!("- **{}**: {}\n", escape(&label), escape(&said));
        }
        text += "\n";
    }
    text += &images(report);
    text += "## Engines\n\n";
    text += &engines(report, cost);
    for target in cost.targets.iter().filter(|target| target.reason.is_none()) {
        text += &ranking(report, target);
    }
    text += &settings(cost);
    text += &remarks(cost);
    text += &checks(&report.checks);
    text + LEGEND
}

fn scene(report: &Report, cost: &Cost) -> String {
    let scene = &report.scene;
    let mut rows = vec![
        vec!["file".to_owned(), escape(&scene.file)],
        vec!["particles".to_owned(), scene.particles.to_string()],
        vec!["springs".to_owned(), scene.springs.to_string()],
        vec!["own integrator".to_owned(), escape(&scene.own_method)],
        vec![
            "duration".to_owned(),
            format!("{} s", words::short(cost.duration_s)),
        ],
    ];
    let facts = facts(report, cost).into_iter();
    rows.extend(facts.map(|(label, text)| vec![label.to_owned(), escape(&text)]));
    table(&["scene", ""], &rows)
}

fn named(report: &Report, engine: &str) -> String {
    let name = escape(engine);
    if engine == report.scene.own_method {
        format!("**{name}**")
    } else {
        name
    }
}

fn engines(report: &Report, cost: &Cost) -> String {
    let header = [
        "engine",
        "order",
        "slope",
        "smallest error (m)",
        "smallest energy error",
        "settings",
    ];
    let row = |curve: &CostCurve| {
        vec![
            named(report, &curve.engine),
            order(curve),
            slope(curve),
            nearest_error(curve),
            nearest_energy(curve),
            tried(curve),
        ]
    };
    let rows: Vec<Vec<String>> = cost.curves.iter().map(row).collect();
    table(&header, &rows)
}

/// One target's: the places, then those without one.
fn ranking(report: &Report, target: &CostTarget) -> String {
    let title = format!("## To {}\n\n", escape(&answer::label(target)));
    let ranks = || target.ranking.iter().chain(&target.reference);
    let adaptive = ranks().any(|rank| {
        let reached = rank.reached.as_ref();
        reached.is_some_and(|reached| reached.tolerance.is_some())
    });
    let mut header = vec!["place", "engine", "h (s)"];
    header.extend(adaptive.then_some("tolerance"));
    header.extend(["error (m)", "time", "ratio", "force evaluations", "remark"]);
    let row = |(place, rank): (String, &CostRank)| {
        let reached = rank.reached.as_ref();
        let cell = |text: Option<String>| text.unwrap_or(NOTHING.into());
        let mut cells = vec![
            place,
            named(report, &rank.engine),
            cell(reached.map(|r| words::short(r.timestep))),
        ];
        if adaptive {
            cells.push(cell(reached.and_then(|r| r.tolerance).map(metres)));
        }
        cells.extend([
            cell(reached.map(|r| words::sci(r.error_m))),
            cell(reached.and_then(|r| r.wall_median_s).map(words::seconds)),
            cell(dear(rank)),
            cell(reached.and_then(|r| r.force_evaluations).map(words::count)),
            rank.reason.as_deref().map(escape).unwrap_or_default(),
        ]);
        cells
    };
    let places = target.ranking.iter().enumerate().map(|(at, rank)| {
        let place = rank.reached.as_ref().map(|_| (at + 1).to_string());
        (place.unwrap_or(NOTHING.into()), rank)
    });
    let beside = target
        .reference
        .iter()
        .map(|rank| ("not ranked".to_owned(), rank));
    let rows: Vec<Vec<String>> = places.chain(beside).map(row).collect();
    title + &table(&header, &rows)
}

/// How many times as dear, by the slope where no setting tried reaches the target.
fn dear(rank: &CostRank) -> Option<String> {
    let guessed = rank.extrapolated_wall_ratio;
    let guessed = guessed.map(|dear| format!("about {} by its slope", ratio(dear)));
    rank.wall_ratio.map(ratio).or(guessed)
}

/// Every point of every engine, folded away.
fn settings(cost: &Cost) -> String {
    let mut text = String::from("## Every setting\n\n");
    for curve in &cost.curves {
        text += &format!(
            "**{}**\n\n<details><summary>settings: {}</summary>\n\n{}</details>\n\n",
            escape(&curve.engine),
            tried(curve),
            points(curve)
        );
    }
    text
}

fn points(curve: &CostCurve) -> String {
    let any = |wanted: fn(&CostPoint) -> bool| curve.points.iter().any(wanted);
    let adaptive = any(|point| point.tolerance.is_some());
    let solves = any(|point| point.linear_solves.is_some_and(|n| n > 0));
    let newton = any(|point| point.newton_iterations.is_some_and(|n| n > 0));
    let mut header = vec!["h (s)"];
    header.extend(adaptive.then_some("tolerance"));
    header.extend([
        "steps",
        "status",
        "error (m)",
        "error at the end (m)",
        "energy error",
        "time",
        "least",
        "spread (MAD)",
        "force evaluations",
    ]);
    header.extend(solves.then_some("linear solves"));
    header.extend(newton.then_some("Newton iterations"));
    header.push("remark");
    let row = |(at, point): (usize, &CostPoint)| {
        let cell = |text: Option<String>| text.unwrap_or(NOTHING.into());
        let count = |n: Option<u64>| cell(n.map(words::count));
        let wall = point.wall_s.as_ref();
        let mut cells = vec![words::short(point.timestep)];
        cells.extend(adaptive.then(|| cell(point.tolerance.map(metres))));
        cells.extend([
            words::count(point.steps),
            words::status(point.status).to_owned(),
            cell(point.error_m.map(words::sci)),
            cell(point.error_final_m.map(words::sci)),
            cell(point.energy_error.map(words::sci)),
            cell(wall.map(|wall| words::seconds(wall.median))),
            cell(wall.map(|wall| words::seconds(wall.min))),
            cell(wall.and_then(|wall| wall.mad).map(words::seconds)),
            count(point.force_evaluations),
        ]);
        cells.extend(solves.then(|| count(point.linear_solves)));
        cells.extend(newton.then(|| count(point.newton_iterations)));
        cells.push(remark(curve, at, point));
        cells
    };
    let rows: Vec<Vec<String>> = curve.points.iter().enumerate().map(row).collect();
    table(&header, &rows)
}

fn remark(curve: &CostCurve, at: usize, point: &CostPoint) -> String {
    let mut marks = Vec::new();
    marks.extend(curve.pareto.contains(&at).then(|| "Pareto".to_owned()));
    marks.extend(curve.slope_points.contains(&at).then(|| "slope".to_owned()));
    marks.extend(point.at_floor.then(|| "floor".to_owned()));
    marks.extend(point.reason.as_deref().map(escape));
    marks.join(", ")
}

fn remarks(cost: &Cost) -> String {
    let notes = notes(cost);
    if notes.is_empty() {
        return String::new();
    }
    let line = |(subject, sentence): &(String, String)| match subject.as_str() {
        "" => format!("- {}\n", escape(sentence)),
        subject => format!("- **{}**: {}\n", escape(subject), escape(sentence)),
    };
    format!(
        "## Remarks\n\n{}\n",
        notes.iter().map(line).collect::<String>()
    )
}
