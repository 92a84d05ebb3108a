//! The record every measure reads: bounded in memory however long the run.
//!
//! A [`Recorder`] fills it while a run goes on, [`Trajectory::of_rows`] from the rows of one that is over.

use super::{Observer, Precision, Rows};
use crate::physics::{State, Work};

/// A record has at most this many instants, both ends included.
const INSTANTS: u64 = 2_000;
/// A record takes at most about this much memory, in bytes: large scenes are recorded at fewer
/// instants.
const BUDGET: u64 = 10 << 20;
/// A record never has fewer instants than this.
const FEWEST: u64 = 50;

/// States at evenly spaced steps, the instants, and beside each the next step's state, so that a thinned
/// run can still be replayed step by step.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    /// Instants and the states one step after them, in order.
    rows: Rows,
    /// The row of each instant.
    instants: Vec<usize>,
    /// Work done up to each instant.
    work: Vec<Work>,
}

/// The most instants a run of `particles` particles is recorded at.
fn most_instants(particles: usize) -> u64 {
    let bytes = 2 * 6 * 8 * particles.max(1) as u64;
    (BUDGET / bytes).clamp(FEWEST, INSTANTS)
}

/// Steps from one recorded instant to the next for a run of `steps` steps of `particles` particles.
pub fn stride(steps: u64, particles: usize) -> u64 {
    steps.div_ceil(most_instants(particles) - 1).max(1)
}

impl Trajectory {
    /// Recorded instants.
    pub fn len(&self) -> usize {
        self.instants.len()
    }

    pub fn is_empty(&self) -> bool {
        self.instants.is_empty()
    }

    /// The instants and the states one step after them, in order: what can be replayed.
    pub fn rows(&self) -> &Rows {
        &self.rows
    }

    /// The step number of instant `k`.
    pub fn step(&self, k: usize) -> u64 {
        self.rows.steps[self.instants[k]]
    }

    /// The instant with this step number, if there is one.
    pub fn instant_at(&self, step: u64) -> Option<usize> {
        let steps = &self.rows.steps;
        self.instants
            .binary_search_by_key(&step, |&row| steps[row])
            .ok()
    }

    /// The time of instant `k`, s.
    pub fn time(&self, k: usize) -> f64 {
        self.rows.time(self.instants[k])
    }

    /// Positions at instant `k`, m.
    pub fn x(&self, k: usize) -> &[f64] {
        self.rows.x(self.instants[k])
    }

    /// Velocities at instant `k`, m/s; empty where they are not known.
    pub fn v(&self, k: usize) -> &[f64] {
        self.rows.v(self.instants[k]).unwrap_or(&[])
    }

    /// Whether velocities are known; they are not where another program gave positions only.
    pub fn has_velocities(&self) -> bool {
        self.rows.v.is_some()
    }

    /// Work done up to instant `k`.
    pub fn work(&self, k: usize) -> Work {
        self.work[k]
    }

    /// Positions and velocities one step after instant `k`, where they were recorded.
    pub fn following(&self, k: usize) -> Option<(&[f64], &[f64])> {
        let next = self.instants[k] + 1;
        let known = self.rows.steps.get(next) == Some(&(self.step(k) + 1));
        known.then(|| (self.rows.x(next), self.rows.v(next).unwrap_or(&[])))
    }

    /// A record of the rows of a run that was to take `last` steps; `work` is the work done up to each
    /// row that counts. Velocities are known if the rows have any. The first row and the last are
    /// instants, and so is the last row that counts where the run `diverged`.
    pub fn of_rows(rows: &Rows, work: &[Work], last: u64, diverged: bool) -> Self {
        let particles = rows.dim / 3;
        let (stride, most) = (stride(last, particles), most_instants(particles) as usize);
        let shared = |step: u64| step.is_multiple_of(stride);
        let many = rows.steps.iter().filter(|step| shared(**step)).count();
        // Rows that leave out too many steps have too few at the instants all other runs use.
        let pitch = (many < most / 2).then(|| (rows.len() - 1).div_ceil(most - 1));
        let is_instant = |k: usize| {
            let by_thinning = pitch.map_or(shared(rows.steps[k]), |pitch| k.is_multiple_of(pitch));
            rows.len() <= most || by_thinning || k + 1 == rows.len()
        };
        let mut trajectory = Self {
            rows: Rows {
                steps: Vec::new(),
                x: Vec::new(),
                v: rows.v.as_ref().map(|_| Vec::new()),
                ..*rows
            },
            instants: Vec::new(),
            work: Vec::new(),
        };
        for (k, &done) in work.iter().enumerate() {
            let step = rows.steps[k];
            let instant = is_instant(k) || diverged && k + 1 == work.len();
            if instant || k > 0 && is_instant(k - 1) && rows.steps[k - 1] + 1 == step {
                let v = rows.v(k).unwrap_or(&[]);
                trajectory.push(step, rows.x(k), v, instant.then_some(done));
            }
        }
        trajectory
    }

    /// Adds a row after all others; it is an instant if the work done up to it is given.
    fn push(&mut self, step: u64, x: &[f64], v: &[f64], work: Option<Work>) {
        if let Some(work) = work {
            self.instants.push(self.rows.len());
            self.work.push(work);
        }
        self.rows.steps.push(step);
        self.rows.x.extend_from_slice(x);
        if let Some(known) = &mut self.rows.v {
            known.extend_from_slice(v);
        }
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
    /// A recorder for `steps` steps of a system of `dim` coordinates.
    pub fn new(steps: u64, dim: usize, timestep: f64) -> Self {
        let stride = stride(steps, dim / 3);
        let instants = (steps / stride + 2) as usize;
        // Without thinning, an instant's successor is the next instant.
        let rows = if stride > 1 { 2 * instants } else { instants };
        Self {
            stride,
            last: steps,
            trajectory: Trajectory {
                rows: Rows {
                    timestep,
                    dim,
                    steps: Vec::with_capacity(rows),
                    x: Vec::with_capacity(rows * dim),
                    v: Some(Vec::with_capacity(rows * dim)),
                    precision: Precision::Double,
                    precision_v: Precision::Double,
                    cut: false,
                },
                instants: Vec::with_capacity(instants),
                work: Vec::with_capacity(instants),
            },
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
        let work = (!successor).then_some(state.work);
        self.trajectory.push(step, &state.x, &state.v, work);
    }

    fn observe_diverged(&mut self, step: u64, state: &State) {
        let work = Some(state.work);
        self.trajectory.push(step, &state.x, &state.v, work);
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
        let bytes = 2 * t.rows.x.len() * 8;
        assert!(bytes as u64 <= BUDGET + 2 * 48_000, "{bytes}");
        assert!(t.len() as u64 >= FEWEST);
    }

    /// One particle whose x is the step number.
    fn rows(steps: impl Iterator<Item = u64>) -> Rows {
        let steps: Vec<u64> = steps.collect();
        let x: Vec<f64> = steps.iter().flat_map(|s| [*s as f64; 3]).collect();
        Rows {
            timestep: 0.5,
            dim: 3,
            v: Some(x.clone()),
            steps,
            x,
            precision: Precision::Double,
            precision_v: Precision::Double,
            cut: false,
        }
    }

    fn state(rows: &Rows, k: usize) -> State {
        State::new(rows.x(k).to_vec(), rows.x(k).to_vec())
    }

    fn from_rows(rows: &Rows, last: u64) -> Trajectory {
        Trajectory::of_rows(rows, &vec![Work::default(); rows.len()], last, false)
    }

    #[test]
    fn every_step_given_is_recorded_as_a_running_solver_would_be() {
        for last in [1, 2, 1998, 1999, 2000, 2001, 3998, 3999, 10_007] {
            let rows = rows(0..=last);
            let mut recorder = Recorder::new(last, 3, 0.5);
            let mut due = recorder.next(0);
            for k in 0..rows.len() {
                if due == Some(k as u64) {
                    recorder.observe(k as u64, &state(&rows, k));
                    due = recorder.next(k as u64 + 1);
                }
            }
            assert_eq!(from_rows(&rows, last), recorder.finish(), "{last}");
        }
    }

    #[test]
    fn sparse_rows_are_all_kept_until_there_are_too_many() {
        // A run of 10,000 steps has its instants every 6 steps.
        let tenth = from_rows(&rows((0..=10_000).step_by(10)), 10_000);
        assert_eq!(tenth.len(), 1_001);
        assert_eq!(tenth.following(3), None);
        // Every 5th of a million: 200,001 rows, of which few are on the multiples of 501.
        let many = from_rows(&rows((0..=1_000_000).step_by(5)), 1_000_000);
        assert!((1_000..=2_000).contains(&many.len()), "{}", many.len());
        assert_eq!(many.step(many.len() - 1), 1_000_000);
        for k in 0..many.len() {
            assert_eq!(many.x(k)[0], many.step(k) as f64);
        }
    }
}
