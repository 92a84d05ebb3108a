//! How far a run is from the truth.

use super::deviation::farthest;
use crate::outcome::Spread;
use crate::trajectory::Trajectory;
use crate::truth::States;

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
    let mut position = Sum::default();
    let mut velocity = Sum::default();
    for k in 0..run.len() {
        let Ok(at) = known.steps.binary_search(&run.step(k)) else {
            continue;
        };
        position.add(farthest(run.x(k), known.states.x(at)));
        velocity.add(farthest(run.v(k), known.states.v(at)));
    }
    Some(Errors {
        position: position.spread()?,
        velocity: velocity.spread().filter(|_| run.has_velocities()),
    })
}

#[derive(Default)]
struct Sum {
    last: f64,
    max: f64,
    squares: f64,
    instants: u32,
}

impl Sum {
    fn add(&mut self, distance: f64) {
        self.last = distance;
        // NaN stays.
        self.max = if distance <= self.max {
            self.max
        } else {
            distance
        };
        self.squares += distance * distance;
        self.instants += 1;
    }

    fn spread(self) -> Option<Spread> {
        let rms = (self.squares / f64::from(self.instants)).sqrt();
        let known = self.instants > 1 && self.max.is_finite() && rms.is_finite();
        known.then_some(Spread {
            last: self.last,
            max: self.max,
            rms,
        })
    }
}
