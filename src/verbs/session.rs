//! What the work of a verb needs from the outside, and what it is called there.

use crate::trajectory::Observer;
use crate::trajectory::SaveError;
use crate::truth::{NoStore, Store};

/// What a run needs from the outside: files to save to, somebody to show progress.
pub trait Session: Sync {
    /// Where every step of this case goes; None if nowhere.
    ///
    /// # Errors
    /// When the file cannot be made.
    fn saver(&self, case: &Label) -> Result<Option<Box<dyn Saver>>, SaveError>;

    /// So much more is done, in the units of the plan: steps, or nominal microseconds.
    fn progress(&self, steps: u64);

    /// Where truths are kept from one run to the next.
    fn store(&self) -> &dyn Store {
        &NoStore
    }
}

/// Saves a run as it goes.
pub trait Saver: Observer {
    /// Completes the file.
    ///
    /// # Errors
    /// The first failure, whenever it happened.
    fn finish(self: Box<Self>) -> Result<(), SaveError>;
}

/// A session that saves nothing and shows nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct Quiet;

impl Session for Quiet {
    fn saver(&self, _case: &Label) -> Result<Option<Box<dyn Saver>>, SaveError> {
        Ok(None)
    }

    fn progress(&self, _steps: u64) {}
}

/// Which run something belongs to.
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    pub engine: String,
    /// Seconds.
    pub timestep: f64,
    pub steps: u64,
    pub particles: usize,
}

impl Label {
    /// When the run ends, s.
    pub fn end(&self) -> f64 {
        self.steps as f64 * self.timestep
    }
}

/// Expected wall time of one case.
#[derive(Debug, Clone)]
pub struct Estimate {
    pub label: Label,
    pub seconds: f64,
}
