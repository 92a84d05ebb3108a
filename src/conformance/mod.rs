//! Holds any [`Integrator`] to the facts it claims.
//!
//! ```
//! use springcheck::conformance::{Claims, check};
//! use springcheck::integrators;
//! use springcheck::outcome::CheckStatus;
//!
//! let verlet = integrators::find("velocity_verlet").ok_or("no such method")?;
//! let build = || verlet.build(&Default::default());
//! let findings = check(&build, &Claims::from(verlet));
//! assert!(findings.iter().all(|finding| finding.status == CheckStatus::Pass));
//!
//! // Claimed to be of third order, it is caught.
//! let boast = Claims { order: 3, ..Claims::from(verlet) };
//! let caught = check(&build, &boast);
//! assert!(caught.iter().any(|f| f.law == "order" && f.status == CheckStatus::Fail));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A law is a row of [`LAWS`], a file a row. Each builds its own small systems ([`systems`]) and
//! compares what the integrator does with what was claimed, or with what [`Integrator`] asks of
//! everybody. A claim of `false` is verified like any other: "not symplectic" of a method that is
//! fails too, since whoever reads the claim would be told something untrue.
//!
//! The tolerances are for integrators of any make: an implicit step may be solved to [`SOLVED_TO`]
//! only. `docs/conformance.md` has them law by law, with their reasons.

mod across;
mod balance;
mod claims;
mod cost;
mod energy;
mod exactness;
mod finding;
mod momentum;
mod order;
mod reference;
mod reuse;
mod reversal;
mod stability;
mod subject;
mod symplecticity;
pub mod systems;

pub use claims::Claims;
pub use finding::Finding;
pub use stability::measured_limit;
pub use subject::{Broken, Build};

use crate::integrators::Integrator;
use finding::Verdict;
use subject::Subject;

/// Relative residual to which the kit expects an implicit step to be solved, and so the size of what
/// its tolerances leave for solving. [`Settings`](crate::integrators::Settings) has the same default.
pub const SOLVED_TO: f64 = 1e-12;

/// One thing an integrator is held to.
pub struct Law {
    pub id: &'static str,
    /// What it asks.
    pub summary: &'static str,
    /// Where its bound comes from.
    pub derivation: &'static str,
    judge: fn(&Subject) -> Result<Verdict, Broken>,
}

impl std::fmt::Debug for Law {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Law").field("id", &self.id).finish()
    }
}

impl Law {
    /// Holds what `build` makes to the part of the claims this law is about.
    ///
    /// An integrator that returns an error, leaves the finite numbers or breaks the contract of
    /// [`Integrator::step`] on the way fails, and the message says how.
    pub fn check(&self, build: Build, claims: &Claims) -> Finding {
        let verdict = (self.judge)(&Subject { build, claims });
        Finding::new(
            self,
            verdict.unwrap_or_else(|broken| Verdict::fail(None, None, broken)),
        )
    }
}

/// Every law, in the order findings are listed.
pub static LAWS: &[Law] = &[
    order::UNDAMPED,
    order::DAMPED,
    order::DRIVEN,
    balance::LAW,
    energy::LAW,
    stability::LAW,
    across::LAW,
    symplecticity::LAW,
    reversal::LAW,
    momentum::LAW,
    exactness::LAW,
    cost::LAW,
    reuse::LAW,
];

/// The law of this id.
pub fn find(id: &str) -> Option<&'static Law> {
    LAWS.iter().find(|law| law.id == id)
}

/// Holds an integrator to its claims: one finding a law, in the order of [`LAWS`].
///
/// `build` makes a fresh integrator each time; an integrator serves one system, and every law has
/// several. It takes about a second and gives the same bits every time if the integrator does.
pub fn check(build: &dyn Fn() -> Box<dyn Integrator>, claims: &Claims) -> Vec<Finding> {
    LAWS.iter().map(|law| law.check(build, claims)).collect()
}
