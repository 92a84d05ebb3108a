//! The record every measure reads: bounded in memory however long the run.

use super::Precision;
use crate::engines::Observer;
use crate::system::{State, Work};

/// At most this many instants, both ends included.
const INSTANTS: u64 = 2_000;
/// And at most about this much memory, bytes: large scenes are recorded at fewer instants.
const BUDGET: u64 = 10 << 20;
/// But never fewer instants than this.
const FEWEST: u64 = 50;

/// States at evenly spaced steps, and beside each the next step's state, so that a thinned run can
/// still be replayed step by step.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    timestep: f64,
    dim: usize,
    steps: Vec<u64>,
    x: Vec<f64>,
    v: Vec<f64>,
    work: Vec<Work>,
    /// Step numbers of the states in `next_x`, `next_v`: each one past an instant's.
    next_steps: Vec<u64>,
    next_x: Vec<f64>,
    next_v: Vec<f64>,
    /// Whether `v` and `next_v` are the run's own, not differences of its positions.
    has_velocities: bool,
    /// How exactly positions and velocities are given: [`Precision::Double`] but for other programs.
    precision: [Precision; 2],
}

/// The most instants a run of `particles` particles is recorded at.
pub(super) fn most_instants(particles: usize) -> u64 {
    let bytes = 2 * 6 * 8 * particles.max(1) as u64;
    (BUDGET / bytes).clamp(FEWEST, INSTANTS)
}

/// Steps from one recorded instant to the next for a run of `steps` steps of `particles` particles.
pub fn stride(steps: u64, particles: usize) -> u64 {
    steps.div_ceil(most_instants(particles) - 1).max(1)
}

impl Trajectory {
    /// Nothing yet, with room for so many instants and states one step after one.
    pub(super) fn with_room(
        dim: usize,
        timestep: f64,
        has_velocities: bool,
        [instants, successors]: [usize; 2],
    ) -> Self {
        Self {
            timestep,
            dim,
            steps: Vec::with_capacity(instants),
            x: Vec::with_capacity(instants * dim),
            v: Vec::with_capacity(instants * dim),
            work: Vec::with_capacity(instants),
            next_steps: Vec::with_capacity(successors),
            next_x: Vec::with_capacity(successors * dim),
            next_v: Vec::with_capacity(successors * dim),
            has_velocities,
            precision: [Precision::Double; 2],
        }
    }

    /// Recorded instants.
    pub fn len(&self) -> usize {
        self.steps.len()
    }

    pub fn is_empty(&self) -> bool {
        self.steps.is_empty()
    }

    /// Seconds a step.
    pub fn timestep(&self) -> f64 {
        self.timestep
    }

    /// Coordinates of a state, 3 a particle.
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// The step number of instant `k`.
    pub fn step(&self, k: usize) -> u64 {
        self.steps[k]
    }

    /// The time of instant `k`, s.
    pub fn time(&self, k: usize) -> f64 {
        self.steps[k] as f64 * self.timestep
    }

    /// Positions at instant `k`, length [`dim`](Self::dim).
    pub fn x(&self, k: usize) -> &[f64] {
        &self.x[k * self.dim..(k + 1) * self.dim]
    }

    /// Whether velocities are known. Where another program gave positions only they are not:
    /// [`v`](Self::v) then holds differences, from which no energy is to be read.
    pub fn has_velocities(&self) -> bool {
        self.has_velocities
    }

    /// How exactly positions and velocities are given.
    pub fn precision(&self) -> [Precision; 2] {
        self.precision
    }

    /// The same states, given only so exactly.
    pub(super) fn given_to(mut self, precision: [Precision; 2]) -> Self {
        self.precision = precision;
        self
    }

    /// Velocities at instant `k`.
    pub fn v(&self, k: usize) -> &[f64] {
        &self.v[k * self.dim..(k + 1) * self.dim]
    }

    /// Work done up to instant `k`.
    pub fn work(&self, k: usize) -> Work {
        self.work[k]
    }

    /// One more instant, after all others.
    pub(super) fn push(&mut self, step: u64, state: &State) {
        self.steps.push(step);
        self.x.extend_from_slice(&state.x);
        self.v.extend_from_slice(&state.v);
        self.work.push(state.work);
    }

    /// The state one step after the last instant.
    pub(super) fn push_successor(&mut self, step: u64, state: &State) {
        self.next_steps.push(step);
        self.next_x.extend_from_slice(&state.x);
        self.next_v.extend_from_slice(&state.v);
    }

    /// Positions and velocities one step after instant `k`, where they were recorded.
    pub fn following(&self, k: usize) -> Option<(&[f64], &[f64])> {
        let wanted = self.steps[k] + 1;
        if self.steps.get(k + 1) == Some(&wanted) {
            return Some((self.x(k + 1), self.v(k + 1)));
        }
        let at = self.next_steps.binary_search(&wanted).ok()? * self.dim;
        let range = at..at + self.dim;
        Some((&self.next_x[range.clone()], &self.next_v[range]))
    }
}

/// Fills a [`Trajectory`] while a run goes on.
#[derive(Debug)]
pub struct Recorder {
    stride: u64,
    last: u64,
    trajectory: Trajectory,
}

impl Recorder {
    /// For `steps` steps of a system of `dim` coordinates.
    pub fn new(steps: u64, dim: usize, timestep: f64) -> Self {
        let stride = stride(steps, dim / 3);
        let instants = (steps / stride + 2) as usize;
        // Without thinning, an instant's successor is the next instant.
        let successors = if stride > 1 { instants } else { 0 };
        Self {
            stride,
            last: steps,
            trajectory: Trajectory::with_room(dim, timestep, true, [instants, successors]),
        }
    }

    pub fn finish(self) -> Trajectory {
        self.trajectory
    }
}

impl Observer for Recorder {
    fn next(&self, from: u64) -> Option<u64> {
        if from > self.last {
            return None;
        }
        // Instants are multiples of the stride and the last step; each one's successor is wanted.
        let after_instant = from % self.stride == 1;
        let due = if after_instant || from == 0 {
            from
        } else {
            from.div_ceil(self.stride) * self.stride
        };
        Some(due.min(self.last))
    }

    fn observe(&mut self, step: u64, state: &State) {
        let successor = self.stride > 1 && step % self.stride == 1 && step != self.last;
        if successor {
            self.trajectory.push_successor(step, state);
        } else {
            self.trajectory.push(step, state);
        }
    }

    fn observe_diverged(&mut self, step: u64, state: &State) {
        self.trajectory.push(step, state);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(steps: u64, particles: usize) -> Trajectory {
        let mut recorder = Recorder::new(steps, 3 * particles, 0.5);
        let mut due = recorder.next(0);
        for step in 0..=steps {
            if due == Some(step) {
                let state = State::new(vec![step as f64; 3 * particles], vec![0.0; 3 * particles]);
                recorder.observe(step, &state);
                due = recorder.next(step + 1);
            }
        }
        recorder.finish()
    }

    #[test]
    fn both_ends_and_every_successor_are_kept_within_the_bound() {
        for steps in [1, 2, 3, 1998, 1999, 2000, 2001, 3998, 3999, 10_007] {
            let t = record(steps, 1);
            assert!(t.len() as u64 <= INSTANTS, "{steps}: {}", t.len());
            assert_eq!((t.step(0), t.step(t.len() - 1)), (0, steps));
            for k in 0..t.len() {
                assert_eq!(t.x(k)[0], t.step(k) as f64);
                match t.following(k) {
                    Some((x, _)) => assert_eq!(x[0], t.step(k) as f64 + 1.0, "{steps} {k}"),
                    None => assert_eq!(t.step(k), steps, "{steps}: no successor at {k}"),
                }
            }
        }
    }

    #[test]
    fn large_scenes_are_thinned_further() {
        let t = record(4_000, 1_000);
        let bytes = (t.x.len() + t.v.len() + t.next_x.len() + t.next_v.len()) * 8;
        assert!(bytes as u64 <= BUDGET + 2 * 48_000, "{bytes}");
        assert!(t.len() as u64 >= FEWEST);
    }
}
