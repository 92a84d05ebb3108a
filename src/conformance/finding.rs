//! What came of a law.

use crate::measure::{Check, CheckStatus};
use std::cmp::Ordering;
use std::fmt::Display;

/// What one law found of one integrator.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// The law's id.
    pub law: &'static str,
    /// `Skip` where nothing was claimed, `Inconclusive` where the law cannot tell.
    pub status: CheckStatus,
    /// What was measured, finite; its meaning is the law's.
    pub measured: Option<f64>,
    /// What it was held against.
    pub bound: Option<f64>,
    /// Where the bound comes from.
    pub derivation: &'static str,
    /// One plain sentence.
    pub message: String,
}

impl Finding {
    /// The same as a report's check on `subject`, the integrator's name.
    pub fn check(&self, subject: &str) -> Check {
        Check {
            id: self.law.to_owned(),
            subject: subject.to_owned(),
            status: self.status,
            measured: self.measured,
            bound: self.bound,
            derivation: self.derivation.to_owned(),
            message: self.message.clone(),
        }
    }

    /// Without what stands on the law's row, which [`Law::check`](super::Law::check) adds.
    pub(super) fn new(
        status: CheckStatus,
        measured: impl Into<Option<f64>>,
        bound: impl Into<Option<f64>>,
        message: impl Display,
    ) -> Self {
        Self {
            law: "",
            status,
            measured: measured.into(),
            bound: bound.into(),
            derivation: "",
            message: message.to_string(),
        }
    }

    /// Passes or fails.
    pub(super) fn of(
        holds: bool,
        measured: impl Into<Option<f64>>,
        bound: impl Into<Option<f64>>,
        message: impl Display,
    ) -> Self {
        let status = if holds {
            CheckStatus::Pass
        } else {
            CheckStatus::Fail
        };
        Self::new(status, measured, bound, message)
    }

    /// The one to be told: a failure before what cannot be told before what passes, and among
    /// equals the one whose measurement is farthest `off`.
    pub(super) fn worst(findings: Vec<Self>, off: impl Fn(f64) -> f64) -> Option<Self> {
        let severity = |finding: &Self| match finding.status {
            CheckStatus::Fail => 3,
            CheckStatus::Inconclusive => 2,
            CheckStatus::Pass => 1,
            CheckStatus::Skip => 0,
        };
        let key = |finding: &Self| (severity(finding), finding.measured.map_or(0.0, &off));
        (findings.into_iter()).max_by(|a, b| key(a).partial_cmp(&key(b)).unwrap_or(Ordering::Equal))
    }

    /// Nothing was claimed.
    pub(super) fn skip(what: &str) -> Self {
        let message = format!("nothing is claimed of {what}");
        Self::new(CheckStatus::Skip, None, None, message)
    }

    /// Passes below the bound or at it. NaN fails.
    pub(super) fn at_most(measured: f64, bound: f64, what: &str) -> Self {
        let message = format!("{what}: off by {measured:.1e}");
        Self::of(measured <= bound, measured, bound, message)
    }

    /// A defect that is at most `bound` for whoever has the property, and that is far larger for
    /// whoever has not: a hundredfold. In between, a denial can be neither believed nor refuted.
    pub(super) fn of_property(claimed: bool, defect: f64, bound: f64, property: &str) -> Self {
        const FAR: f64 = 100.0;
        if claimed {
            return Self::at_most(defect, bound, &format!("claims to be {property}"));
        }
        let (status, bound, message) = if defect <= bound {
            let message = format!("claims not to be {property}, but is: off by {defect:.1e} only");
            (CheckStatus::Fail, bound, message)
        } else if defect <= FAR * bound {
            let message =
                format!("claims not to be {property}, and is nearly: off by {defect:.1e}");
            (CheckStatus::Inconclusive, FAR * bound, message)
        } else {
            let message = format!("is not {property}, as claimed: off by {defect:.1e}");
            (CheckStatus::Pass, FAR * bound, message)
        };
        Self::new(status, defect, bound, message)
    }
}
