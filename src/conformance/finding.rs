//! The result of a law.

use crate::measure::{Check, CheckStatus};
use std::cmp::Ordering;
use std::fmt::Display;

/// The result of one law on one integrator.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// The law's id.
    pub law: &'static str,
    /// `Skip` where nothing was claimed, `Inconclusive` where the law cannot decide.
    pub status: CheckStatus,
    /// The measured number, finite; the law defines its meaning.
    pub measured: Option<f64>,
    /// The bound it was compared with.
    pub bound: Option<f64>,
    /// Where the bound comes from.
    pub derivation: &'static str,
    /// The result in one plain sentence.
    pub message: String,
}

impl Finding {
    /// Converts it to a report's check; `subject` is the integrator's name.
    pub fn check(&self, subject: &str) -> Check {
        Check {
            id: self.law.to_owned(),
            subject: subject.to_owned(),
            status: self.status,
            measured: self.measured,
            bound: self.bound,
            derivation: self.derivation.to_owned(),
            message: self.message.clone(),
            ..Check::default()
        }
    }

    /// A finding without the fields of the law's row, which [`Law::check`](super::Law::check) adds.
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

    /// A finding that passes if the law `holds`, else fails.
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

    /// The worst finding: failed before inconclusive before passed, and among equals the one whose
    /// measurement is farthest `off`.
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

    /// A finding that is skipped, since nothing was claimed.
    pub(super) fn skip(what: &str) -> Self {
        let message = format!("nothing is claimed of {what}");
        Self::new(CheckStatus::Skip, None, None, message)
    }

    /// A finding that passes if the measurement is at most the bound. NaN fails.
    pub(super) fn at_most(measured: f64, bound: f64, what: &str) -> Self {
        let message = format!("{what}: off by {measured:.1e}");
        Self::of(measured <= bound, measured, bound, message)
    }

    /// A finding on a claimed or denied property. With the property the defect is at most `bound`; without
    /// it, more than a hundred times larger. In between, a denial can be neither confirmed nor refuted.
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
