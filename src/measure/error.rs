//! How far a run is from the truth, and from another run.

use crate::trajectory::Trajectory;
use crate::truth::{States, farthest};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Largest distance of a particle from where it truly is (m) or from its true velocity (m/s), over
/// the recorded instants up to the truth's horizon.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
pub struct ErrorSummary {
    /// At the last of these instants.
    #[serde(rename = "final")]
    pub last: f64,
    /// The largest of all instants.
    pub max: f64,
    /// The root of the mean square over all instants.
    pub rms: f64,
}

/// The true states at certain steps.
#[derive(Debug, Clone, Default)]
pub struct TrueStates {
    /// Ascending step numbers, one a state.
    pub steps: Vec<u64>,
    pub states: States,
}

impl TrueStates {
    /// How far a run's instant is from the truth, m: the largest distance of a particle; None where the truth is not known.
    pub fn distance(&self, run: &Trajectory, instant: usize) -> Option<f64> {
        let at = self.place(run, instant)?;
        Some(farthest(run.x(instant), self.states.x(at)))
    }

    /// Which of the states is that of a run's instant.
    fn place(&self, run: &Trajectory, instant: usize) -> Option<usize> {
        self.steps.binary_search(&run.step(instant)).ok()
    }
}

/// Errors of a run: the largest distances over the particles at each instant, summarised over all.
#[derive(Debug, Clone)]
pub struct Errors {
    /// Metres.
    pub position: ErrorSummary,
    /// Metres a second; None where velocities are not known.
    pub velocity: Option<ErrorSummary>,
}

/// Distances of a run from the truth over the instants it shares with what is known; the start,
/// which is the scene's and no run's, counts only in the mean.
///
/// None when it shares no later instant, or is too far away for a number.
pub fn errors(run: &Trajectory, known: &TrueStates) -> Option<Errors> {
    let distances =
        |of: &dyn Fn(usize) -> Option<f64>| -> Vec<f64> { (0..run.len()).filter_map(of).collect() };
    let position = distances(&|k| known.distance(run, k));
    let velocity = distances(&|k| {
        let at = known.place(run, k)?;
        Some(farthest(run.v(k), known.states.v(at)))
    });
    Some(Errors {
        position: summary(&position)?,
        velocity: summary(&velocity).filter(|_| run.has_velocities()),
    })
}

fn summary(distances: &[f64]) -> Option<ErrorSummary> {
    let squares: f64 = distances.iter().map(|d| d * d).sum();
    let rms = (squares / distances.len() as f64).sqrt();
    let max = distances.iter().copied().fold(0.0, f64::max);
    let known = distances.len() > 1 && max.is_finite() && rms.is_finite();
    known.then(|| ErrorSummary {
        last: distances[distances.len() - 1],
        max,
        rms,
    })
}

/// Largest distance over the particles, metres, over the instants both solvers recorded.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
pub struct Deviation {
    /// At the last instant that both recorded, m.
    #[serde(rename = "final")]
    pub last: f64,
    /// The largest of all instants, m.
    pub max: f64,
    /// When it first passed the tolerance (1 % of the scene's size); null if never.
    pub first_exceeds_s: Option<f64>,
}

/// The distance at which `first_exceeds_s` is read, as a fraction of the scene's size, or of the
/// way gone where the scene has no size.
pub const TOLERANCE: f64 = 0.01;

/// Largest distance over the particles between two runs of the same scene and timestep, over the
/// instants both recorded; `tolerance` in metres.
///
/// None when they share no instant but the start, which is the scene's and no run's. A distance
/// says that two runs differ, not which one is wrong.
pub fn deviation(ours: &Trajectory, reference: &Trajectory, tolerance: f64) -> Option<Deviation> {
    let mut result: Option<Deviation> = None;
    for k in (0..ours.len()).filter(|&k| ours.step(k) > 0) {
        let Some(other) = reference.instant_at(ours.step(k)) else {
            continue;
        };
        let distance = farthest(ours.x(k), reference.x(other));
        let entry = result.get_or_insert(Deviation {
            last: 0.0,
            max: 0.0,
            first_exceeds_s: None,
        });
        entry.last = distance;
        entry.max = entry.max.max(distance);
        if distance > tolerance && entry.first_exceeds_s.is_none() {
            entry.first_exceeds_s = Some(ours.time(k));
        }
    }
    result.filter(|d| d.max.is_finite())
}

/// How far any particle gets from where it started, m, over the recorded instants.
pub fn reach(run: &Trajectory) -> f64 {
    (0..run.len())
        .map(|k| farthest(run.x(k), run.x(0)))
        .fold(0.0, f64::max)
}
