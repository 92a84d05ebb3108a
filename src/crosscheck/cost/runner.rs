//! What runs a setting: an engine at a fixed step, or an adaptive pair that chooses its own.

use super::setting::Setting;
use super::witness::Kept;
use crate::engines::{AdaptiveEngine, Ended, Engine, Limits, Observer, adapt, simulate};
use crate::system::State;

/// At its start; runs once.
pub(super) enum Runner {
    Fixed(Box<dyn Engine>),
    Adaptive(Box<AdaptiveEngine>),
}

impl Runner {
    /// To the end, unless it diverges or fails; states go to `eye`. None where a pair takes more steps than
    /// its setting allows.
    pub fn run(&mut self, setting: &Setting, limits: &Limits, eye: &mut Eye) -> Option<Ended> {
        match self {
            Self::Fixed(engine) => {
                let ended = simulate(engine.as_mut(), setting.steps(), limits, eye, &|_| {});
                Some(ended)
            }
            Self::Adaptive(engine) => {
                eye.see(engine.state());
                let ended = adapt(engine, limits, setting.most(), &mut |state| eye.see(state));
                eye.close(engine.state());
                ended
            }
        }
    }

    /// What takes the steps.
    pub fn engine(&mut self) -> &mut dyn Engine {
        match self {
            Self::Fixed(engine) => engine.as_mut(),
            Self::Adaptive(engine) => engine.as_mut(),
        }
    }

    /// Steps taken, where it chose them.
    pub fn steps(&self) -> Option<u64> {
        match self {
            Self::Fixed(_) => None,
            Self::Adaptive(engine) => Some(engine.steps()),
        }
    }
}

/// Keeps evenly spaced states of a run, and its last; with no room, none.
pub(super) struct Eye {
    /// Seconds; of steps that are all alike.
    timestep: f64,
    /// Steps from one kept state to the next.
    stride: u64,
    last: u64,
    room: usize,
    seen: u64,
    pub kept: Kept,
}

impl Eye {
    /// For about so many states.
    pub fn new(setting: &Setting, room: u64) -> Self {
        let steps = setting.steps();
        let fixed = setting.tolerance().is_none();
        Self {
            timestep: setting.timestep(),
            stride: if fixed {
                steps.div_ceil(room - 1).max(1)
            } else {
                1
            },
            last: steps,
            room: room as usize,
            seen: 0,
            kept: Kept::default(),
        }
    }

    /// One that looks at nothing.
    pub fn closed() -> Self {
        Self {
            timestep: 0.0,
            stride: 0,
            last: 0,
            room: 0,
            seen: 0,
            kept: Kept::default(),
        }
    }

    /// The next state of a run whose number of steps nobody knows: where there is no more room, every
    /// other one kept is dropped, and from then on every other one kept.
    fn see(&mut self, state: &State) {
        if self.room == 0 {
            return;
        }
        if self.seen.is_multiple_of(self.stride) {
            if self.kept.t.len() == self.room {
                self.kept.halve();
                self.stride *= 2;
            }
            if self.seen.is_multiple_of(self.stride) {
                self.kept.push(state.t, state);
            }
        }
        self.seen += 1;
    }

    /// The end, unless it is there already.
    fn close(&mut self, state: &State) {
        if self.room > 0 && self.kept.t.last() != Some(&state.t) {
            self.kept.push(state.t, state);
        }
    }
}

impl Observer for Eye {
    fn next(&self, from: u64) -> Option<u64> {
        if self.room == 0 || from > self.last {
            return None;
        }
        let due = from.div_ceil(self.stride) * self.stride;
        Some(due.min(self.last))
    }

    fn observe(&mut self, step: u64, state: &State) {
        self.kept.push(step as f64 * self.timestep, state);
    }
}
