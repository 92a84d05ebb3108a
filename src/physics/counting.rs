//! Counts an integrator's force evaluations, independently of the integrator and the system, and spares those of points
//! that are known.

use super::constraints::contact::Obstacles;
use super::constraints::{Rods, StrainLimiter};
use super::{Dampers, ForceKinds, Injected, Jacobian, Linearization, Power, Sweep, System};
use std::cell::{Cell, RefCell};

/// Evaluations of the forces so far.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Evaluations {
    /// Full force evaluations.
    pub forces: u64,
    /// Products with the damping matrix, and sweeps: passes over the velocity-dependent effects alone.
    pub damping: u64,
}

/// A system that counts its evaluations, and otherwise does what the inner system does.
#[derive(Debug)]
pub struct Counting<S> {
    inner: S,
    counted: Cell<Evaluations>,
    known: RefCell<Known>,
}

/// A point, and the acceleration there.
#[derive(Debug, Default)]
struct Known {
    t: f64,
    x: Vec<f64>,
    v: Vec<f64>,
    a: Vec<f64>,
    power: Power,
}

impl<S: System> Counting<S> {
    pub fn new(inner: S) -> Self {
        Self {
            inner,
            counted: Cell::default(),
            known: RefCell::default(),
        }
    }

    /// The inner system. Direct calls to it are not counted; measures use this.
    pub fn inner(&self) -> &S {
        &self.inner
    }

    pub fn evaluations(&self) -> Evaluations {
        self.counted.get()
    }
}

impl<S: System> System for Counting<S> {
    fn inverse_mass(&self) -> &[f64] {
        self.inner.inverse_mass()
    }
    fn acceleration(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        let mut counted = self.counted.get();
        counted.forces += 1;
        self.counted.set(counted);
        self.inner.acceleration(t, x, v, a)
    }
    fn free_acceleration(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        let mut counted = self.counted.get();
        counted.forces += 1;
        self.counted.set(counted);
        self.inner.free_acceleration(t, x, v, a)
    }
    fn remembered_acceleration(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        let known = &mut *self.known.borrow_mut();
        if known.t == t && known.x == x && known.v == v {
            a.copy_from_slice(&known.a);
            return known.power;
        }
        known.power = self.free_acceleration(t, x, v, a);
        known.t = t;
        for (to, from) in [(&mut known.x, x), (&mut known.v, v), (&mut known.a, &*a)] {
            to.clear();
            to.extend_from_slice(from);
        }
        known.power
    }
    fn rods(&self) -> Option<&Rods> {
        self.inner.rods()
    }
    fn obstacles(&self) -> Option<&Obstacles> {
        self.inner.obstacles()
    }

    fn strain_limiter(&self) -> Option<&StrainLimiter> {
        self.inner.strain_limiter()
    }
    fn rounding(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) {
        self.inner.rounding(t, x, v, a);
    }
    fn kinds(&self) -> ForceKinds {
        self.inner.kinds()
    }
    fn damping(&self, t: f64, x: &[f64], w: &[f64], a: &mut [f64]) {
        let mut counted = self.counted.get();
        counted.damping += 1;
        self.counted.set(counted);
        self.inner.damping(t, x, w, a);
    }
    fn dampers(&self) -> Dampers {
        self.inner.dampers()
    }
    fn sweep(&self, sweep: &mut Sweep) {
        let mut counted = self.counted.get();
        counted.damping += 1;
        self.counted.set(counted);
        self.inner.sweep(sweep);
    }
    fn place(&self, t: f64, x: &mut [f64], v: &mut [f64]) {
        self.inner.place(t, x, v);
    }
    fn jumps(&self) -> &[f64] {
        self.inner.jumps()
    }
    fn injected(&self, t: f64, x: &[f64], moved: &[f64], h: f64) -> Injected {
        self.inner.injected(t, x, moved, h)
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
