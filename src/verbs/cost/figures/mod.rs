//! The figures of `cost`.

mod panels;
mod precision;

use crate::verbs::cost::CostPoint;
use crate::verbs::formats::Figure;

/// The figures of `cost`.
pub const FIGURES: &[Figure] = &[
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

/// Which numbers a work-precision diagram shows: an error over a cost.
#[derive(Clone, Copy)]
pub struct Diagram {
    /// Whether the error is the one targets, floor, front and slope are about; else that of the energy.
    pub judged: bool,
    /// Whether the cost is a time, which has a spread; else force evaluations.
    pub timed: bool,
}

impl Diagram {
    pub fn cost(self, point: &CostPoint) -> Option<f64> {
        if self.timed {
            point.wall_s.as_ref().map(|wall| wall.median)
        } else {
            point.force_evaluations.map(|count| count as f64)
        }
    }

    pub fn error(self, point: &CostPoint) -> Option<f64> {
        if self.judged {
            point.error_m
        } else {
            point.energy_error
        }
    }
}
