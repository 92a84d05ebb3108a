//! A motion converged until two independent estimates of high order agree, with an error bar as a
//! function of time.
//!
//! The first estimate, which is the reference, takes steps of Dormand and Prince's method of order
//! 8; the second extrapolates Gragg's midpoint rule to order 10. They share the forces and the cuts
//! of time and nothing else. Steps are halved, first those with a large error of their own, then
//! all, until the two agree to rounding. The error bar is three times the largest distance of the
//! reference from the second estimate and from itself at half the steps, and what rounding may do:
//! that is measured on motions with magnified rounding, since estimates can be rounded alike.
//!
//! ```text
//! rate -> mesh -> two estimates -> halving -> bars -> horizon
//!                  precise sums     noise, growth     reference: states at any time, kept as bytes
//! ```

mod bars;
mod dormand_prince;
mod gragg;
mod halving;
mod key;
mod level;
mod mesh;
mod rate;
mod reference;
mod stepper;

pub use dormand_prince::{DORMAND_PRINCE_8, DormandPrince};
pub use gragg::{Gragg, SUBSTEPS};
pub use key::key;
pub use reference::{Reference, SharedSystem};
pub use stepper::{Precise, Stepper};

use super::Store;
use crate::physics::{ParticleSystem, State, System};
use crate::scene::Scene;
use halving::{Halved, StopReason, halve};
use reference::Record;
use serde::{Deserialize, Serialize};
use std::fmt::Write;
use std::sync::Arc;

/// Version of the stored form. It changes whenever a scene would get other bits, or they would be
/// kept otherwise.
const VERSION: u32 = 4;

/// The budget of [`find`] for a scene, in force evaluations times coordinates.
pub const BUDGET: u64 = 1 << 30;

/// Coordinates whose states fit into a processor's cache. Beyond, an evaluation takes about three times as long a
/// coordinate: 26 ns with precise sums, measured at 300,000.
const CACHED: usize = 100_000;

/// The budget of [`find`] for this many coordinates: some ten seconds of one core at most.
fn budget(dim: usize) -> u64 {
    if dim > CACHED { BUDGET / 3 } else { BUDGET }
}

/// The horizon ends where the error bar exceeds this fraction of the size.
pub const HORIZON: f64 = 1e-6;

/// A converged reference and the facts about it.
pub struct Converged {
    pub facts: ReferenceFacts,
    pub motion: Reference,
}

/// The facts about a converged reference.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReferenceFacts {
    /// Both estimates and their steps.
    pub method: String,
    /// How well the estimates agree and what ends the horizon.
    pub reason: String,
    /// The last time, s, at which the error bar is below [`HORIZON`] times the size.
    pub horizon: f64,
    /// The error bar at the horizon, its largest up to there, m.
    pub error_bound: f64,
    /// The rate at which neighbouring motions part, 1/s; None where they do not part exponentially,
    /// or not for long enough to tell.
    pub growth: Option<f64>,
    /// Force evaluations times coordinates that were spent.
    pub spent: u64,
}

/// The reason why there is no converged reference.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error, Serialize, Deserialize)]
#[error("{reason}")]
pub struct NotConverged {
    pub reason: String,
}

/// Converges the motion of any system from `start`, at t = 0, up to `until` seconds.
///
/// `size` is the length, m, errors are held against; where it is 0, the largest distance from the
/// start takes its place. `budget` counts force evaluations times coordinates, of all levels
/// together; no clock is read, and results do not depend on the number of threads.
///
/// # Errors
/// When the budget is too small, the forces are not finite, or the estimates do not agree at all.
pub fn converge(
    system: &SharedSystem,
    start: &State,
    until: f64,
    size: f64,
    budget: u64,
) -> Result<Converged, NotConverged> {
    let time = until > 0.0 && until.is_finite();
    let fits = system.dim() > 0 && [&start.x, &start.v].iter().all(|c| c.len() == system.dim());
    if !time || !fits || !(0.0..f64::INFINITY).contains(&size) {
        return Err(NotConverged::new(
            "there is no time to cover, no state that fits, or no size",
        ));
    }
    let halved = halve(&**system, start, until, size, budget)?;
    let Halved {
        level, size, bars, ..
    } = &halved;
    let limit = HORIZON * size;
    let within = bars.iter().take_while(|bar| **bar <= limit).count();
    if within < 2 {
        return Err(NotConverged::new(format!(
            "independent estimates of {} steps differ by more than {limit:.1e} m from the start; {}",
            thousands(level.steps()),
            match halved.ended {
                StopReason::Spent => TOO_MUCH,
                _ => "smaller steps do not bring them together",
            }
        )));
    }
    let horizon = level.mesh.time(within - 1).min(until);
    let growth = bars::growth_rate(&halved.amplification, &level.mesh);
    let mut reason = format!(
        "independent estimates agree within {:.1e} m",
        level.gaps[within - 1]
    );
    if horizon < until {
        let _ = match (growth, halved.ended) {
            (Some(rate), _) => write!(reason, "; neighbours part at {rate:.2} /s"),
            (None, StopReason::Spent) => write!(reason, "; {TOO_MUCH}"),
            (None, _) => write!(reason, "; beyond it {}", apart(&**system)),
        };
    }
    Ok(Converged {
        facts: ReferenceFacts {
            method: format!(
                "Dormand-Prince 8 with {} steps, against Gragg extrapolation of order {} with {}",
                thousands(level.steps()),
                2 * SUBSTEPS.len(),
                thousands(level.mesh.pieces())
            ),
            reason,
            horizon,
            error_bound: bars[within - 1],
            growth,
            spent: halved.spent,
        },
        motion: Reference {
            system: Arc::clone(system),
            record: Record {
                mesh: halved.level.mesh,
                samples: halved.level.first,
                bars: halved.bars,
            },
        },
    })
}

/// Why two estimates part.
fn apart(system: &dyn System) -> &'static str {
    if system.obstacles().is_some() {
        "smaller steps do not bring them together, as where an impact only grazes, or two come at the same time"
    } else {
        "smaller steps do not bring them together"
    }
}

/// The reason given where the budget ended the halving.
const TOO_MUCH: &str = "smaller steps would cost more than allowed";

/// Finds the converged reference of a scene and the system built from it, in the store or anew
/// within [`BUDGET`], a third of it in large scenes. Success and failure are both saved under the scene's [`key`]; a stored
/// reference gives the same bits.
///
/// # Errors
/// As [`converge`].
pub fn find(
    scene: &Scene,
    system: &ParticleSystem,
    until: f64,
    store: &dyn Store,
) -> Result<Converged, NotConverged> {
    let name = key(scene, until);
    let system: SharedSystem = Arc::new(system.clone());
    let saved = store.load(&name);
    if let Some(found) = saved.and_then(|b| reference::decode(&b, &name, &system, until)) {
        return found;
    }
    let start = ParticleSystem::initial_state(scene);
    let allowed = budget(system.dim());
    let found = converge(&system, &start, until, scene.size(), allowed);
    if let Some(bytes) = reference::encode(&found, &name) {
        store.save(&name, &bytes);
    }
    found
}

/// About the force evaluations times coordinates that [`find`] will spend; 0 where it is stored or ends at once.
pub fn expected(scene: &Scene, system: &ParticleSystem, until: f64, store: &dyn Store) -> u64 {
    if store.load(&key(scene, until)).is_some() {
        return 0;
    }
    let start = ParticleSystem::initial_state(scene);
    let first = halving::first_cost(system, &start, until, scene.size());
    let budget = budget(system.dim());
    let first = first.filter(|cost| *cost <= budget).unwrap_or(0);
    // What springs join to something that touches is of second order there, however short the steps.
    let knocked = scene.collides() && !scene.springs.is_empty() && scene.particles.len() > FEW;
    let halvings = if knocked {
        HALVINGS * KNOCKED
    } else {
        HALVINGS
    };
    first.saturating_mul(halvings).min(budget)
}

/// All levels together, in units of the first: each has twice its steps, and three or four are usual.
const HALVINGS: u64 = 15;
/// And this many times as many where more particles than this have events that cannot all be cut at.
const KNOCKED: u64 = 32;
const FEW: usize = 4;

impl NotConverged {
    fn new(reason: impl Into<String>) -> Self {
        Self {
            reason: reason.into(),
        }
    }
}

/// 16384 as `16,384`.
fn thousands(n: impl ToString) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}
