//! The limit found by running the scene.

use super::Limit;
use super::bench::{Bench, shortest};
use super::probe::Budget;
use super::search::{Found, Search, Stop};
use super::smooth;
use crate::engines::{Engine, Unsupported};
use crate::scene::Scene;
use crate::system::ParticleSystem;

/// Makes an engine at a timestep, s, at the scene's start, or says why there can be none.
pub type Make<'a> = dyn Fn(&Scene, f64) -> Result<Box<dyn Engine>, Unsupported> + Sync + 'a;

/// What running found.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// The largest step found stable, to 1e-3, below the first that was not; `Between` those found so
    /// far where patience ended.
    pub limit: Limit,
    /// The engine's own map is linear (twice the disturbance, twice the difference): not every
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
/// A probe is 20,000 steps, fewer where patience is short (`reason` says how many), four or sixteen times as many while it is undecided. Where the engine's
/// map is linear (twice the disturbance, twice the difference) it watches the energy of the difference
/// between two runs, else the energy of one slightly disturbed run; see docs/stability.md. Steps are
/// probed on a geometric grid, since stability need not be monotone, then bisected between the first
/// that fails and the one before. A window of instability narrower than a fifth of its step can be missed, unless `near` points at it.
pub fn measure(
    scene: &Scene,
    system: &ParticleSystem,
    make: &Make,
    timestep: f64,
    near: Option<f64>,
    patience: u64,
    tick: &(dyn Fn(u64) + Sync),
) -> Measured {
    let mut budget = Budget {
        left: patience,
        taken: 0,
        tick,
    };
    let shortest = shortest(scene, system);
    let unit = shortest.unwrap_or(timestep);
    let near = near.filter(|near| *near > 0.0 && near.is_finite());
    let mut linear = false;
    let searched = Bench::new(scene, system, make, 0.5 * unit, patience).map(|bench| {
        linear = bench.is_linear();
        let mut search = Search {
            bench: &bench,
            budget: &mut budget,
            unit,
        };
        let found = search.limit(near);
        let growth = match &found {
            Ok(Found {
                limit: Limit::Never,
                ..
            }) => bench
                .growth(timestep, unit, &mut budget)
                .ok()
                .flatten()
                .filter(|growth| growth.is_finite()),
            _ => None,
        };
        let smooth = bench
            .is_linear()
            .then(|| {
                let upto = match &found {
                    Ok(Found {
                        limit: Limit::At(h),
                        ..
                    }) => Some(*h),
                    _ => None,
                };
                smooth::below(scene, system, make, unit, upto, &mut budget)
            })
            .flatten();
        (found, growth, smooth)
    });
    let (found, growth_per_s, smooth_below_s) = match searched {
        Ok(searched) => searched,
        Err(unsupported) => (Err(Stop::Unsupported(unsupported)), None, None),
    };
    let (limit, reason) = match found {
        Ok(found) => (found.limit, Some(found.reason)),
        Err(Stop::Unsupported(unsupported)) => (Limit::Unknown(unsupported.reason), None),
        Err(Stop::Impatient { stable, unstable }) => impatient(stable, unstable, patience),
    };
    Measured {
        limit,
        linear,
        growth_per_s,
        smooth_below_s,
        steps: budget.taken,
        reason,
    }
}

/// Relative width to which a limit is promised; the search goes on to half of it.
const PROMISED: f64 = 1e-3;

/// What is known when patience ends.
fn impatient(stable: Option<f64>, unstable: Option<f64>, patience: u64) -> (Limit, Option<String>) {
    let ended = format!("no closer within {patience} steps");
    match (stable, unstable) {
        (Some(low), Some(high)) if low < high && high - low <= PROMISED * low => {
            (Limit::At(low), Some(format!("unstable at {high:.4e} s")))
        }
        (Some(low), Some(high)) if low < high => {
            let why = format!("between {low:.3e} s (stable) and {high:.3e} s (unstable), {ended}");
            (Limit::Between(low, high), Some(why))
        }
        (Some(low), _) => {
            let why = format!("stable at {low:.3e} s; larger steps were not tried, {ended}");
            (Limit::Unknown(why), None)
        }
        (None, Some(high)) => {
            let why = format!("unstable at {high:.3e} s; smaller steps were not tried, {ended}");
            (Limit::Unknown(why), None)
        }
        (None, None) => (Limit::Unknown(ended), None),
    }
}
