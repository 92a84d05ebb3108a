//! Small multiples: one panel for each engine, with one line for each timestep, where several ran.

use super::panels::{Paths, Runs, by_timestep, over_time};
use crate::report::svg::{
    Chart, ChartAxis, HUGE, LegendEntry, Look, Mark, Panel, Polyline, Scale, heading, palette,
    panel_title, range,
};
use crate::verbs::Report;
use crate::verbs::run::Curves;

/// The panels of a row, and of a figure at most.
const COLUMNS: usize = 3;
const MOST: usize = 12;
/// The smallest error that is drawn.
const LEAST: f64 = 1e-17;

/// Distance from the truth over time, or the size of the energy error where no truth is known.
pub fn steps(report: &Report) -> Option<Chart> {
    let known = report.run_series().curves.iter();
    let known = known.filter(|run| run.errors.len() > 1).count() > 0;
    let (what, unit): (fn(&Curves) -> &[f64], _) = match known {
        true => (|run| &run.errors, "m from the truth"),
        false => (|run| &run.energy, "|B − B(0)| / S"),
    };
    let later = |run: &Curves| match what(run) {
        [] | [_] => Paths::new(),
        [_, later @ ..] => {
            let sizes: Vec<f64> = later.iter().map(|size| size.abs().max(LEAST)).collect();
            over_time(run.t.get(1..).unwrap_or_default(), &sizes)
        }
    };
    let by_timestep = by_timestep(report, |_| Paths::new(), later)?;
    if by_timestep.len() < 2 {
        return None;
    }
    let mut engines: Vec<&str> = Vec::new();
    for (outcome, _) in &by_timestep[0].runs {
        if !engines.contains(&outcome.engine.as_str()) {
            engines.push(&outcome.engine);
        }
    }
    engines.truncate(MOST);
    let lines = |engine: &str| -> Vec<Polyline> {
        let of = |(at, panel): (usize, &Runs)| {
            let (_, paths) = panel.runs.iter().find(|(o, _)| o.engine == engine)?;
            Some(Polyline::new(paths.first()?.clone(), palette::timestep(at)))
        };
        by_timestep.iter().enumerate().filter_map(of).collect()
    };
    let all: Vec<(&str, Vec<Polyline>)> = engines.iter().map(|one| (*one, lines(one))).collect();
    let points = || {
        all.iter()
            .flat_map(|(_, lines)| lines)
            .flat_map(|line| &line.points)
    };
    let [from, to] = range(points().map(|point| point[0]))?;
    let [low, high] = range(points().map(|point| point[1]))?;
    let axes = [
        ChartAxis::linear([from, to]),
        ChartAxis {
            scale: Scale::Log,
            range: [
                low.clamp(LEAST, HUGE) / 2.0,
                high.clamp(10.0 * LEAST, HUGE) * 2.0,
            ],
        },
    ];
    let panels = all.into_iter().map(|(engine, lines)| {
        let marks = lines.into_iter().map(Mark::Line).collect();
        Panel::new(panel_title(&report.header, engine), 150.0, axes, marks)
    });
    let legend = by_timestep.iter().enumerate().map(|(at, panel)| {
        LegendEntry::new(panel.title.clone(), Look::Line(palette::timestep(at)))
    });
    Some(Chart {
        title: heading(&report.header, "what a smaller step does"),
        legend: legend.collect(),
        titles: ["time (s)", unit].map(str::to_owned),
        panels: panels.collect(),
        columns: COLUMNS,
        ..Chart::default()
    })
}
