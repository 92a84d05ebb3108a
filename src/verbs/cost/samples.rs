//! What is kept of a run: few enough states for every run of a sweep to be kept.

use crate::physics::{State, Work};
use crate::solvers::Setting;
use crate::trajectory::Observer;
use crate::truth::States;

/// States of a run at some instants, the start and the end among them.
#[derive(Debug, Clone, Default)]
pub struct Samples {
    /// Seconds, ascending.
    pub t: Vec<f64>,
    pub states: States,
    pub work: Vec<Work>,
}

impl Samples {
    fn push(&mut self, state: &State) {
        self.t.push(state.t);
        self.states.dim = state.x.len();
        self.states.push(&state.x, &state.v);
        self.work.push(state.work);
    }

    /// Every other instant, beginning with the first.
    fn halve(&mut self) {
        let dim = self.states.dim;
        let left = self.t.len().div_ceil(2);
        for to in 0..left {
            let from = 2 * to;
            self.t[to] = self.t[from];
            self.work[to] = self.work[from];
            for values in [&mut self.states.x, &mut self.states.v] {
                values.copy_within(from * dim..(from + 1) * dim, to * dim);
            }
        }
        self.t.truncate(left);
        self.work.truncate(left);
        self.states.x.truncate(left * dim);
        self.states.v.truncate(left * dim);
    }
}

/// Keeps evenly spaced states of a run, its start and its end.
pub struct Sampler {
    /// Steps from one kept state to the next.
    stride: u64,
    /// The last step; None where the solver chooses its steps.
    last: Option<u64>,
    /// Instants at most, where the last step is not known.
    room: usize,
    pub samples: Samples,
}

impl Sampler {
    /// For about `room` states, at least two.
    pub fn new(setting: &Setting, room: u64) -> Self {
        let known = setting.tolerance().is_none().then(|| setting.steps());
        Self {
            stride: known.map_or(1, |steps| steps.div_ceil(room - 1).max(1)),
            last: known,
            room: room as usize,
            samples: Samples::default(),
        }
    }
}

impl Observer for Sampler {
    fn next(&self, from: u64) -> Option<u64> {
        let due = from.div_ceil(self.stride) * self.stride;
        match self.last {
            Some(last) if from > last => None,
            Some(last) => Some(due.min(last)),
            None => Some(due),
        }
    }

    /// Where there is no more room, every other state kept is dropped, and from then on every other one
    /// kept.
    fn observe(&mut self, step: u64, state: &State) {
        if self.last.is_none() && self.samples.t.len() == self.room {
            self.samples.halve();
            self.stride *= 2;
        }
        if self.last.is_some() || step.is_multiple_of(self.stride) {
            self.samples.push(state);
        }
    }

    fn observe_end(&mut self, _step: u64, state: &State) {
        if self.samples.t.last() != Some(&state.t) {
            self.samples.push(state);
        }
    }
}
