//! The states a run keeps: few enough that every run of a sweep can keep them.

use crate::physics::{State, Work};
use crate::solvers::Setting;
use crate::trajectory::Observer;
use crate::truth::States;

/// States of a run at some instants, with the start and the end.
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

    /// Keeps every other instant, beginning with the first.
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
    /// The most instants kept where the last step is not known.
    max_instants: usize,
    pub samples: Samples,
}

impl Sampler {
    /// Keeps about `max_instants` states, at least two.
    pub fn new(setting: &Setting, max_instants: u64) -> Self {
        let known = setting.tolerance().is_none().then(|| setting.steps());
        Self {
            stride: known.map_or(1, |steps| steps.div_ceil(max_instants - 1).max(1)),
            last: known,
            max_instants: max_instants as usize,
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

    /// When no more states may be kept, every other one is dropped and the stride doubles.
    fn observe(&mut self, step: u64, state: &State) {
        if self.last.is_none() && self.samples.t.len() == self.max_instants {
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
