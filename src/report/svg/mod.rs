//! Figures as SVG, written by hand: no network, no fonts, equal bytes for equal input.

mod axis;
mod canvas;
mod chart;
mod cost_panels;
mod marks;
mod palette;
mod precision;
mod runs;
mod stability;

use super::{view, words};
use crate::outcome::{Outcome, Report};
use chart::Chart;

/// Pixels; what a page of text is wide.
const WIDTH: f64 = 880.0;
/// What labels call the truth.
const TRUTH_NAME: &str = "truth";
/// Characters of an engine's name that labels have room for.
const NAME: usize = 30;

/// One kind of picture.
pub struct Figure {
    pub file: &'static str,
    /// What the picture shows, for those who do not see it.
    pub description: &'static str,
    /// What there is to draw; `None` where the report does not have what it takes.
    chart: fn(&Report) -> Option<Chart>,
}

impl Figure {
    /// Whether the report has what it takes.
    pub fn wanted(&self, report: &Report) -> bool {
        (self.chart)(report).is_some()
    }
}

/// Of `run` and `compare`.
pub(super) static OF_RUNS: &[Figure] = &[
    Figure {
        file: "plot.svg",
        description: "the curve the scene asks for",
        chart: runs::plot,
    },
    Figure {
        file: "energy.svg",
        description: "energy balance over time",
        chart: runs::energy,
    },
    Figure {
        file: "trajectories.svg",
        description: "trajectories",
        chart: runs::trajectories,
    },
];

/// Of `stability`.
pub(super) static OF_STABILITY: &[Figure] = &[
    Figure {
        file: "stability_map.svg",
        description: "what becomes of a run at each timestep, engine by engine",
        chart: stability::map,
    },
    Figure {
        file: "admissible.svg",
        description: "from where a step does not enlarge the spring's force",
        chart: stability::admissible,
    },
];

/// Of `cost`.
pub(super) static OF_COST: &[Figure] = &[
    Figure {
        file: "cost_time.svg",
        description: "work-precision diagram: error over wall time",
        chart: |report| precision::chart(report, precision::TIME),
    },
    Figure {
        file: "cost_evaluations.svg",
        description: "work-precision diagram: error over force evaluations",
        chart: |report| precision::chart(report, precision::EVALUATIONS),
    },
    Figure {
        file: "cost_energy.svg",
        description: "work-precision diagram: energy error over cost",
        chart: precision::energy,
    },
    Figure {
        file: "cost_panels.svg",
        description: "each integrator at a few steps beside the truth, and the difference below",
        chart: cost_panels::chart,
    },
];

/// The figures this report has data for.
pub(super) fn wanted(report: &Report) -> impl Iterator<Item = &'static Figure> {
    let figures = view(report).figures().iter();
    figures.filter(|figure| figure.wanted(report))
}

/// Those figures: file name and SVG.
pub fn figures(report: &Report) -> Vec<(&'static str, String)> {
    let drawn = |figure: &Figure| Some((figure.file, (figure.chart)(report)?.draw()));
    view(report).figures().iter().filter_map(drawn).collect()
}

/// A figure's title: the scene, then what is shown.
fn heading(report: &Report, shown: &str) -> String {
    let scene = shortened(&words::one_line(&report.header.scene.name), 45);
    format!("{scene}: {}", shortened(&words::one_line(shown), 50))
}

/// The engine as labels call it, with the time it got to if it ended early.
fn name(outcome: &Outcome) -> String {
    let name = shortened(&words::one_line(&words::engine(outcome)), NAME);
    match outcome.stopped_at_s {
        Some(t) => format!("{name}, to {} s", words::short(t)),
        None => name,
    }
}

/// A panel's title where each engine has one; the scene's own integrator is pointed at.
fn panel_title(report: &Report, engine: &str) -> String {
    let name = shortened(&words::one_line(engine), NAME);
    if engine == report.header.scene.own_integrator {
        return format!("▸ {name}");
    }
    name
}

fn shortened(text: &str, characters: usize) -> String {
    if text.chars().count() <= characters {
        return text.to_string();
    }
    let head: String = text.chars().take(characters - 1).collect();
    head + "…"
}
