//! Counts what an integrator asks of a system, from outside both.

use super::{ForceKinds, Jacobian, Linearization, Power, System};
use std::cell::Cell;

/// Passes over the forces so far.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Evaluations {
    /// Full force evaluations.
    pub forces: u64,
    /// Products with the damping matrix: passes over the velocity-dependent effects alone.
    pub damping: u64,
}

/// A system that counts; otherwise transparent.
#[derive(Debug)]
pub struct Counting<S> {
    inner: S,
    forces: Cell<u64>,
    damping: Cell<u64>,
}

impl<S: System> Counting<S> {
    pub fn new(inner: S) -> Self {
        Self {
            inner,
            forces: Cell::new(0),
            damping: Cell::new(0),
        }
    }

    /// The system itself; what is asked of it directly is not counted (measures use this).
    pub fn inner(&self) -> &S {
        &self.inner
    }

    pub fn evaluations(&self) -> Evaluations {
        Evaluations {
            forces: self.forces.get(),
            damping: self.damping.get(),
        }
    }
}

fn bump(counter: &Cell<u64>) {
    counter.set(counter.get() + 1);
}

impl<S: System> System for Counting<S> {
    fn inverse_mass(&self) -> &[f64] {
        self.inner.inverse_mass()
    }
    fn acceleration(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        bump(&self.forces);
        self.inner.acceleration(t, x, v, a)
    }
    fn kinds(&self) -> ForceKinds {
        self.inner.kinds()
    }
    fn damping(&self, t: f64, x: &[f64], w: &[f64], a: &mut [f64]) {
        bump(&self.damping);
        self.inner.damping(t, x, w, a);
    }
    fn injected_power(&self, t: f64, x: &[f64], v: &[f64]) -> f64 {
        self.inner.injected_power(t, x, v)
    }
    fn potential(&self, t: f64, x: &[f64]) -> f64 {
        self.inner.potential(t, x)
    }
    fn jacobian(
        &self,
        t: f64,
        x: &[f64],
        v: &[f64],
        linearization: Linearization,
        out: &mut Jacobian,
    ) {
        self.inner.jacobian(t, x, v, linearization, out);
    }
}
