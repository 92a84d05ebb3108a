//! What keeps a motion on a surface. Constraint forces are part of the acceleration ([`System::acceleration`]);
//! what they leave to drift is taken away after a step ([`stabilise`]). A strain limit acts after a step alone
//! ([`limit`]), obstacles within a step ([`contact`]).
//!
//! [`System::acceleration`]: crate::physics::System::acceleration

pub mod contact;
mod rods;
mod strain;

pub(crate) use rods::At;
pub use rods::{Residual, RodError, Rods};
pub use strain::{Corrections, StrainLimiter};

use super::{State, System};
use crate::scene::Stabilisation;

/// One constraint's facts.
#[derive(Debug)]
pub struct ConstraintRow {
    /// The id that the command line uses: the key of the scene.
    pub id: &'static str,
    pub summary: &'static str,
    /// The formula and its source.
    pub source: &'static str,
}

/// Every constraint.
pub static REGISTRY: &[ConstraintRow] = &[rods::ROW, strain::ROW, contact::ROW];

/// Moves a state onto the rods, if they are stabilised so, and books the energy that this puts in.
///
/// # Errors
/// [`RodError`] where rods depend on each other, or the state is too far off; the state is then of no use.
pub fn stabilise(system: &dyn System, rods: &Rods, state: &mut State) -> Result<(), RodError> {
    if rods.stabilisation() != Stabilisation::Project || !state.is_finite() {
        return Ok(());
    }
    let before = energy(system, state);
    let driven = rods.project(&mut state.x, &mut state.v)?;
    state.work.injected += driven;
    state.work.projected += energy(system, state) - before - driven;
    Ok(())
}

/// Shortens springs that are beyond their strain limit, and books the energy that this takes. Rods hold at the end, and
/// the limit as far as they let it.
///
/// # Errors
/// [`RodError`] where it cannot be moved onto them; the state is then of no use.
pub fn limit(
    system: &dyn System,
    limiter: &StrainLimiter,
    state: &mut State,
) -> Result<Corrections, RodError> {
    if !limiter.is_exceeded(&state.x) {
        return Ok(Corrections::default());
    }
    let before = energy(system, state);
    let done = limiter.correct(system.rods(), &mut state.x, &mut state.v)?;
    state.work.limited += before - energy(system, state);
    Ok(done)
}

/// The kinetic energy, J, of what rods allow of the velocities `v`, m/s, at positions `x`, m: all of it without rods.
///
/// A velocity along rods is an error of a method, of first order in SHAKE, whose motion has the energy of RATTLE's
/// (Hairer, Lubich, Wanner, Geometric Numerical Integration, VII.1.4: both are the same up to the last impulses).
pub fn kinetic_on_rods(system: &dyn System, x: &[f64], v: &[f64]) -> f64 {
    let along = system.rods().map_or(0.0, |rods| rods.energy_along(x, v));
    system.kinetic(v) - along
}

/// Kinetic and potential energy, J.
fn energy(system: &dyn System, state: &State) -> f64 {
    system.kinetic(&state.v) + system.potential(state.t, &state.x)
}
