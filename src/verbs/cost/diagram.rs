//! The numbers a work-precision diagram shows, as a figure and in characters.

use super::CostPoint;

/// The numbers a work-precision diagram shows: an error over a cost.
#[derive(Clone, Copy)]
pub struct Diagram {
    /// Whether the error is that of positions, which targets, floor, Pareto front and slope are about;
    /// else it is that of the energy.
    pub judged: bool,
    /// Whether the cost is a wall time, which has a spread; else it is force evaluations.
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
