//! The answers, the rankings and every setting as GitHub shows them.

use super::{answer, facts, metres, ratio, table, tried};
use crate::report::View;
use crate::report::markdown::{checks, heading, images, remarks, scene, section};
use crate::report::table::{Mark, Table};
use crate::report::words::escape;
use crate::report::words::{self, NOTHING};
use crate::verbs::Report;
use crate::verbs::cost::{Cost, CostCurve, CostPoint, CostRank, CostTarget};

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
    let duration = format!("{} s", words::short(cost.duration_s));
    let mut more = vec![("duration", duration)];
    more.extend(facts(report, cost));
    let answers = answer::paragraphs(cost).into_iter();
    let answers =
        answers.map(|(label, said)| format!("- **{}**: {}\n", escape(&label), escape(&said)));
    let mut text = heading(report) + &scene(report, more);
    text += &section("Answer", answers.collect());
    text += &images(report);
    text += "## Engines\n\n";
    text += &table(report, cost).in_markdown();
    for target in cost.targets.iter().filter(|target| target.reason.is_none()) {
        text += &ranking(report, target);
    }
    text += &settings(cost);
    text += &remarks(&cost.notes(report));
    text += &checks(&report.header.checks);
    text + LEGEND
}

fn cell(text: Option<String>) -> String {
    text.unwrap_or(NOTHING.into())
}

/// One target's: the places, then those without one.
fn ranking(report: &Report, target: &CostTarget) -> String {
    let own = &report.header.scene.own_integrator;
    let places = target.ranking.iter().enumerate().map(|(at, rank)| {
        let place = rank.reached.as_ref().map(|_| (at + 1).to_string());
        (cell(place), rank)
    });
    let beside = target
        .reference
        .iter()
        .map(|rank| ("not ranked".to_owned(), rank));
    let rows: Vec<(String, &CostRank)> = places.chain(beside).collect();
    let reached = |rank: &CostRank| rank.reached.clone();
    let mut table = Table::new(&rows);
    table.markdown("place", |(place, _)| place.clone());
    table.engines(|(_, rank)| (rank.engine.clone(), Mark::of(&rank.engine, own)));
    table.markdown("h (s)", |(_, rank)| {
        cell(reached(rank).map(|r| words::short(r.timestep)))
    });
    let tolerance = |rank: &CostRank| reached(rank).and_then(|reached| reached.tolerance);
    if rows.iter().any(|(_, rank)| tolerance(rank).is_some()) {
        table.markdown("tolerance", |(_, rank)| cell(tolerance(rank).map(metres)));
    }
    table.markdown("error (m)", |(_, rank)| {
        cell(reached(rank).map(|r| words::sci(r.error_m)))
    });
    table.markdown("time", |(_, rank)| {
        let wall = reached(rank).and_then(|r| r.wall_median_s);
        cell(wall.map(words::seconds))
    });
    table.markdown("ratio", |(_, rank)| cell(dear(rank)));
    table.markdown("force evaluations", |(_, rank)| {
        let count = reached(rank).and_then(|r| r.force_evaluations);
        cell(count.map(words::count))
    });
    table.markdown("remark", |(_, rank)| {
        rank.reason.as_deref().map(escape).unwrap_or_default()
    });
    format!(
        "## To {}\n\n{}",
        escape(&answer::label(target)),
        table.in_markdown()
    )
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
    let rows: Vec<(usize, &CostPoint)> = curve.points.iter().enumerate().collect();
    let mut table = Table::new(&rows);
    table.markdown("h (s)", |(_, point)| words::short(point.timestep));
    if any(|point| point.tolerance.is_some()) {
        table.markdown("tolerance", |(_, point)| cell(point.tolerance.map(metres)));
    }
    table.markdown("steps", |(_, point)| words::count(point.steps));
    table.markdown("status", |(_, point)| words::status(point.status).into());
    let mut number = |header, value: fn(&CostPoint) -> Option<f64>, text: fn(f64) -> String| {
        table.markdown(header, |(_, point)| cell(value(point).map(text)));
    };
    number("error (m)", |point| point.error_m, words::sci);
    number(
        "error at the end (m)",
        |point| point.error_final_m,
        words::sci,
    );
    number("energy error", |point| point.energy_error, words::sci);
    number(
        "time",
        |point| Some(point.wall_s.as_ref()?.median),
        words::seconds,
    );
    number(
        "least",
        |point| Some(point.wall_s.as_ref()?.min),
        words::seconds,
    );
    number(
        "spread (MAD)",
        |point| point.wall_s.as_ref()?.mad,
        words::seconds,
    );
    let mut count = |header, value: fn(&CostPoint) -> Option<u64>| {
        table.markdown(header, |(_, point)| cell(value(point).map(words::count)));
    };
    count("force evaluations", |point| point.force_evaluations);
    if any(|point| point.linear_solves.is_some_and(|n| n > 0)) {
        count("linear solves", |point| point.linear_solves);
    }
    if any(|point| point.newton_iterations.is_some_and(|n| n > 0)) {
        count("Newton iterations", |point| point.newton_iterations);
    }
    table.markdown("remark", |(at, point)| remark(curve, *at, point));
    table.in_markdown()
}

fn remark(curve: &CostCurve, at: usize, point: &CostPoint) -> String {
    let mut marks = Vec::new();
    marks.extend(curve.pareto.contains(&at).then(|| "Pareto".to_owned()));
    marks.extend(curve.slope_points.contains(&at).then(|| "slope".to_owned()));
    marks.extend(point.at_floor.then(|| "floor".to_owned()));
    marks.extend(point.reason.as_deref().map(escape));
    marks.join(", ")
}
