//! What one case left: raw, before anything is measured.

use crate::solvers::{Counts, Status, Unsupported};
use crate::trajectory::Trajectory;
use crate::verbs::clock::WallTime;

/// What one case left.
pub enum Run {
    Unsupported(Unsupported),
    /// Nothing is known of it but why.
    Failed(String),
    Ran(Box<Ran>),
}

/// A case that ran, to its end or not.
pub struct Ran {
    pub status: Status,
    /// Why it did not run to its end.
    pub reason: Option<String>,
    /// Steps taken.
    pub steps: u64,
    pub trajectory: Trajectory,
    pub counts: Counts,
    /// None of a file.
    pub wall: Option<WallTime>,
    /// What else is to be said of it.
    pub remarks: Vec<String>,
}
