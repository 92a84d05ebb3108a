//! What the two estimates have in common.

use super::precise::Precise;
use crate::system::System;

/// A one-step method of high order at fixed steps. It keeps scratch memory only.
///
/// Not to be confused with [`Integrator`](crate::integrators::Integrator), the methods under test:
/// these keep compensated sums and no work integrals.
pub trait Stepper: Send {
    /// Advances a state from time `t` by `h` seconds.
    fn step(&mut self, system: &dyn System, t: f64, h: f64, state: &mut Precise);

    /// Force evaluations a step costs.
    fn evaluations(&self) -> u64;
}

/// Resizes scratch memory on first use or when the system's size changed.
pub(super) fn fit(buffer: &mut Vec<f64>, n: usize) {
    if buffer.len() != n {
        *buffer = vec![0.0; n];
    }
}
