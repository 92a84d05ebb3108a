//! The data a run leaves behind: a thinned record in memory, and files of every step.
//!
//! An [`Observer`] sees the states of a run as they come, from the code that takes the steps.

mod csv;
mod npz;
mod read;
mod record;
mod rows;

pub use csv::{CsvWriter, Values};
pub use npz::{NpzWriter, Scratch};
pub use read::{ErrorPlace, Expected, FreeAxis, Layout, Plane, ReadError, free_axis, limits, read};
pub use record::{Recorder, Trajectory, stride};
pub use rows::{Precision, Rows};

use crate::physics::State;

/// Sees the states of a run.
pub trait Observer {
    /// The first step number, at or after `from`, at which it wants the state; None for no more.
    fn next(&self, from: u64) -> Option<u64>;

    /// Takes the state at step `step` (0 is the start); called in order at the steps `next` gave.
    fn observe(&mut self, step: u64, state: &State);

    /// Takes the state a run diverged in, if it is finite: the last one of this run.
    fn observe_diverged(&mut self, step: u64, state: &State) {
        self.observe(step, state);
    }

    /// Takes the last state of a run whose number of steps was not known, unless it was observed.
    fn observe_end(&mut self, _step: u64, _state: &State) {}
}

/// The observer of a run nobody watches.
#[derive(Debug, Clone, Copy, Default)]
pub struct Unwatched;

impl Observer for Unwatched {
    fn next(&self, _from: u64) -> Option<u64> {
        None
    }
    fn observe(&mut self, _step: u64, _state: &State) {}
}

/// A trajectory file could not be written.
#[derive(Debug, thiserror::Error)]
pub enum SaveError {
    #[error("could not write the trajectory")]
    Io(#[from] std::io::Error),
    #[error("could not pack the trajectory")]
    Zip(#[from] zip::result::ZipError),
}

/// The steps a file of every `every`-th step holds: those, and the last.
#[derive(Debug, Clone, Copy)]
struct Selection {
    every: u64,
    steps: u64,
}

impl Selection {
    fn new(every: u64, steps: u64) -> Self {
        let every = every.max(1);
        Self { every, steps }
    }

    fn next(self, from: u64) -> Option<u64> {
        let due = from.div_ceil(self.every) * self.every;
        (from <= self.steps).then(|| due.min(self.steps))
    }
}
