//! How far two trajectories are apart.

use crate::trajectory::Trajectory;
use crate::truth::farthest;
use serde::{Deserialize, Serialize};

/// Largest distance over the particles, metres, over the instants both engines recorded.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Deviation {
    #[serde(rename = "final")]
    pub last: f64,
    pub max: f64,
    /// When it first passed the tolerance (1 % of the scene's size); null if never.
    pub first_exceeds_s: Option<f64>,
}

/// The distance at which `first_exceeds_s` is read, as a share of the scene's size, or of the way
/// gone where the scene has no size.
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
