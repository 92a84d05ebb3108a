//! The forces on particles. Each effect has a file and a row in [`REGISTRY`].
//!
//! An effect is built only when the scene calls for it; an absent effect is not in the list and costs
//! nothing. Rods, strain limits and contact by impulses act between or inside steps and are not forces.

mod air_drag;
mod bending;
mod central;
mod drag;
mod driven;
mod gravity;
mod magnetic;
mod penalty;
mod quadratic_drag;
mod scaled;
mod springs;
mod wind;

pub use air_drag::AirDrag;
pub use bending::BendingForce;
pub use central::Central;
pub use drag::Drag;
pub use driven::Driven;
pub use gravity::Gravity;
pub use magnetic::MagneticForce;
pub use penalty::{Penalty, PenaltyLaw, Press};
pub use quadratic_drag::QuadraticDrag;
pub use scaled::Scaled;
pub use springs::Springs;
pub use wind::WindForce;

use crate::physics::{ForceKinds, Jacobian, Linearization, Power, Sweep};
use crate::scene::{Drive, Scene};
use crate::space::dot;

/// A force on particles. It is computed for all its members at once, in flat vectors of length 3n.
///
/// `kinds`, `potential`, `add_damping` and `add_jacobian` must agree with `add_force`; one test checks
/// them by finite differences over the whole registry.
pub trait Effect: Send + Sync {
    /// The number of springs, particles or pairs it acts on.
    fn members(&self) -> usize;

    /// The kinds of its force: how it depends on velocity, and whether it does work without a potential.
    fn kinds(&self) -> ForceKinds;

    /// *Adds* its force, N, to `f`; returns its powers at this point, W.
    fn add_force(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) -> Power;

    /// *Adds* a bound of how far rounding moves the force, N, to `f`: what two programs that compute the same
    /// formula from the same state, in any order of operations, may differ by. The coordinates are taken to be
    /// off by a rounding each, as those of a stage within a step are.
    ///
    /// The default is that of a force of a few operations without cancellation.
    fn add_rounding(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        let mut own = vec![0.0; f.len()];
        self.add_force(t, x, v, &mut own);
        for (f, own) in f.iter_mut().zip(own) {
            *f += FEW_OPERATIONS * own.abs();
        }
    }

    /// Potential energy, J; 0 for a force without a potential.
    fn potential(&self, _t: f64, _x: &[f64]) -> f64 {
        0.0
    }

    /// *Adds* the velocity-dependent part of its force at velocity `w`, N, to `f`. Nobody asks it of a force that is
    /// [not linear in v](ForceKinds::NON_LINEAR).
    fn add_damping(&self, _x: &[f64], _w: &[f64], _f: &mut [f64]) {}

    /// *Adds* the number of its dampers at each particle; false where [`sweep`](Self::sweep) does not apply them.
    fn count_dampers(&self, _at: &mut [u32]) -> bool {
        false
    }

    /// Applies its dampers one after the other, or in the reverse order. An effect that has some and does not
    /// count them is damped as a whole, by [`add_damping`](Self::add_damping).
    fn sweep(&self, _sweep: &mut Sweep) {}

    /// The power at velocity `v` of a [driven](ForceKinds::DRIVEN) force on what is at rest, W. Nobody asks it of a force
    /// that is not linear in v.
    fn injected_power(&self, _t: f64, _v: &[f64]) -> f64 {
        0.0
    }

    /// The motions it gives to fixed particles.
    fn drives(&self) -> &[Drive] {
        &[]
    }

    /// *Adds* ∂f/∂x and ∂f/∂v, with the same places in the same order at every call, but for contacts that begin and end.
    fn add_jacobian(
        &self,
        _t: f64,
        _x: &[f64],
        _v: &[f64],
        _linearization: Linearization,
        _out: &mut Jacobian,
    ) {
    }

    /// Whether this effect conserves total momentum (with nothing fixed).
    fn keeps_momentum(&self) -> bool {
        false
    }

    /// Whether this effect conserves total angular momentum (with nothing fixed).
    fn keeps_angular_momentum(&self) -> bool {
        false
    }
}

/// The relative rounding of a product or a sum of a few factors, by any order of operations.
const FEW_OPERATIONS: f64 = 4.0 * f64::EPSILON;

/// One effect's facts.
pub struct EffectRow {
    /// The id scenes, reports and the command line use.
    pub id: &'static str,
    pub summary: &'static str,
    /// The formula and its source.
    pub source: &'static str,
    /// Whether its potential counts as U_elastic in the energy scale.
    pub elastic: bool,
    /// Whether its force depends on neither position nor velocity.
    pub constant: bool,
    /// Builds the effect; None when the scene does not call for it.
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
    quadratic_drag::ROW,
    air_drag::ROW,
    wind::ROW,
    central::GRAVITATIONAL,
    driven::ROW,
    magnetic::ROW,
    bending::ROW,
    penalty::ROW,
];

/// The vector from the particle at offset `i` to the one at offset `j`.
#[inline(always)]
fn difference(x: &[f64], i: usize, j: usize) -> [f64; 3] {
    let (from, to) = (&x[i..i + 3], &x[j..j + 3]);
    [to[0] - from[0], to[1] - from[1], to[2] - from[2]]
}

/// The velocity of particle `i`.
fn velocity(v: &[f64], i: usize) -> [f64; 3] {
    [v[3 * i], v[3 * i + 1], v[3 * i + 2]]
}

/// Counts one damper at each member, as [`Effect::count_dampers`] does.
fn count_members<T>(members: &[(usize, T)], at: &mut [u32]) -> bool {
    members.iter().for_each(|(i, _)| at[*i] += 1);
    true
}

fn boxed<E: Effect + 'static>(effect: E) -> Box<dyn Effect> {
    Box::new(effect)
}
