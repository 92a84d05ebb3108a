//! The state an integrator advances.

use std::ops::AddAssign;

/// Time, positions, velocities, and the work done so far.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Seconds.
    pub t: f64,
    /// Positions, m.
    pub x: Vec<f64>,
    /// Velocities, m/s.
    pub v: Vec<f64>,
    /// Work integrals, advanced beside the motion by the method's own stages.
    pub work: Work,
}

impl State {
    /// The state at t = 0, with no work done. `x` and `v` have the same length.
    pub fn new(x: Vec<f64>, v: Vec<f64>) -> Self {
        debug_assert_eq!(x.len(), v.len());
        Self {
            t: 0.0,
            x,
            v,
            work: Work::default(),
        }
    }

    /// The middle of the cubic through this state and another `h` seconds later, with the work done there.
    pub fn middle(&self, end: &Self, h: f64) -> Self {
        let mut middle = end.clone();
        middle.t = self.t + 0.5 * h;
        for at in 0..end.x.len() {
            let ([x0, x1], [v0, v1]) = ([self.x[at], end.x[at]], [self.v[at], end.v[at]]);
            middle.x[at] = 0.5 * (x0 + x1) + 0.125 * h * (v0 - v1);
            middle.v[at] = 1.5 * (x1 - x0) / h - 0.25 * (v0 + v1);
        }
        middle
    }

    /// Whether it has no NaN and no infinity.
    pub fn is_finite(&self) -> bool {
        self.x.iter().chain(&self.v).all(|c| c.is_finite())
            && self.work.dissipated.is_finite()
            && self.work.injected.is_finite()
            && self.work.projected.is_finite()
            && self.work.limited.is_finite()
            && self.work.impacts.is_finite()
            && self.work.friction.is_finite()
    }
}

/// Energy that has left or entered the system since the start, joules.
///
/// A correct run conserves the [balance](Work::balance).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Work {
    /// Energy taken out by dampers and drag; grows.
    pub dissipated: f64,
    /// Energy put in by external forces without a potential; of either sign.
    pub injected: f64,
    /// Energy put in by moving states onto rods; of either sign. It is an error of the method's, so the balance does not
    /// leave it out.
    pub projected: f64,
    /// Energy taken out by the strain limit; negative where it put some in. It is the model's, so the balance leaves it out.
    pub limited: f64,
    /// Energy lost in impacts on obstacles; grows.
    pub impacts: f64,
    /// Energy lost in sliding along obstacles; grows.
    pub friction: f64,
}

impl Work {
    /// The balance B = E + dissipated - injected + limited + impacts + friction of a state of energy E, J.
    pub fn balance(&self, energy: f64) -> f64 {
        energy + self.dissipated - self.injected + self.limited + self.impacts + self.friction
    }

    /// Adds `h` seconds at constant power.
    pub fn advance(&mut self, power: Power, h: f64) {
        self.dissipated += h * power.dissipated;
        self.injected += h * power.injected;
    }
}

/// Rate of change of [`Work`], watts.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Power {
    pub dissipated: f64,
    pub injected: f64,
}

/// Energy that driven forces put in over a part of a step, J.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Injected {
    /// By external forces, and by given motions against forces that do not depend on velocity.
    pub forces: f64,
    /// By given motions against dampers.
    pub dampers: f64,
}

impl AddAssign for Power {
    fn add_assign(&mut self, other: Self) {
        self.dissipated += other.dissipated;
        self.injected += other.injected;
    }
}
