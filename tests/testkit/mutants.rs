//! Integrators with the faults people write. Each law test must fail on the ones it names.

pub mod numerics;
pub mod physics;

use springcheck::integrators::{Integrator, StepError};
use springcheck::physics::{State, System};

/// One step, written out.
pub type Step = fn(&dyn System, f64, &mut State);

/// Builds the integrator that takes this step.
pub fn mutant(step: Step) -> impl Fn() -> Box<dyn Integrator> {
    move || Box::new(Wrong(step))
}

struct Wrong(Step);

impl Integrator for Wrong {
    fn step(&mut self, system: &dyn System, h: f64, state: &mut State) -> Result<(), StepError> {
        (self.0)(system, h, state);
        state.t += h;
        Ok(())
    }
}

fn acceleration(system: &dyn System, x: &[f64], v: &[f64]) -> Vec<f64> {
    let mut a = vec![0.0; x.len()];
    system.acceleration(0.0, x, v, &mut a);
    a
}

fn add(y: &mut [f64], h: f64, x: &[f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += h * x;
    }
}

/// Explicit Euler whose drift already uses the new velocity: symplectic Euler.
pub fn euler_drifting_with_the_new_velocity(system: &dyn System, h: f64, s: &mut State) {
    let a = acceleration(system, &s.x, &s.v);
    add(&mut s.v, h, &a);
    let v = s.v.clone();
    add(&mut s.x, h, &v);
}

/// Symplectic Euler whose drift uses the old velocity: explicit Euler.
pub fn euler_drifting_with_the_old_velocity(system: &dyn System, h: f64, s: &mut State) {
    let a = acceleration(system, &s.x, &s.v);
    let v = s.v.clone();
    add(&mut s.v, h, &a);
    add(&mut s.x, h, &v);
}

/// Midpoint that drifts with the end velocity: first order.
pub fn midpoint_drifting_with_the_end_velocity(system: &dyn System, h: f64, s: &mut State) {
    let a = acceleration(system, &s.x, &s.v);
    let (mut x, mut v) = (s.x.clone(), s.v.clone());
    add(&mut x, 0.5 * h, &s.v);
    add(&mut v, 0.5 * h, &a);
    let a = acceleration(system, &x, &v);
    add(&mut s.v, h, &a);
    let v = s.v.clone();
    add(&mut s.x, h, &v);
}

/// Verlet whose second half kick reuses the force from before the drift.
pub fn verlet_with_a_stale_force(system: &dyn System, h: f64, s: &mut State) {
    let a = acceleration(system, &s.x, &s.v);
    add(&mut s.v, 0.5 * h, &a);
    let v = s.v.clone();
    add(&mut s.x, h, &v);
    add(&mut s.v, 0.5 * h, &a);
}

/// Verlet that kicks with the damper taken explicitly: first order in the damping.
pub fn verlet_with_explicit_damping(system: &dyn System, h: f64, s: &mut State) {
    let a = acceleration(system, &s.x, &s.v);
    add(&mut s.v, 0.5 * h, &a);
    let v = s.v.clone();
    add(&mut s.x, h, &v);
    let a = acceleration(system, &s.x, &s.v);
    add(&mut s.v, 0.5 * h, &a);
}

/// RK4 whose last weight is 1/3: consistent to no order.
pub fn rk4_with_a_wrong_weight(system: &dyn System, h: f64, s: &mut State) {
    rk4(system, h, s, [1.0, 2.0, 2.0, 2.0]);
}

/// RK4 whose second and third weights are swapped with the outer ones.
pub fn rk4_with_swapped_weights(system: &dyn System, h: f64, s: &mut State) {
    rk4(system, h, s, [2.0, 1.0, 1.0, 2.0]);
}

fn rk4(system: &dyn System, h: f64, s: &mut State, weights: [f64; 4]) {
    let (x0, v0) = (s.x.clone(), s.v.clone());
    let (mut x, mut v) = (x0.clone(), v0.clone());
    for (weight, next) in weights.into_iter().zip([0.5, 0.5, 1.0, 0.0]) {
        let a = acceleration(system, &x, &v);
        add(&mut s.x, h * weight / 6.0, &v);
        add(&mut s.v, h * weight / 6.0, &a);
        let stage_v = v.clone();
        x.clone_from(&x0);
        v.clone_from(&v0);
        add(&mut x, h * next, &stage_v);
        add(&mut v, h * next, &a);
    }
}

/// Drift-kick-drift composition with coefficients in the wrong order: W0 first.
pub fn yoshida_with_swapped_coefficients(system: &dyn System, h: f64, s: &mut State) {
    const W1: f64 = 1.351_207_191_959_657_8;
    const W0: f64 = -1.702_414_383_919_315_3;
    for w in [W0, W1, W1] {
        let v = s.v.clone();
        add(&mut s.x, 0.5 * w * h, &v);
        let a = acceleration(system, &s.x, &s.v);
        add(&mut s.v, w * h, &a);
        let v = s.v.clone();
        add(&mut s.x, 0.5 * w * h, &v);
    }
}

/// Two half steps of symplectic Euler: h halved.
pub fn symplectic_euler_at_half_the_step(system: &dyn System, h: f64, s: &mut State) {
    euler_drifting_with_the_new_velocity(system, 0.5 * h, s);
    euler_drifting_with_the_new_velocity(system, 0.5 * h, s);
}

/// Explicit Euler that leaves the last coordinate's force out: no reaction to someone's action.
pub fn euler_forgetting_a_reaction(system: &dyn System, h: f64, s: &mut State) {
    let mut a = acceleration(system, &s.x, &s.v);
    *a.last_mut().expect("a coordinate") = 0.0;
    let v = s.v.clone();
    add(&mut s.v, h, &a);
    add(&mut s.x, h, &v);
}

/// Verlet that asks for forces at rest only.
pub fn verlet_without_damping(system: &dyn System, h: f64, s: &mut State) {
    let rest = vec![0.0; s.v.len()];
    let a = acceleration(system, &s.x, &rest);
    add(&mut s.v, 0.5 * h, &a);
    let v = s.v.clone();
    add(&mut s.x, h, &v);
    let a = acceleration(system, &s.x, &rest);
    add(&mut s.v, 0.5 * h, &a);
}

/// Nothing moves.
pub fn frozen(_: &dyn System, _: f64, _: &mut State) {}
