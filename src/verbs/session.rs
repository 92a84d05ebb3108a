//! The interface between a verb's work and its surroundings: files, progress, stored truths.

use crate::trajectory::Observer;
use crate::trajectory::SaveError;
use crate::truth::{NoStore, Store};

/// The services a verb's work uses: files to save to, a progress display, a store of truths.
pub trait Session: Sync {
    /// The saver of this case's steps; None if they are not saved.
    ///
    /// # Errors
    /// Fails when the file cannot be made.
    fn saver(&self, case: &Label) -> Result<Option<Box<dyn Saver>>, SaveError>;

    /// Reports further progress, in the units of the plan: steps of one particle, or nominal microseconds.
    fn progress(&self, units: u64);

    /// The store that keeps truths from one run to the next.
    fn store(&self) -> &dyn Store {
        &NoStore
    }
}

/// Saves a run as it goes.
pub trait Saver: Observer {
    /// Completes the file.
    ///
    /// # Errors
    /// Returns the first failure, whenever it happened.
    fn finish(self: Box<Self>) -> Result<(), SaveError>;
}

/// A session that saves nothing and shows nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct Quiet;

impl Session for Quiet {
    fn saver(&self, _case: &Label) -> Result<Option<Box<dyn Saver>>, SaveError> {
        Ok(None)
    }

    fn progress(&self, _units: u64) {}
}

/// Identifies the run that something belongs to.
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    /// The engine's id.
    pub engine: String,
    /// The timestep, s.
    pub timestep: f64,
    pub steps: u64,
    pub particles: usize,
}

impl Label {
    /// The time at which the run ends, s.
    pub fn end(&self) -> f64 {
        self.steps as f64 * self.timestep
    }
}

/// Expected wall time of one case, s; of what is done beside them its label has no steps.
#[derive(Debug, Clone)]
pub struct TimeEstimate {
    pub label: Label,
    pub seconds: f64,
}
