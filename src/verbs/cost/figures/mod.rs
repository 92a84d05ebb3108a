//! The figures of `cost`.

mod panels;
mod precision;

use crate::report::svg::Figure;
use crate::verbs::Report;

/// The figures of `cost`.
pub const FIGURES: &[Figure<Report>] = &[
    (
        "cost_time.svg",
        "work-precision diagram: error over wall time",
        precision::time,
    ),
    (
        "cost_evaluations.svg",
        "work-precision diagram: error over force evaluations",
        precision::evaluations,
    ),
    (
        "cost_energy.svg",
        "work-precision diagram: energy error over cost",
        precision::energy,
    ),
    (
        "cost_panels.svg",
        "each integrator at a few steps beside the truth, and the difference below",
        panels::chart,
    ),
];
