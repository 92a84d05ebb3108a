//! What a proof says, and how its measurement is judged.

use super::lockstep::{Path, distance};
use super::{Proof, Status};
use crate::solvers::Unsupported;

/// A proof that could not tell a relative error of this size is none.
const BLUNT: f64 = 1e-6;

/// What a proof sets out to show.
pub(super) struct Claim {
    pub(super) id: &'static str,
    pub(super) subject: &'static str,
    /// The integrator of ours that the subject must be.
    pub(super) method: &'static str,
}

impl Claim {
    pub(super) fn judge(
        &self,
        ours: &Path,
        theirs: &Path,
        bound: f64,
        derivation: String,
    ) -> Proof {
        let (subject, method) = (self.subject, self.method);
        let measured = distance(ours, theirs);
        if let Some(reason) = ours.ended() {
            let message = format!("{method} could not take these steps: {reason}");
            return self.undecided(measured, bound, derivation, message);
        }
        if bound.is_nan() || bound > BLUNT {
            let message = format!(
                "rounding alone may move this scene by {bound:.0e} in a few steps: it proves nothing"
            );
            return self.undecided(measured, bound, derivation, message);
        }
        let (status, message) = match measured {
            Some(0.0) => (Status::Pass, format!("{subject} is {method}, bit for bit")),
            Some(d) if d <= bound => (
                Status::Pass,
                format!("{subject} is {method} to {d:.0e}, rounding ({bound:.0e})"),
            ),
            Some(d) => (
                Status::Fail,
                format!("{subject} is {d:.0e} away from {method}; rounding explains {bound:.0e}"),
            ),
            None => (
                Status::Fail,
                format!("{subject} left the finite numbers, {method} did not"),
            ),
        };
        self.proof(status, measured, bound, derivation, message)
    }

    pub(super) fn undecided(
        &self,
        measured: Option<f64>,
        bound: f64,
        derivation: String,
        message: String,
    ) -> Proof {
        self.proof(Status::Inconclusive, measured, bound, derivation, message)
    }

    pub(super) fn skip(&self, unsupported: &Unsupported) -> Proof {
        let reason = unsupported.reason.clone();
        self.proof(Status::Skip, None, 0.0, String::new(), reason)
    }

    fn proof(
        &self,
        status: Status,
        measured: Option<f64>,
        bound: f64,
        derivation: String,
        message: String,
    ) -> Proof {
        Proof {
            id: self.id,
            subject: self.subject,
            status,
            measured,
            bound,
            derivation,
            message,
        }
    }
}
