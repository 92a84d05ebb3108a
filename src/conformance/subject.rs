//! The integrator under test, and the function by which laws step it.

use super::Claims;
use crate::integrators::{Integrator, StepError};
use crate::physics::{State, System};

/// Makes a fresh integrator each time.
pub type Build<'a> = &'a dyn Fn() -> Box<dyn Integrator>;

/// The integrator that a law tests, with its claims.
pub(super) struct Subject<'a> {
    pub build: Build<'a>,
    pub claims: &'a Claims,
}

impl Subject<'_> {
    pub fn fresh(&self) -> Box<dyn Integrator> {
        (self.build)()
    }

    /// Takes `n` steps of `h` with a fresh integrator.
    pub fn advance(
        &self,
        system: &dyn System,
        h: f64,
        n: usize,
        state: &mut State,
    ) -> Result<(), Broken> {
        advance(self.fresh().as_mut(), system, h, n, state)
    }
}

/// The reason why an integrator could not be stepped any further.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Broken {
    #[error("a step of h = {h} could not be taken: {error}")]
    Step { h: f64, error: StepError },
    #[error("left the range of finite numbers at h = {h}")]
    NotFinite { h: f64 },
    #[error("a step of h = {h} from t = {from} left the state's time at {left}")]
    Clock { h: f64, from: f64, left: f64 },
    #[error("a step changed the number of coordinates")]
    Shape,
}

/// Takes `n` steps of `h`, and checks that each fulfils the contract of [`Integrator::step`].
pub(super) fn advance(
    integrator: &mut dyn Integrator,
    system: &dyn System,
    h: f64,
    n: usize,
    state: &mut State,
) -> Result<(), Broken> {
    for _ in 0..n {
        let from = state.t;
        integrator
            .step(system, h, state)
            .map_err(|error| Broken::Step { h, error })?;
        if state.x.len() != system.dim() || state.v.len() != system.dim() {
            return Err(Broken::Shape);
        }
        if !state.is_finite() {
            return Err(Broken::NotFinite { h });
        }
        // The time may be summed in any way, so a few roundings are allowed.
        let left = state.t;
        let off = (left - (from + h)).abs();
        if off.is_nan() || off > 8.0 * f64::EPSILON * (from.abs() + h) {
            return Err(Broken::Clock { h, from, left });
        }
    }
    Ok(())
}

/// The largest magnitude in a state.
pub(super) fn largest(state: &State) -> f64 {
    let values = state.x.iter().chain(&state.v);
    values.fold(0.0, |most: f64, value| most.max(value.abs()))
}

/// The largest difference between the positions or velocities of two states.
pub(super) fn distance(a: &State, b: &State) -> f64 {
    let pairs = a.x.iter().zip(&b.x).chain(a.v.iter().zip(&b.v));
    pairs.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()))
}
