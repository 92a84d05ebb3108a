//! What one case left: raw, before anything is measured.

use crate::solvers::{Counts, Status};
use crate::trajectory::Trajectory;
use crate::verbs::clock::WallTime;

/// What one case left: raw, before anything is measured.
pub struct Record {
    pub status: Status,
    /// Why it did not run to its end.
    pub reason: Option<String>,
    /// Steps taken.
    pub steps: u64,
    /// None where nothing is known of it but the reason.
    pub trajectory: Option<Trajectory>,
    pub counts: Counts,
    /// None of a file, and where nothing ran.
    pub wall: Option<WallTime>,
    /// What else is to be said of it.
    pub remarks: Vec<String>,
}

impl Record {
    /// Of a case that did not run.
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
