//! The checks of the gate, a row each: what it requires, where its bound comes from, what to do. Laws judge the
//! runs of a plan; the other rows are made elsewhere and stand here to be explained, and to be skipped by their id.

mod balance;
mod energy;
mod forces;
mod identity;
mod limits;
mod momenta;
mod subject;

pub(super) use identity::SCHEME;
pub(super) use subject::{Ran, Subject};

use crate::measure::{Check, CheckStatus};

/// A check that the gate makes.
pub struct Row {
    pub id: &'static str,
    /// What it requires, in one sentence.
    pub requires: &'static str,
    /// Where its bound comes from.
    pub derivation: &'static str,
    /// What to do where it fails.
    pub remedy: &'static str,
    /// Judges the runs of a plan, a check for each subject it applies to; None for a check that is made elsewhere.
    pub(super) judge: Option<fn(&Ran) -> Vec<Check>>,
}

/// The order of a program that claims one; it is measured in [`claims`](super::claims).
pub(super) const CLAIMED_ORDER: Row = Row {
    id: "claimed-order",
    requires: "halving the step of a program twice divides its error as the method does that it claims to be",
    derivation: "the two slopes of ln error over ln step agree within 0.3 where the steps are small enough, and \
                 lie no more than 0.3 below the order",
    remedy: "look for a wrong coefficient, a force taken at the wrong time, or a velocity of another stage; where the \
             slopes do not agree, take a smaller timestep",
    judge: None,
};

/// Every check, in the order results are listed.
pub static CHECKS: &[Row] = &[
    limits::COMPLETES,
    identity::SCHEME,
    Row {
        id: "expect",
        requires: "an engine does what the scene's `expect` says of it",
        derivation: "the scene's author",
        remedy: "read what was found beside what was expected: the engine is wrong, or the expectation is",
        judge: None,
    },
    limits::LIMIT,
    identity::SAME_BITS,
    forces::LAW,
    balance::LAW,
    energy::BOUNDED,
    energy::DISSIPATION,
    momenta::MOMENTUM,
    momenta::CENTER,
    momenta::ANGULAR,
    Row {
        id: "order",
        requires: "halving the step divides the error by 2 to the power of the method's order",
        derivation: "the slope of ln error over ln step, extrapolated from at least four that agree within 0.05",
        remedy: "look for a wrong coefficient, a force taken at the wrong time, or a velocity of another stage; \
                 `compare` says which scheme the program really is",
        judge: None,
    },
    CLAIMED_ORDER,
    Row {
        id: "twin-forces",
        requires: "rapier's bodies under this program's forces are symplectic Euler, to rounding",
        derivation: "16 steps of the scene from a disturbed start, against what rounding explains",
        remedy: "the mirror of the scene in rapier differs from the hand-written one: compare masses, gravity and forces",
        judge: None,
    },
    Row {
        id: "twin-joints",
        requires: "rapier's spring joints, swept until they converge, are linearly implicit Euler, to rounding",
        derivation: "4 steps of the scene from a disturbed start, against what rounding explains",
        remedy: "the joints differ from the scene's springs: compare stiffness, damping, rest length and masses",
        judge: None,
    },
    Row {
        id: "twin-fall",
        requires: "rapier's fall under constant forces is symplectic Euler, to rounding",
        derivation: "4 steps of the scene against what rounding explains",
        remedy: "compare gravity, its axis and its sign",
        judge: None,
    },
    Row {
        id: "twin-contact",
        requires: "rapier's contact, swept until it converges, is the step of `rapier_contact`, to rounding",
        derivation: "each step of the scene from its start until 64 had contact, from the state that rapier had, against what \
                     rounding explains",
        remedy: "the obstacles differ from the scene's: compare places, normals, restitution, friction, radii and masses",
        judge: None,
    },
    Row {
        id: "twin-user-forces",
        requires: "rapier's bodies hold the forces of a step's start over their substeps, to rounding",
        derivation: "16 steps of the scene against what rounding explains",
        remedy: "the mirror of the scene in rapier differs from the hand-written one: compare masses, gravity and forces",
        judge: None,
    },
    Row {
        id: "baseline",
        requires: "counts, errors, energies and schemes are those of the accepted run",
        derivation: "counts and words are equal; other numbers within a millionth, or 1e-12 in their unit",
        remedy: "look at what moved: accept it with --accept FILE where it was meant",
        judge: None,
    },
    Row {
        id: "judging",
        requires: "nothing: it says which checks would have taken longer than the runs",
        derivation: "judging a run costs no more than the run",
        remedy: "nothing",
        judge: None,
    },
    Row {
        id: "energy-scale",
        requires: "nothing: it says that energy errors have no relative size in this scene",
        derivation: "S = K(0) + U_elastic(0), else the sum of m |g| L",
        remedy: "nothing",
        judge: None,
    },
];

/// The check of this id.
pub fn find(id: &str) -> Option<&'static Row> {
    CHECKS.iter().find(|row| row.id == id)
}

impl Row {
    /// A check of this row that holds or does not; its first moment, cause and key are to be added.
    pub(super) fn of(&self, subject: &str, holds: bool, message: String) -> Check {
        let status = if holds {
            CheckStatus::Pass
        } else {
            CheckStatus::Fail
        };
        self.with(subject, status, message)
    }

    /// A check of this row with any status.
    pub(super) fn with(&self, subject: &str, status: CheckStatus, message: String) -> Check {
        Check {
            id: self.id.to_owned(),
            subject: subject.to_owned(),
            status,
            derivation: self.derivation.to_owned(),
            message,
            ..Check::default()
        }
    }

    /// A check of numbers over time: each is to be at most its bound. The one that uses up most of its bound is
    /// stated, and the first that breaks it. None without numbers.
    pub(super) fn over_time(
        &self,
        subject: &str,
        what: &str,
        instants: impl Iterator<Item = Instant>,
    ) -> Option<Check> {
        let mut worst: Option<Instant> = None;
        let mut first = None;
        for instant in instants {
            if !instant.holds() {
                first.get_or_insert(instant.t);
            }
            if worst.is_none_or(|worst| instant.part() > worst.part()) {
                worst = Some(instant);
            }
        }
        let worst = worst?;
        let finite = |x: f64| Some(x).filter(|x| x.is_finite());
        let message = format!("{what}: {:.3e}, at most {:.3e}", worst.found, worst.bound);
        Some(Check {
            measured: finite(worst.found),
            bound: finite(worst.bound),
            first_s: first,
            ..self.of(subject, first.is_none(), message)
        })
    }
}

/// A number at a time, and its bound.
#[derive(Debug, Clone, Copy)]
pub(super) struct Instant {
    /// s.
    pub(super) t: f64,
    pub(super) found: f64,
    pub(super) bound: f64,
}

impl Instant {
    fn holds(self) -> bool {
        self.found <= self.bound
    }

    /// How much of the bound is used up.
    fn part(self) -> f64 {
        match self.found / self.bound {
            part if part.is_nan() && self.found == 0.0 => 0.0,
            part if part.is_nan() => f64::INFINITY,
            part => part,
        }
    }
}
