//! The parts both estimates share: states that keep what rounding took from them, steps that advance
//! them, and whole integrations.

use super::mesh::Mesh;
use crate::integrators::{Integrator, StepError, events};
use crate::physics::{State, System};
use crate::truth::States;

/// Positions and velocities whose updates are summed with compensation (Kahan 1965, in Knuth's
/// branch-free form): each coordinate is the unevaluated sum of a double and a small remainder.
///
/// Not double-double arithmetic: forces see doubles.
#[derive(Debug, Clone)]
pub struct Precise {
    /// Positions, m.
    pub x: Vec<f64>,
    /// Velocities, m/s.
    pub v: Vec<f64>,
    /// The part of the positions below their last bit, m.
    pub x_low: Vec<f64>,
    /// The same of the velocities, m/s.
    pub v_low: Vec<f64>,
}

impl Precise {
    pub fn new(x: &[f64], v: &[f64]) -> Self {
        Self {
            x: x.to_vec(),
            v: v.to_vec(),
            x_low: vec![0.0; x.len()],
            v_low: vec![0.0; v.len()],
        }
    }

    /// Adds to one coordinate's position and velocity.
    #[inline(always)]
    pub fn add(&mut self, at: usize, dx: f64, dv: f64) {
        (self.x[at], self.x_low[at]) = two_sum(self.x[at], self.x_low[at] + dx);
        (self.v[at], self.v_low[at]) = two_sum(self.v[at], self.v_low[at] + dv);
    }

    pub fn is_finite(&self) -> bool {
        self.x.iter().chain(&self.v).all(|c| c.is_finite())
    }
}

impl From<&State> for Precise {
    fn from(state: &State) -> Self {
        Self::new(&state.x, &state.v)
    }
}

/// a + b as the nearest double and the exact rest (Knuth, TAOCP 2, 4.2.2).
#[inline(always)]
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_seen = sum - a;
    let rest = (a - (sum - b_seen)) + (b - b_seen);
    (sum, rest)
}

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

/// Integrates from the start with `each` steps through every piece of the mesh and keeps the states where
/// its intervals meet. `after` is told which piece each step went through, and its length, s. From the
/// first state that is not finite on, all are NaN.
pub(super) fn integrate<S: Stepper>(
    mut stepper: S,
    system: &dyn System,
    start: &Precise,
    mesh: &Mesh,
    each: u32,
    mut after: impl FnMut(usize, f64, &S),
) -> States {
    let mut state = start.clone();
    let dim = state.x.len();
    let instants = mesh.intervals() + 1;
    let mut samples = States::with_room(dim, instants);
    samples.push(&state.x, &state.v);
    let interval = mesh.interval();
    for k in 0..mesh.intervals() {
        let first = mesh.range(k).start;
        for (step, part) in mesh.steps(k, each).enumerate() {
            let (t, h) = (
                mesh.time(k) + part.offset * interval,
                part.length * interval,
            );
            through(&mut stepper, system, t, h, &mut state);
            after(first + step / each as usize, h, &stepper);
        }
        if !state.is_finite() {
            samples.x.resize(instants * dim, f64::NAN);
            samples.v.resize(instants * dim, f64::NAN);
            break;
        }
        let end = mesh.time(k + 1);
        system.place(end, &mut state.x, &mut state.v);
        samples.push(&state.x, &state.v);
    }
    samples
}

/// A stepper as an integrator that can be cut at events. It forgets what is below the last bit.
struct Cut<'s, S>(&'s mut S);

impl<S: Stepper> Integrator for Cut<'_, S> {
    fn step(&mut self, system: &dyn System, h: f64, state: &mut State) -> Result<(), StepError> {
        let mut at = Precise::from(&*state);
        self.0.step(system, state.t, h, &mut at);
        (state.x, state.v) = (at.x, at.v);
        state.t += h;
        Ok(())
    }
}

/// One step, through the events within it; where those cannot be told apart, the state is NaN from here on.
fn step<S: Stepper>(stepper: &mut S, system: &dyn System, t: f64, h: f64, state: &mut Precise) {
    if system.obstacles().is_none() {
        return stepper.step(system, t, h, state);
    }
    let mut at = State::new(state.x.clone(), state.v.clone());
    at.t = t;
    if events::through(&mut Cut(stepper), system, h, &mut at).is_err() {
        at.x.fill(f64::NAN);
    }
    *state = Precise::from(&at);
}

/// A step of `h` seconds from `t`, cut where a derivative of a given motion jumps.
pub(super) fn through<S: Stepper>(
    stepper: &mut S,
    system: &dyn System,
    t: f64,
    h: f64,
    state: &mut Precise,
) {
    let (mut from, mut left) = (t, h);
    let jumps = system.jumps();
    let ahead = jumps[jumps.partition_point(|jump| *jump <= t)..].iter();
    for &jump in ahead.take_while(|jump| **jump < t + h) {
        step(stepper, system, from, jump - from, state);
        keep(system, jump, state);
        (from, left) = (jump, t + h - jump);
    }
    step(stepper, system, from, left, state);
    keep(system, t + h, state);
}

/// Moves a state at time `t` onto the rods, if there are any; where that cannot be done it is NaN from here on.
fn keep(system: &dyn System, t: f64, state: &mut Precise) {
    let Some(rods) = system.rods() else {
        return;
    };
    let (mut x, mut v) = (state.x.clone(), state.v.clone());
    system.place(t, &mut x, &mut v);
    if rods.project(&mut x, &mut v).is_err() {
        state.x.fill(f64::NAN);
        return;
    }
    for (at, inverse_mass) in system.inverse_mass().iter().enumerate() {
        if *inverse_mass > 0.0 {
            state.add(at, x[at] - state.x[at], v[at] - state.v[at]);
        }
    }
}
