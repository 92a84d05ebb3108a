//! Figures as SVG, written by hand: no network, no fonts, equal bytes for equal input.

mod admissible;
mod canvas;
mod chart;
mod cost_panels;
mod energy;
mod frame;
mod grid;
mod heat;
mod labels;
mod line;
mod palette;
mod panels;
mod plot;
mod precision;
mod range;
mod scale;
mod trajectories;

use super::words;
use crate::outcome::{Outcome, Report};

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
    /// Whether the report has what it takes.
    pub wanted: fn(&Report) -> bool,
    /// The whole SVG file.
    pub draw: fn(&Report) -> String,
}

/// Every figure there is, in the order reports show them.
pub const FIGURES: &[Figure] = &[
    Figure {
        file: "plot.svg",
        description: "the curve the scene asks for",
        wanted: plot::wanted,
        draw: plot::draw,
    },
    Figure {
        file: "energy.svg",
        description: "energy balance over time",
        wanted: energy::wanted,
        draw: energy::draw,
    },
    Figure {
        file: "trajectories.svg",
        description: "trajectories",
        wanted: trajectories::wanted,
        draw: trajectories::draw,
    },
    Figure {
        file: "stability_map.svg",
        description: "what becomes of a run at each timestep, engine by engine",
        wanted: heat::wanted,
        draw: heat::draw,
    },
    Figure {
        file: "admissible.svg",
        description: "from where a step does not enlarge the spring's force",
        wanted: admissible::wanted,
        draw: admissible::draw,
    },
    Figure {
        file: "cost_time.svg",
        description: "work-precision diagram: error over wall time",
        wanted: |report| precision::wanted(report, precision::TIME),
        draw: |report| precision::draw(report, precision::TIME),
    },
    Figure {
        file: "cost_evaluations.svg",
        description: "work-precision diagram: error over force evaluations",
        wanted: |report| precision::wanted(report, precision::EVALUATIONS),
        draw: |report| precision::draw(report, precision::EVALUATIONS),
    },
    Figure {
        file: "cost_energy.svg",
        description: "work-precision diagram: energy error over cost",
        wanted: |report| precision::wanted(report, precision::energy(report)),
        draw: |report| precision::draw(report, precision::energy(report)),
    },
    Figure {
        file: "cost_panels.svg",
        description: "each integrator at a few steps beside the truth, and the difference below",
        wanted: cost_panels::wanted,
        draw: cost_panels::draw,
    },
];

/// The figures this report has data for: file name and SVG.
pub fn figures(report: &Report) -> Vec<(&'static str, String)> {
    let wanted = FIGURES.iter().filter(|figure| (figure.wanted)(report));
    wanted
        .map(|figure| (figure.file, (figure.draw)(report)))
        .collect()
}

/// A figure's title: the scene, then what is shown.
fn heading(report: &Report, shown: &str) -> String {
    let scene = shortened(&words::one_line(&report.scene.name), 45);
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

fn shortened(text: &str, characters: usize) -> String {
    if text.chars().count() <= characters {
        return text.to_string();
    }
    let head: String = text.chars().take(characters - 1).collect();
    head + "…"
}
