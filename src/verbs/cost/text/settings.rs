//! The rankings and every setting, in Markdown.

use super::{answer, at_most, metres, ratio, tried};
use crate::report::markdown::section;
use crate::report::table::Table;
use crate::report::words::{self, escape};
use crate::verbs::Report;
use crate::verbs::clock::WallTime;
use crate::verbs::cost::{Cost, CostCurve, CostPoint, CostRank, CostTarget};

/// The ranking of one target: integrators by place, then those without one, then reference engines.
pub fn ranking(report: &Report, target: &CostTarget) -> String {
    let header = &report.header;
    let places = target.ranking.iter().enumerate().map(|(at, rank)| {
        let place = rank.reached.as_ref().map(|_| (at + 1).to_string());
        (place, rank)
    });
    let beside = target.reference.iter();
    let beside = beside.map(|rank| (Some("not ranked".to_owned()), rank));
    let rows: Vec<(Option<String>, &CostRank)> = places.chain(beside).collect();
    let tolerance = |rank: &CostRank| rank.reached.as_ref()?.tolerance;
    let mut table = Table::new(&rows);
    table.markdown("place", |(place, _)| place.clone());
    table.engines(|(_, rank)| (rank.engine.clone(), header.mark(&rank.engine)));
    table.markdown("h (s)", |(_, rank)| {
        rank.reached.as_ref().map(|r| words::short(r.timestep))
    });
    if rows.iter().any(|(_, rank)| tolerance(rank).is_some()) {
        table.markdown("tolerance", |(_, rank)| tolerance(rank).map(metres));
    }
    table.markdown("error (m)", |(_, rank)| {
        rank.reached.as_ref().map(|r| words::sci(r.error_m))
    });
    table.markdown("time", |(_, rank)| {
        let reached = rank.reached.as_ref()?;
        let time = words::seconds(reached.wall_median_s?);
        Some(at_most(reached) + &time)
    });
    table.markdown("ratio", |(_, rank)| cost_ratio(rank));
    table.markdown("force evaluations", |(_, rank)| {
        rank.reached.as_ref()?.force_evaluations.map(words::count)
    });
    table.markdown("remark", |(_, rank)| {
        rank.reason.as_deref().map(escape).unwrap_or_default()
    });
    let title = format!("To {}", escape(&answer::label(target)));
    section(&title, table.in_markdown())
}

/// The time in units of the cheapest, extrapolated by the slope where no setting reaches the target.
fn cost_ratio(rank: &CostRank) -> Option<String> {
    let guessed = rank.extrapolated_wall_ratio;
    let guessed = guessed.map(|times| format!("about {} by its slope", ratio(times)));
    rank.wall_ratio.map(ratio).or(guessed)
}

/// Every point of every engine, folded away.
pub fn all(cost: &Cost) -> String {
    let mut text = String::from("## Every setting\n\n");
    for curve in &cost.curves {
        text += &format!(
            "**{}**\n\n<details><summary>settings: {}</summary>\n\n{}\n</details>\n\n",
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
    table.markdown("h (s)", |(_, p)| words::short(p.timestep));
    if any(|p| p.tolerance.is_some()) {
        table.markdown("tolerance", |(_, p)| p.tolerance.map(metres));
    }
    table.markdown("steps", |(_, p)| words::count(p.steps));
    table.markdown("status", |(_, p)| words::id(p.status));
    table.markdown("error (m)", |(_, p)| p.error_m.map(words::sci));
    table.markdown("error at the end (m)", |(_, p)| {
        p.error_final_m.map(words::sci)
    });
    table.markdown("energy error", |(_, p)| p.energy_error.map(words::sci));
    let mut time = |header, value: fn(&WallTime) -> Option<f64>| {
        table.markdown(header, |(_, p)| {
            value(p.wall_s.as_ref()?).map(words::seconds)
        });
    };
    time("time", |wall| Some(wall.median));
    time("least", |wall| Some(wall.min));
    time("spread (MAD)", |wall| wall.mad);
    table.markdown("force evaluations", |(_, p)| {
        p.force_evaluations.map(words::count)
    });
    if any(|p| p.linear_solves.is_some_and(|n| n > 0)) {
        table.markdown("linear solves", |(_, p)| p.linear_solves.map(words::count));
    }
    if any(|p| p.newton_iterations.is_some_and(|n| n > 0)) {
        table.markdown("Newton iterations", |(_, p)| {
            p.newton_iterations.map(words::count)
        });
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
