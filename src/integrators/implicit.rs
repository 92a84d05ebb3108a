//! Implicit methods: one stage equation, solved by one Newton iteration.
//!
//! Every method here finds u with M (u - b) = γ f(t + τ, y + γ u, u); they differ in b, y, γ and
//! in what they make of u.

use super::newton::Newton;
use super::{
    Amplification, EnergyLaw, Exact, Integrator, Method, Oscillator, PerStep, Settings, Stable,
    StepError, axpy, fit,
};
use crate::system::{Linearization, State, System};

/// Which member of the family a stepper is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scheme {
    /// Backward Euler, solved to the end.
    Euler,
    /// One Newton step of backward Euler from (x, v), with that much of the Jacobian.
    LinearizedEuler(Linearization),
    Midpoint,
    Trapezoidal,
}

const fn implicit(id: &'static str, name: &'static str, order: u32, energy: EnergyLaw) -> Method {
    Method {
        id,
        name,
        order,
        order_damped: order,
        symplectic: false,
        reversible: order > 1,
        evaluations: PerStep::PerIteration { plus: 1 },
        oscillator: Oscillator {
            stable: Stable::Always,
            energy,
        },
        amplification: Amplification::BACKWARD_EULER,
        exact: Exact::of_order(order),
        source: "",
        not: "",
        build: |settings: &Settings| Box::new(Implicit::new(Scheme::Euler, settings)),
    }
}

const DISSIPATES: EnergyLaw = EnergyLaw::Factor {
    factor: |z| 1.0 / (1.0 + z * z),
    formula: "1/(1 + z²)",
};
const KEEPS: EnergyLaw = EnergyLaw::Factor {
    factor: |_| 1.0,
    formula: "1",
};

pub(super) const IMPLICIT_EULER: Method = Method {
    source: "Hairer, Wanner, Solving ODEs II, IV.3",
    not: "linearized_implicit, which stops after one Newton step",
    ..implicit("implicit_euler", "implicit Euler", 1, DISSIPATES)
};

pub(super) const LINEARIZED_IMPLICIT: Method = Method {
    source: "Baraff & Witkin 1998, Large Steps in Cloth Simulation, with the exact Jacobian",
    not: "implicit_euler: non-linear forces are met only to first order",
    evaluations: PerStep::Exactly(1),
    build: |settings| {
        Box::new(Implicit::new(
            Scheme::LinearizedEuler(Linearization::Exact),
            settings,
        ))
    },
    ..implicit(
        "linearized_implicit",
        "linearly implicit Euler",
        1,
        DISSIPATES,
    )
};

pub(super) const LINEARIZED_IMPLICIT_MATERIAL: Method = Method {
    source: "Baraff & Witkin 1998 with K = k n nᵀ; what rapier's spring joint converges to",
    not: "linearized_implicit: the stiffness of a spring's turning is left out, so transverse \
          motion is only as stable as symplectic Euler's",
    evaluations: PerStep::Exactly(1),
    oscillator: Oscillator {
        stable: Stable::AlwaysAlong { across: 2.0 },
        energy: DISSIPATES,
    },
    amplification: Amplification::MaterialImplicit,
    build: |settings| {
        Box::new(Implicit::new(
            Scheme::LinearizedEuler(Linearization::Material),
            settings,
        ))
    },
    ..implicit(
        "linearized_implicit_material",
        "linearly implicit Euler, K = k n nᵀ",
        1,
        DISSIPATES,
    )
};

pub(super) const IMPLICIT_MIDPOINT: Method = Method {
    symplectic: true,
    source: "Hairer, Lubich, Wanner, Geometric Numerical Integration, II.1 (Gauss, s = 1)",
    not: "midpoint, its explicit namesake, or trapezoidal, its conjugate",
    amplification: Amplification::CAYLEY,
    build: |settings| Box::new(Implicit::new(Scheme::Midpoint, settings)),
    ..implicit("implicit_midpoint", "implicit midpoint", 2, KEEPS)
};

pub(super) const TRAPEZOIDAL: Method = Method {
    evaluations: PerStep::PerIteration { plus: 2 },
    source: "Crank & Nicolson 1947; Newmark 1959 with β = 1/4, γ = 1/2",
    not: "heun, its explicit namesake; conjugate to a symplectic method, not one itself",
    amplification: Amplification::CAYLEY,
    build: |settings| Box::new(Implicit::new(Scheme::Trapezoidal, settings)),
    ..implicit("trapezoidal", "trapezoidal rule", 2, KEEPS)
};

/// The stepper all implicit methods share.
pub struct Implicit {
    scheme: Scheme,
    newton: Newton,
    /// The unknown: a velocity.
    u: Vec<f64>,
    /// The velocity u departs from.
    b: Vec<f64>,
    /// The position γ u is added to.
    y: Vec<f64>,
    a: Vec<f64>,
    x: Vec<f64>,
}

impl Implicit {
    pub fn new(scheme: Scheme, settings: &Settings) -> Self {
        Self {
            scheme,
            newton: Newton::new(settings.tolerance),
            u: Vec::new(),
            b: Vec::new(),
            y: Vec::new(),
            a: Vec::new(),
            x: Vec::new(),
        }
    }

    /// Solves for `u` and leaves the stage's position in `self.x`.
    fn solve(&mut self, system: &dyn System, t: f64, gamma: f64) -> Result<(), StepError> {
        self.newton
            .solve(system, t, gamma, &self.b, &self.y, &mut self.u)?;
        self.x.copy_from_slice(&self.y);
        axpy(&mut self.x, gamma, &self.u);
        Ok(())
    }
}

impl Integrator for Implicit {
    fn step(&mut self, system: &dyn System, h: f64, state: &mut State) -> Result<(), StepError> {
        let n = state.x.len();
        for buffer in [
            &mut self.u,
            &mut self.b,
            &mut self.y,
            &mut self.a,
            &mut self.x,
        ] {
            fit(buffer, n);
        }
        self.u.copy_from_slice(&state.v);
        self.b.copy_from_slice(&state.v);
        self.y.copy_from_slice(&state.x);
        let t = state.t;
        let mut work = state.work;
        match self.scheme {
            Scheme::Euler => {
                self.solve(system, t + h, h)?;
                state.x.copy_from_slice(&self.x);
                state.v.copy_from_slice(&self.u);
                let end = self.newton.last_power();
                work.advance(end, h);
            }
            Scheme::LinearizedEuler(linearization) => {
                let power = self
                    .newton
                    .single(system, t, h, linearization, state, &mut self.u)?;
                state.v.copy_from_slice(&self.u);
                axpy(&mut state.x, h, &self.u);
                work.advance(power, h);
            }
            Scheme::Midpoint => {
                self.solve(system, t + 0.5 * h, 0.5 * h)?;
                work.advance(self.newton.last_power(), h);
                axpy(&mut state.x, h, &self.u);
                // v1 = v0 + 2 (u - v0), so that what does not accelerate keeps its bits.
                for (v, u) in state.v.iter_mut().zip(&self.u) {
                    *v += 2.0 * (u - *v);
                }
            }
            Scheme::Trapezoidal => {
                let start = system.acceleration(t, &state.x, &state.v, &mut self.a);
                axpy(&mut self.b, 0.5 * h, &self.a);
                axpy(&mut self.y, 0.5 * h, &state.v);
                self.solve(system, t + h, 0.5 * h)?;
                work.advance(start, 0.5 * h);
                work.advance(self.newton.last_power(), 0.5 * h);
                state.x.copy_from_slice(&self.x);
                state.v.copy_from_slice(&self.u);
            }
        }
        state.work = work;
        state.t = t + h;
        Ok(())
    }

    fn linear_solves(&self) -> u64 {
        self.newton.solves()
    }

    fn newton_iterations(&self) -> u64 {
        self.newton.iterations()
    }
}
