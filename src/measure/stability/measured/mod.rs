//! Limits found by running a scene at many steps.

mod growth;
mod perturbation;
mod probe;
mod search;
mod setup;
mod smooth;
mod watched;

use super::Limit;
use super::matrix::Matrix;
use crate::measure::energy_scale;
use crate::physics::{Jacobian, Linearization, ParticleSystem, System, Triplets};
use crate::scene::Scene;
use crate::solvers::{Run, Unsupported};
use perturbation::Perturbation;
use probe::{Budget, Fate, Watch, probe};
use search::{Search, Stop};
use serde::{Deserialize, Serialize};
use setup::Setup;
use watched::{ExcessEnergy, Runs};

/// What a run at one step does: one cell of a stability map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Cell {
    /// None of the others: it keeps its energy, or loses what dampers take.
    Stable,
    /// Half of the energy scale S is gone at the end that no damper took (numerical dissipation).
    Dissipating,
    /// Energy that nothing put in keeps growing, or stays at a hundred times S.
    Growing,
    /// A step fails, a number is not finite, the energy passes 1e12 S, or the engine cannot run.
    Failed,
}

/// Starts a run of a scene at a timestep, s, or says why there can be none.
pub type Make<'a> = dyn Fn(&Scene, f64) -> Result<Run, Unsupported> + Sync + 'a;

/// What running found.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// The largest step found stable, to 1e-3, below the first that was not; `Between` those found so
    /// far where patience ended.
    pub limit: Limit,
    /// The engine's own map is linear (twice the perturbation, twice the difference): not every
    /// method's is where every force is.
    pub linear: bool,
    /// Of the amplitude at the timestep asked for, 1/s, where no step is stable: half the rate at
    /// which ln(energy) grows.
    pub growth_per_s: Option<f64>,
    /// As [`Prediction::smooth_below_s`](crate::measure::stability::Prediction::smooth_below_s), by looking at signs.
    pub smooth_below_s: Option<f64>,
    /// Steps taken in all.
    pub steps: u64,
    /// What there is to say in words: how the first failing step fails, or how far was looked.
    pub reason: Option<String>,
}

/// Searches the limit to 1e-3 of itself. `timestep`, s, is where growth is taken; `near` a guess of
/// the limit in seconds (a prediction), which only makes the search shorter. `tick` is called with
/// steps taken; `patience` is in steps of all probes together, a step of more than 20 force passes
/// counting as several, after which the answer is `Between` or Unknown.
///
/// A probe is 20,000 steps, fewer where patience is short (`reason` says how many), four or sixteen times
/// as many while it is undecided. Where the engine's map is linear (twice the perturbation, twice the
/// difference) it watches the energy of the difference between two runs, else the energy of one slightly
/// perturbed run; see docs/stability.md. Steps are probed on a geometric grid, since stability need not be
/// monotone, then bisected between the first that fails and the one before. A window of instability narrower
/// than a fifth of its step can be missed, unless `near` points at it.
pub fn measure(
    scene: &Scene,
    system: &ParticleSystem,
    make: &Make,
    timestep: f64,
    near: Option<f64>,
    patience: u64,
    tick: &(dyn Fn(u64) + Sync),
) -> Measured {
    let mut measured = Measured {
        limit: Limit::Unknown(String::new()),
        linear: false,
        growth_per_s: None,
        smooth_below_s: None,
        steps: 0,
        reason: None,
    };
    let unit = shortest(scene, system).unwrap_or(timestep);
    let setup = match Setup::new(scene, system, make, 0.5 * unit, patience) {
        Ok(setup) => setup,
        Err(Unsupported { reason }) => {
            measured.limit = Limit::Unknown(reason);
            return measured;
        }
    };
    measured.linear = setup.is_linear();
    let mut budget = Budget::new(patience, tick);
    let mut search = Search {
        setup: &setup,
        budget: &mut budget,
        unit,
        known: (None, None),
    };
    let found = search.limit(near.filter(|near| *near > 0.0 && near.is_finite()));
    let known = search.known;
    (measured.limit, measured.reason) = match found {
        Ok(found) => (found.limit, Some(found.reason)),
        Err(Stop::Unsupported(Unsupported { reason })) => (Limit::Unknown(reason), None),
        Err(_) => unfinished(known, patience),
    };
    if measured.limit == Limit::Never {
        let growth = setup.growth(timestep, unit, &mut budget);
        measured.growth_per_s = growth.ok().flatten().filter(|growth| growth.is_finite());
    }
    if measured.linear {
        let upto = match measured.limit {
            Limit::At(h) => Some(h),
            _ => None,
        };
        measured.smooth_below_s = smooth::below(&setup, unit, upto, &mut budget);
    }
    measured.steps = budget.taken;
    measured
}

/// A time, s, no longer than the shortest time scale of the forces about the start: from the row sums
/// of the Jacobians (Gershgorin). None where no force depends on the state.
fn shortest(scene: &Scene, system: &ParticleSystem) -> Option<f64> {
    let start = ParticleSystem::initial_state(scene);
    let mut jacobian = Jacobian::default();
    system.jacobian(0.0, &start.x, &start.v, Linearization::Exact, &mut jacobian);
    let weights = system.inverse_mass();
    let largest = |triplets: &Triplets| {
        let summed = Matrix::new(system.dim(), triplets.clone());
        // In mass-weighted coordinates the matrix is symmetric and its rows are alike.
        let scaled = |(row, column, value): (usize, usize, f64)| {
            (row, column, value * (weights[row] * weights[column]).sqrt())
        };
        Matrix::new(system.dim(), summed.entries().map(scaled).collect()).norm()
    };
    let rate = largest(&jacobian.position)
        .sqrt()
        .max(largest(&jacobian.velocity));
    (rate > 0.0 && rate.is_finite()).then(|| 1.0 / rate)
}

/// Relative width to which a limit is promised; the search goes on to half of it.
const PROMISED: f64 = 1e-3;

/// What is known when patience ends: a step found stable, and one found unstable.
fn unfinished(known: (Option<f64>, Option<f64>), patience: u64) -> (Limit, Option<String>) {
    let ended = format!("no closer within {patience} steps");
    let why = match known {
        (Some(low), Some(high)) if low < high && high - low <= PROMISED * low => {
            return (Limit::At(low), Some(format!("unstable at {high:.4e} s")));
        }
        (Some(low), Some(high)) if low < high => {
            let why = format!("between {low:.3e} s (stable) and {high:.3e} s (unstable), {ended}");
            return (Limit::Between(low, high), Some(why));
        }
        (Some(low), _) => {
            format!("stable at {low:.3e} s; larger steps were not tried, {ended}")
        }
        (None, Some(high)) => {
            format!("unstable at {high:.3e} s; smaller steps were not tried, {ended}")
        }
        (None, None) => ended,
    };
    (Limit::Unknown(why), None)
}

/// Rise of ln(energy) over the second half of a map's run that counts as growth.
const CLEAR: f64 = 0.1;
/// As for a run that counts as diverged.
const DIVERGED: f64 = 1e12;
/// Fraction of the energy scale a dissipating run loses.
const DISSIPATED: f64 = 0.5;

/// One cell of a stability map: what becomes of the scene at step `h`, s, in at most `steps` steps. One
/// run, slightly perturbed so that motions a symmetry hides show, and shorter where it fails.
/// Deterministic. Quicker and coarser than [`measure`]: growth by less than a tenth over half the run is
/// not seen. `tick` is called with steps taken.
pub fn classify(
    scene: &Scene,
    make: &Make,
    h: f64,
    steps: u64,
    tick: &(dyn Fn(u64) + Sync),
) -> Cell {
    let system = ParticleSystem::new(scene);
    let scale = energy_scale(scene, &system, None).unwrap_or(1.0);
    let scene = Perturbation::slight(&system, scale).apply(scene);
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
    match probe(&mut runs, &mut gauge, watch, &mut budget).fate {
        Fate::Grows { lost: true, .. } => Cell::Failed,
        Fate::Grows { .. } => Cell::Growing,
        _ if gauge.late_balance() - before < -DISSIPATED * scale => Cell::Dissipating,
        _ => Cell::Stable,
    }
}
