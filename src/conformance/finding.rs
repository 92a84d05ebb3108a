//! What came of a law.

use super::Law;
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
    pub derivation: String,
    /// One plain sentence.
    pub message: String,
}

impl Finding {
    pub(super) fn new(law: &Law, verdict: Verdict) -> Self {
        let finite = |number: Option<f64>| number.filter(|number| number.is_finite());
        Self {
            law: law.id,
            status: verdict.status,
            measured: finite(verdict.measured),
            bound: finite(verdict.bound),
            derivation: law.derivation.to_owned(),
            message: verdict.message,
        }
    }

    /// The same as a report's check on `subject`, the integrator's name.
    pub fn check(&self, subject: &str) -> Check {
        Check {
            id: self.law.to_owned(),
            subject: subject.to_owned(),
            status: self.status,
            measured: self.measured,
            bound: self.bound,
            derivation: self.derivation.clone(),
            message: self.message.clone(),
        }
    }
}

/// A finding without what stands on the law's row.
pub(super) struct Verdict {
    pub status: CheckStatus,
    pub measured: Option<f64>,
    pub bound: Option<f64>,
    pub message: String,
}

impl Verdict {
    pub fn new(
        status: CheckStatus,
        measured: impl Into<Option<f64>>,
        bound: impl Into<Option<f64>>,
        message: impl Display,
    ) -> Self {
        Self {
            status,
            measured: measured.into(),
            bound: bound.into(),
            message: message.to_string(),
        }
    }

    pub fn fail(
        measured: impl Into<Option<f64>>,
        bound: impl Into<Option<f64>>,
        message: impl Display,
    ) -> Self {
        Self::new(CheckStatus::Fail, measured, bound, message)
    }

    /// The one to be told: a failure before what cannot be told before what passes, and among
    /// equals the one whose measurement is farthest `off`.
    pub fn worst(
        verdicts: impl IntoIterator<Item = Self>,
        off: impl Fn(f64) -> f64,
    ) -> Option<Self> {
        let severity = |verdict: &Self| match verdict.status {
            CheckStatus::Fail => 3,
            CheckStatus::Inconclusive => 2,
            CheckStatus::Pass => 1,
            CheckStatus::Skip => 0,
        };
        let key = |verdict: &Self| (severity(verdict), verdict.measured.map_or(0.0, &off));
        verdicts
            .into_iter()
            .max_by(|a, b| key(a).partial_cmp(&key(b)).unwrap_or(Ordering::Equal))
    }

    /// Nothing was claimed.
    pub fn skip(what: &str) -> Self {
        Self::new(
            CheckStatus::Skip,
            None,
            None,
            format!("nothing is claimed of {what}"),
        )
    }

    /// Passes below the bound or at it. NaN fails.
    pub fn at_most(measured: f64, bound: f64, what: &str) -> Self {
        let status = if measured <= bound {
            CheckStatus::Pass
        } else {
            CheckStatus::Fail
        };
        let message = format!("{what}: off by {measured:.1e}");
        Self::new(status, measured, bound, message)
    }

    /// A defect that is at most `bound` for whoever has the property, and that is far larger for
    /// whoever has not: a hundredfold. In between, a denial can be neither believed nor refuted.
    pub fn of_property(claimed: bool, defect: f64, bound: f64, property: &str) -> Self {
        const FAR: f64 = 100.0;
        let (status, bound, message) = if claimed {
            let verdict = Self::at_most(defect, bound, &format!("claims to be {property}"));
            (verdict.status, bound, verdict.message)
        } else if defect <= bound {
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
