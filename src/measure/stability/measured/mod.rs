//! Limits found by running a scene at many steps.

mod experiment;
mod perturbation;
mod probe;
mod search;
mod smooth;
mod watched;

use super::{Limit, predicted};
use crate::measure::energy_scale;
use crate::physics::{ParticleSystem, System};
use crate::scene::Scene;
use crate::solvers::{Run, Unsupported};
use experiment::Experiment;
use perturbation::Perturbation;
use probe::{Budget, ProbeOutcome, Runs, Watch, probe};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use watched::ExcessEnergy;

/// The behaviour of a run at one step: one cell of a stability map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Cell {
    /// None of the others: it keeps its energy, or loses what dampers take.
    Stable,
    /// At the end half of the energy scale S is gone that no damper took (numerical dissipation).
    Dissipating,
    /// Energy that nothing put in keeps growing, or stays above a thousand times S.
    Growing,
    /// A step fails, a number is not finite, the energy passes 1e12 S, or the solver cannot run.
    Failed,
}

/// Starts a run of a scene at a timestep, s, or says why there can be none.
pub type MakeRun<'a> = dyn Fn(&Scene, f64) -> Result<Run, Unsupported> + Sync + 'a;

/// The limit found by running.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredLimit {
    /// The largest step found stable, to 1e-3, below the first that was not; `Between` those found so
    /// far where the budget ended.
    pub limit: Limit,
    /// Whether the solver's map is linear (twice the perturbation makes twice the difference):
    /// where every force is linear, not every method's map is.
    pub linear: bool,
    /// Growth of the amplitude at the given timestep, 1/s, where no step is stable: half the rate
    /// at which ln(energy) grows.
    pub growth_per_s: Option<f64>,
    /// As [`Prediction::smooth_below_s`](crate::measure::stability::Prediction::smooth_below_s), by looking at signs.
    pub smooth_below_s: Option<f64>,
    /// Steps taken in all.
    pub steps: u64,
    /// The reason in words: how the first failing step fails, or how far the search went.
    pub reason: Option<String>,
}

/// Searches the limit to 1e-3 of itself. Growth is measured at `timestep`, s. `near` is a guess of
/// the limit in seconds (a prediction), which only makes the search shorter. `tick` is called with
/// steps taken. `budget` is in steps of all probes together, where a step of more than 20 force
/// passes counts as several; once it is spent the answer is `Between` or Unknown.
///
/// A probe is 20,000 steps, fewer where the budget is short (`reason` says how many), four or sixteen times
/// as many while it is undecided. Where the solver's map is linear it watches the energy of the difference
/// between two runs, else the energy of one slightly perturbed run; see docs/stability.md. Steps are probed
/// on a geometric grid, since stability need not be monotone, then bisected between the first that fails
/// and the one before. A window of instability narrower than a fifth of its step can be missed, unless
/// `near` points at it.
pub fn measure(
    scene: &Scene,
    system: &ParticleSystem,
    make: &MakeRun,
    timestep: f64,
    near: Option<f64>,
    budget: u64,
    tick: &(dyn Fn(u64) + Sync),
) -> MeasuredLimit {
    let start = ParticleSystem::initial_state(scene);
    let unit = predicted::shortest(system, &start).unwrap_or(timestep);
    let mut experiment = match Experiment::new(scene, system, make, unit, budget, tick) {
        Ok(experiment) => experiment,
        Err(Unsupported { reason }) => {
            return MeasuredLimit {
                limit: Limit::Unknown(reason),
                linear: false,
                growth_per_s: None,
                smooth_below_s: None,
                steps: 0,
                reason: None,
            };
        }
    };
    let near = near.filter(|near| *near > 0.0 && near.is_finite());
    let (limit, reason) = experiment.limit(near, budget);
    let growth = (limit == Limit::Never).then(|| experiment.growth(timestep));
    let upto = match limit {
        Limit::At(h) => Some(h),
        _ => None,
    };
    // Near a rest on rods the map is linear for small motion alone.
    let linear = experiment.is_linear() && system.rods().is_none();
    MeasuredLimit {
        growth_per_s: growth.flatten().filter(|growth| growth.is_finite()),
        smooth_below_s: linear
            .then(|| smooth::below(&mut experiment, upto))
            .flatten(),
        linear,
        limit,
        reason,
        steps: experiment.budget.taken,
    }
}

/// Rise of ln(energy) over the second half of a map's run that counts as growth.
const CLEAR: f64 = 0.1;
/// Times the energy scale at which a run is lost, as for a run that counts as diverged.
const DIVERGED: f64 = 1e12;
/// Fraction of the energy scale a dissipating run loses.
const DISSIPATED: f64 = 0.5;

/// One cell of a stability map: the behaviour of the scene at step `h`, s, in at most `steps` steps. It
/// is one run, slightly perturbed so that motions a symmetry hides show, and shorter where it fails.
/// Deterministic. Quicker and coarser than [`measure`]: growth by less than a tenth over half the run is
/// not seen. `tick` is called with steps taken.
pub fn classify(
    scene: &Scene,
    make: &MakeRun,
    h: f64,
    steps: u64,
    tick: &(dyn Fn(u64) + Sync),
) -> Cell {
    let system = ParticleSystem::new(scene);
    let scale = energy_scale(scene, &system, None).unwrap_or(1.0);
    let start = ParticleSystem::initial_state(scene);
    let scene = Perturbation::slight(&system, &start, scale).apply(scene);
    let Ok(mut runs) = Runs::new(make, h, &[&scene]) else {
        return Cell::Failed;
    };
    let watch = Watch {
        steps,
        extensions: 0,
        clear: CLEAR,
    };
    let late = 0.75 * steps as f64 * h;
    let mut gauge = ExcessEnergy::new(&runs, system, &scene, scale, DIVERGED, late);
    let before = gauge.balance(&runs);
    let mut budget = Budget::new(u64::MAX, tick);
    let outcome = probe(&mut runs, &mut gauge, watch, &mut budget).map(|probed| probed.outcome);
    match outcome {
        Some(ProbeOutcome::Grows { lost: true, .. }) => Cell::Failed,
        Some(ProbeOutcome::Grows { .. }) => Cell::Growing,
        _ if gauge.late_balance() - before < -DISSIPATED * scale => Cell::Dissipating,
        _ => Cell::Stable,
    }
}
