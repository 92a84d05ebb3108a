//! Holds any [`Integrator`] to the facts it claims.
//!
//! ```
//! use springcheck::conformance::{Claims, check};
//! use springcheck::integrators;
//! use springcheck::measure::CheckStatus;
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

mod balance;
mod cost;
mod energy;
mod exactness;
mod finding;
mod momentum;
mod order;
mod reuse;
mod reversal;
mod stability;
mod subject;
mod symplecticity;
pub mod systems;

pub use finding::Finding;
pub use stability::measured_limit;
pub use subject::{Broken, Build};

use crate::integrators::{Integrator, Method, Oscillator, PerStep, is_exact};
use subject::Subject;

/// Relative residual to which the kit expects an implicit step to be solved, and so the size of what
/// its tolerances leave for solving. [`Settings`](crate::integrators::Settings) has the same default.
pub const SOLVED_TO: f64 = 1e-12;

/// The facts an integrator claims. What is `None` is not claimed, and the laws on it are skipped;
/// `false` is a claim.
#[derive(Debug, Clone, Copy)]
pub struct Claims {
    /// Order of the global error on smooth problems without damping, also where forces depend on
    /// time.
    pub order: u32,
    /// Order with dampers or drag, of the motion and of the balance of energy.
    pub order_damped: Option<u32>,
    /// Keeps the symplectic form on undamped problems, and with it angular momentum.
    pub symplectic: bool,
    /// Stepping h, flipping velocities, stepping h again returns to the start.
    pub reversible: bool,
    /// Force evaluations a step costs on an undamped system, once running.
    pub evaluations: Option<PerStep>,
    /// On x'' = -w² x, with z = h w: how far it is stable, and what becomes of the energy.
    pub oscillator: Option<Oscillator>,
    /// Follows free fall without any error but rounding.
    pub exact: bool,
}

impl Claims {
    /// Of this order, with the exactness that comes with it, neither symplectic nor reversible, and
    /// nothing said of damping, cost and the oscillator: the start of `Claims { .., ..of_order(p) }`.
    pub const fn of_order(order: u32) -> Self {
        Self {
            order,
            order_damped: None,
            symplectic: false,
            reversible: false,
            evaluations: None,
            oscillator: None,
            exact: is_exact(order),
        }
    }
}

impl From<&Method> for Claims {
    /// Everything a row states.
    fn from(method: &Method) -> Self {
        Self {
            order: method.order,
            order_damped: Some(method.order_damped),
            symplectic: method.symplectic,
            reversible: method.reversible,
            evaluations: Some(method.evaluations),
            oscillator: Some(method.oscillator),
            exact: method.exact,
        }
    }
}

/// One thing an integrator is held to.
pub struct Law {
    pub id: &'static str,
    /// What it asks.
    pub summary: &'static str,
    /// Where its bound comes from.
    pub derivation: &'static str,
    judge: fn(&Subject) -> Result<Finding, Broken>,
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
        let found = (self.judge)(&Subject { build, claims });
        let found = found.unwrap_or_else(|broken| Finding::of(false, None, None, broken));
        Finding {
            law: self.id,
            derivation: self.derivation,
            measured: found.measured.filter(|number| number.is_finite()),
            bound: found.bound.filter(|number| number.is_finite()),
            ..found
        }
    }
}

/// Every law, in the order findings are listed.
pub static LAWS: &[Law] = &[
    order::UNDAMPED,
    order::DAMPED,
    order::DRIVEN,
    balance::LAW,
    energy::LAW,
    stability::ALONG,
    stability::ACROSS,
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
