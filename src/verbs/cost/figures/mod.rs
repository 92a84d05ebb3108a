//! The figures of `cost`.

mod panels;
mod precision;

use crate::report::svg::Figure;
use crate::verbs::Report;

/// The figures of `cost`.
pub static FIGURES: &[Figure<Report>] = &[
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
        chart: panels::chart,
    },
];
