//! Tests any [`Integrator`] against the facts it claims.
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
//! // A false claim of third order is caught.
//! let boast = Claims { order: 3, ..Claims::from(verlet) };
//! let caught = check(&build, &boast);
//! assert!(caught.iter().any(|f| f.law == "order" && f.status == CheckStatus::Fail));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Each law is a row of [`LAWS`] with a file of its own. It builds its own small systems ([`systems`]) and
//! compares the integrator's steps with the claims, or with the contract of [`Integrator`]. A claim of
//! `false` is verified like any other: a symplectic method that claims not to be symplectic fails, since
//! the claim is untrue.
//!
//! The tolerances suit any integrator: an implicit step need be solved to [`SOLVED_TO`] only.
//! `docs/conformance.md` lists them law by law, with their reasons.

mod balance;
mod contact;
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

use crate::integrators::{Integrator, Method, OscillatorFacts, PerStep, is_exact};
use subject::Subject;

/// The relative residual to which an implicit step is expected to be solved. The tolerances of the laws
/// allow for it. [`Settings`](crate::integrators::Settings) has the same default.
pub const SOLVED_TO: f64 = 1e-12;

/// The facts an integrator claims. `None` claims nothing, and the laws on it are skipped; `false` is a
/// claim.
#[derive(Debug, Clone, Copy)]
pub struct Claims {
    /// Order of the global error on smooth problems without damping, also where forces depend on
    /// time.
    pub order: u32,
    /// Order with dampers or drag, of the motion and of the energy balance.
    pub order_damped: Option<u32>,
    /// Whether it preserves the symplectic form on undamped problems, and with it angular momentum.
    pub symplectic: bool,
    /// Whether stepping h, flipping velocities and stepping h again returns to the start.
    pub reversible: bool,
    /// Force evaluations a step costs on an undamped system, once running.
    pub evaluations: Option<PerStep>,
    /// On x'' = -w² x, with z = h w: the stability limit, and the law of the energy.
    pub oscillator: Option<OscillatorFacts>,
    /// Whether it follows free fall without any error but rounding.
    pub exact: bool,
}

impl Claims {
    /// Claims of this order and the exactness that follows from it, of no symplecticity or reversibility,
    /// and none on damping, cost and the oscillator: the base of `Claims { .., ..of_order(p) }`.
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
    /// All facts of the method.
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

/// A property that integrators are tested for.
pub struct Law {
    pub id: &'static str,
    /// What the law requires.
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
    /// Tests the integrators that `build` makes against the claims this law is about.
    ///
    /// An integrator that returns an error, produces numbers that are not finite or breaks the contract of
    /// [`Integrator::step`] fails, and the message says how.
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
    contact::LAW,
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

/// Tests an integrator against its claims: one finding for each law, in the order of [`LAWS`].
///
/// `build` makes a fresh integrator each time, since an integrator serves one system and a law has
/// several. This takes about a second, and gives the same bits every time if the integrator does.
pub fn check(build: &dyn Fn() -> Box<dyn Integrator>, claims: &Claims) -> Vec<Finding> {
    LAWS.iter().map(|law| law.check(build, claims)).collect()
}
