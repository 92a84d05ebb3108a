//! The record of a run that is already over: rows in, thinned as a running one would be.

use super::record::{most_instants, stride};
use super::{Rows, Trajectory};
use crate::system::State;

/// Fills a [`Trajectory`] from rows that come in order.
#[derive(Debug)]
pub struct RowRecorder<'a> {
    steps: &'a [u64],
    thinning: Thinning,
    trajectory: Trajectory,
}

/// Which rows become instants, beside the first and the last.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Thinning {
    None,
    /// Those at multiples of so many steps, where every other run has its instants too.
    Steps(u64),
    /// Every so many-th: rows that leave out too many steps to have those.
    Rows(usize),
}

impl<'a> RowRecorder<'a> {
    /// For rows of a run that was to take `last` steps. Their velocities count as known if they
    /// have any.
    pub fn new(rows: &'a Rows, last: u64) -> Self {
        let particles = rows.dim / 3;
        let (stride, most) = (stride(last, particles), most_instants(particles) as usize);
        let shared = rows
            .steps
            .iter()
            .filter(|s| s.is_multiple_of(stride))
            .count();
        let thinning = if rows.len() <= most {
            Thinning::None
        } else if shared >= most / 2 {
            Thinning::Steps(stride)
        } else {
            Thinning::Rows((rows.len() - 1).div_ceil(most - 1))
        };
        let room = rows.len().min(most);
        Self {
            steps: &rows.steps,
            thinning,
            trajectory: Trajectory::with_room(
                rows.dim,
                rows.timestep,
                rows.v.is_some(),
                [room, room],
            )
            .given_to([rows.precision, rows.precision_v]),
        }
    }

    /// Row `k`, of which it keeps what it needs.
    pub fn observe(&mut self, k: usize, state: &State) {
        let Some(&step) = self.steps.get(k) else {
            return;
        };
        if self.is_instant(k) {
            self.trajectory.push(step, state);
        } else if k > 0 && self.is_instant(k - 1) && self.steps[k - 1] + 1 == step {
            self.trajectory.push_successor(step, state);
        }
    }

    /// Row `k` in which the run diverged: its last instant.
    pub fn observe_diverged(&mut self, k: usize, state: &State) {
        if let Some(&step) = self.steps.get(k) {
            self.trajectory.push(step, state);
        }
    }

    pub fn finish(self) -> Trajectory {
        self.trajectory
    }

    fn is_instant(&self, k: usize) -> bool {
        let by_thinning = match self.thinning {
            Thinning::None => true,
            Thinning::Steps(stride) => self.steps[k].is_multiple_of(stride),
            Thinning::Rows(pitch) => k.is_multiple_of(pitch),
        };
        by_thinning || k + 1 == self.steps.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engines::Observer;
    use crate::trajectory::{Precision, Recorder};

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
        }
    }

    fn state(rows: &Rows, k: usize) -> State {
        State::new(rows.x(k).to_vec(), rows.x(k).to_vec())
    }

    fn recalled(rows: &Rows, last: u64) -> Trajectory {
        let mut recorder = RowRecorder::new(rows, last);
        for k in 0..rows.len() {
            recorder.observe(k, &state(rows, k));
        }
        recorder.finish()
    }

    #[test]
    fn every_step_given_is_recorded_as_a_running_engine_would_be() {
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
            assert_eq!(recalled(&rows, last), recorder.finish(), "{last}");
        }
    }

    #[test]
    fn sparse_rows_are_all_kept_until_there_are_too_many() {
        // A run of 10,000 steps has its instants every 6 steps.
        let tenth = recalled(&rows((0..=10_000).step_by(10)), 10_000);
        assert_eq!(tenth.len(), 1_001);
        assert_eq!(tenth.following(3), None);
        // Every 5th of a million: 200,001 rows, of which few are on the multiples of 501.
        let many = recalled(&rows((0..=1_000_000).step_by(5)), 1_000_000);
        assert!((1_000..=2_000).contains(&many.len()), "{}", many.len());
        assert_eq!(many.step(many.len() - 1), 1_000_000);
        for k in 0..many.len() {
            assert_eq!(many.x(k)[0], many.step(k) as f64);
        }
    }
}
