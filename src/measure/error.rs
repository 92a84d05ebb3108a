//! How far a run is from the truth.

use crate::trajectory::Trajectory;
use crate::truth::{States, farthest};
use serde::{Deserialize, Serialize};

/// Largest distance of a particle from where it truly is (m) or from its true velocity (m/s), over
/// the recorded instants up to the truth's horizon.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Spread {
    /// At the last of these instants.
    #[serde(rename = "final")]
    pub last: f64,
    pub max: f64,
    pub rms: f64,
}

/// What is true at certain steps.
#[derive(Debug, Clone, Default)]
pub struct Known {
    /// Ascending step numbers, one a state.
    pub steps: Vec<u64>,
    pub states: States,
}

/// Largest distances over the particles, at each instant and over all.
#[derive(Debug, Clone)]
pub struct Errors {
    /// Metres.
    pub position: Spread,
    /// Metres a second; None where velocities are not known.
    pub velocity: Option<Spread>,
}

/// Distances of a run from the truth over the instants it shares with what is known; the start,
/// which is the scene's and no run's, counts only in the mean.
///
/// None when it shares no later instant, or is too far away for a number.
pub fn errors(run: &Trajectory, known: &Known) -> Option<Errors> {
    let shared = (0..run.len()).filter_map(|k| {
        let at = known.steps.binary_search(&run.step(k)).ok()?;
        Some((k, at))
    });
    let shared: Vec<(usize, usize)> = shared.collect();
    let distances = |of: &dyn Fn(usize, usize) -> f64| -> Vec<f64> {
        shared.iter().map(|&(k, at)| of(k, at)).collect()
    };
    let position = distances(&|k, at| farthest(run.x(k), known.states.x(at)));
    let velocity = distances(&|k, at| farthest(run.v(k), known.states.v(at)));
    Some(Errors {
        position: spread(&position)?,
        velocity: spread(&velocity).filter(|_| run.has_velocities()),
    })
}

fn spread(distances: &[f64]) -> Option<Spread> {
    let squares: f64 = distances.iter().map(|d| d * d).sum();
    let rms = (squares / distances.len() as f64).sqrt();
    let max = distances.iter().copied().fold(0.0, f64::max);
    let known = distances.len() > 1 && max.is_finite() && rms.is_finite();
    known.then(|| Spread {
        last: distances[distances.len() - 1],
        max,
        rms,
    })
}
