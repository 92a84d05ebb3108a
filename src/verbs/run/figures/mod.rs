//! The figures of runs, in the order a page shows them.

mod panels;
mod places;
mod steps;
mod time;

pub(super) use panels::{id, stroke};

use crate::report::svg::Figure;
use crate::verbs::Report;

/// The figures of `run` and `compare`.
pub const FIGURES: &[Figure<Report>] = &[
    (
        "error.svg",
        "distance from the truth over time",
        time::errors,
    ),
    ("energy.svg", "energy balance over time", time::energy),
    (
        "energy_error.svg",
        "size of the energy error over time",
        time::energy_error,
    ),
    ("plot.svg", "the curve the scene asks for", time::plot),
    ("trajectories.svg", "trajectories", places::trajectories),
    ("phase.svg", "phase portrait", places::phase),
    (
        "steps.svg",
        "what a smaller step does to each engine",
        steps::steps,
    ),
    (
        "rods.svg",
        "error of the rods' lengths over time",
        time::rods,
    ),
];
