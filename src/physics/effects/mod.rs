//! What acts on particles: one file an effect, one row in [`REGISTRY`].
//!
//! An effect is built only when the scene calls for it; an absent effect is not in the list and
//! costs nothing. Contact, rods and strain limits act between or inside steps and are not
//! forces: they will be a second kind of row, called by
//! [`IntegratorEngine`](crate::solvers::IntegratorEngine) after its integrator, not members of this
//! trait.

mod central;
mod drag;
mod gravity;
mod scaled;
mod springs;
mod wind;

pub use central::Central;
pub use drag::Drag;
pub use gravity::Gravity;
pub use scaled::Scaled;
pub use springs::Springs;
pub use wind::WindForce;

use crate::physics::{ForceKinds, Jacobian, Linearization, Power};
use crate::scene::Scene;

/// A force on particles: a batch over all its members, in flat vectors of length 3n.
///
/// `kinds`, `potential`, `add_damping` and `add_jacobian` must agree with `add_force`; one test checks
/// them by finite differences over the whole registry.
pub trait Effect: Send + Sync {
    /// Springs, particles or pairs it acts on.
    fn members(&self) -> usize;

    /// How its force depends on velocity, and whether it does work that no potential accounts for.
    fn kinds(&self) -> ForceKinds;

    /// *Adds* its force, N, to `f`; returns its powers at this point, W.
    fn add_force(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) -> Power;

    /// Potential energy, J; 0 for what has none.
    fn potential(&self, _t: f64, _x: &[f64]) -> f64 {
        0.0
    }

    /// *Adds* the velocity-dependent part of its force at velocity `w`, N, to `f`.
    fn add_damping(&self, _x: &[f64], _w: &[f64], _f: &mut [f64]) {}

    /// What a [driven](ForceKinds::DRIVEN) force does per second at velocity `v`, W.
    fn injected_power(&self, _t: f64, _v: &[f64]) -> f64 {
        0.0
    }

    /// *Adds* ∂f/∂x and ∂f/∂v; the same places in the same order at every call.
    fn add_jacobian(
        &self,
        _t: f64,
        _x: &[f64],
        _v: &[f64],
        _linearization: Linearization,
        _out: &mut Jacobian,
    ) {
    }

    /// Total momentum stays as it is under this effect (nothing fixed).
    fn keeps_momentum(&self) -> bool {
        false
    }

    /// Total angular momentum stays as it is under this effect (nothing fixed).
    fn keeps_angular_momentum(&self) -> bool {
        false
    }
}

/// One effect's facts.
pub struct EffectRow {
    /// The id scenes, reports and the command line use.
    pub id: &'static str,
    pub summary: &'static str,
    /// Formula and where it is stated.
    pub source: &'static str,
    /// Its potential counts as U_elastic in the energy scale.
    pub elastic: bool,
    /// Its force depends on neither position nor velocity.
    pub constant: bool,
    /// None when the scene does not ask for it.
    pub build: fn(&Scene) -> Option<Box<dyn Effect>>,
}

impl std::fmt::Debug for EffectRow {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("EffectRow").field("id", &self.id).finish()
    }
}

/// Every effect, in the order forces are summed.
pub static REGISTRY: &[EffectRow] = &[
    gravity::ROW,
    springs::ROW,
    central::CUBIC,
    drag::ROW,
    wind::ROW,
    central::GRAVITATIONAL,
];

fn boxed<E: Effect + 'static>(effect: E) -> Box<dyn Effect> {
    Box::new(effect)
}
