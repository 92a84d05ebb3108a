//! The result of `cost`: errors against their cost, and which engine reaches which error cheapest.
//!
//! Wall times differ from run to run, and with them what is chosen by them: [`CostTarget::cheapest`],
//! the order of [`CostTarget::ranking`] and every key that holds `wall`. All else is the same in every run.

use crate::solvers::{SolverKind, Status};
use crate::verbs::clock::WallTime;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The `cost` key of the report.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
pub struct Cost {
    /// How long every run is, s.
    pub duration_s: f64,
    /// Positions are held against the truth up to here, s; null without a truth.
    pub horizon_s: Option<f64>,
    /// Ten times the truth's own error bar, m: no smaller error can be told from it. Null without truth.
    pub floor_m: Option<f64>,
    /// Who reaches an error, and at what price.
    pub targets: Vec<CostTarget>,
    /// One for each engine, in the order of the plan; adaptive pairs after the methods.
    pub curves: Vec<CostCurve>,
}

/// Which engines reach an error, and at what cost.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
pub struct CostTarget {
    /// Largest distance of a particle from its true position, over the horizon, m.
    pub error_m: f64,
    /// The integrator with the least median wall time. Null where none reaches the target.
    pub cheapest: Option<CostReached>,
    /// The integrator with the fewest force evaluations, which do not depend on the clock.
    pub fewest_evaluations: Option<CostReached>,
    /// Every integrator: first those that reach it, cheapest first, then the others.
    pub ranking: Vec<CostRank>,
    /// Engines that are explained and not ranked (rapier's), as they are listed.
    pub reference: Vec<CostRank>,
    /// Why the target cannot be judged (no truth, or one not good enough); else null.
    pub reason: Option<String>,
}

/// A setting that reaches a target.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CostReached {
    /// The engine's id.
    pub engine: String,
    /// Seconds; the mean step of an adaptive pair.
    pub timestep: f64,
    /// The tolerance of an adaptive pair; null for fixed steps.
    pub tolerance: Option<f64>,
    /// The error at this setting, m.
    pub error_m: f64,
    /// The median wall time, s; null where the setting was not timed.
    pub wall_median_s: Option<f64>,
    /// How many; null where the engine does not count them.
    pub force_evaluations: Option<u64>,
    /// It is the coarsest setting tried: a coarser one may do, so the price is at most this.
    #[serde(default)]
    pub at_most: bool,
}

/// One engine's place for one target.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
pub struct CostRank {
    /// The engine's id.
    pub engine: String,
    /// The coarsest setting from which on every finer one reaches the target; null if there is none.
    pub reached: Option<CostReached>,
    /// The median time in units of the cheapest integrator's; null where either is missing.
    pub wall_ratio: Option<f64>,
    /// Why the engine does not reach the target; else null.
    pub reason: Option<String>,
    /// How many times the steps of the finest setting would reach the target, by the curve's slope; null
    /// where the engine reaches it, or the slope does not say.
    pub more_steps: Option<f64>,
    /// The time of those steps in units of the cheapest integrator's; null where either is missing.
    pub extrapolated_wall_ratio: Option<f64>,
}

/// One engine's line in the work-precision diagram.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
pub struct CostCurve {
    /// The engine's id.
    pub engine: String,
    /// What kind of solver it is.
    pub kind: SolverKind,
    /// The stated order on this scene (the order with damping where there is some); null for rapier.
    pub order: Option<u32>,
    /// Slope of ln(error_m) over ln(timestep) through `slope_points`; null where there are fewer than four.
    /// With a fixed number of evaluations a step, the slope over ln(evaluations) is its negative.
    pub observed_order: Option<f64>,
    /// Indices into `points` the slope was fitted through: finer than where it still changes, above the
    /// floor.
    pub slope_points: Vec<usize>,
    /// Coarse to fine.
    pub points: Vec<CostPoint>,
    /// Indices into `points` of the Pareto front: no other point has both a smaller error and fewer force
    /// evaluations (steps, where evaluations are not counted).
    pub pareto: Vec<usize>,
    /// Why a reference engine's curve lies where it does; null for integrators.
    pub explanation: Option<String>,
}

impl CostCurve {
    /// Whether the engine is ranked. Reference engines are not: their distance from the truth is no error.
    pub fn is_ranked(&self) -> bool {
        self.kind == SolverKind::Integrator
    }
}

/// One engine at one setting.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
pub struct CostPoint {
    /// Seconds; for an adaptive pair the duration over the steps taken.
    pub timestep: f64,
    /// The tolerance of an adaptive pair; null for fixed steps.
    pub tolerance: Option<f64>,
    /// Steps accepted.
    pub steps: u64,
    /// How the run ended.
    pub status: Status,
    /// Why the run has no error: it diverged, failed, or is unsupported; else null.
    pub reason: Option<String>,
    /// Largest distance of a particle from its true position over the horizon, m; null without a truth.
    pub error_m: Option<f64>,
    /// The same distance at the last instant within the horizon.
    pub error_final_m: Option<f64>,
    /// max |B - B(0)| / S of the energy balance over the whole run.
    pub energy_error: Option<f64>,
    /// Whether the truth's error bar and rounding explain the whole error.
    pub at_floor: bool,
    /// Null for a run that did not complete: a wrong answer has no speed.
    pub wall_s: Option<WallTime>,
    /// Full evaluations and passes over damping alone; null where the engine does not count them.
    pub force_evaluations: Option<u64>,
    /// Linear systems solved; null where the engine does not count them.
    pub linear_solves: Option<u64>,
    /// Iterations of Newton's method; null where the engine does not count them.
    pub newton_iterations: Option<u64>,
}

impl CostPoint {
    /// The counted cost of the run: force evaluations, or steps where those are not counted.
    pub fn work(&self) -> u64 {
        self.force_evaluations.unwrap_or(self.steps)
    }
}

/// The picture of a few steps: each integrator's curve, the truth, and the difference.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct CostPanels {
    /// The coordinate shown, such as `particle 1, z (m)`.
    pub label: String,
    /// The truth's curve: seconds and metres; empty without truth.
    pub truth: Vec<[f64; 2]>,
    /// One for each engine, in the order of the curves.
    pub panels: Vec<CostPanel>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct CostPanel {
    pub engine: String,
    /// Coarse to fine.
    pub lines: Vec<CostLine>,
}

/// One run in a panel; all numbers finite.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct CostLine {
    /// Seconds.
    pub timestep: f64,
    pub status: Status,
    /// Seconds and metres.
    pub curve: Vec<[f64; 2]>,
    /// Seconds, and metres above the truth; empty without truth.
    pub difference: Vec<[f64; 2]>,
}
