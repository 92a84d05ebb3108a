//! The raw record of one case.

use crate::solvers::{Counts, Status};
use crate::trajectory::Trajectory;
use crate::verbs::clock::WallTime;

/// The raw record of one case, before anything is measured.
pub struct Record {
    pub status: Status,
    /// Why it did not run to its end.
    pub reason: Option<String>,
    /// Steps taken.
    pub steps: u64,
    /// None where only the reason is known.
    pub trajectory: Option<Trajectory>,
    pub counts: Counts,
    /// None for a file, and where nothing ran.
    pub wall: Option<WallTime>,
    /// Further remarks for its outcome.
    pub remarks: Vec<String>,
}

impl Record {
    /// The record of a case that did not run.
    pub fn none(status: Status, reason: String) -> Self {
        Self {
            status,
            reason: Some(reason),
            steps: 0,
            trajectory: None,
            counts: Counts::default(),
            wall: None,
            remarks: Vec::new(),
        }
    }
}
