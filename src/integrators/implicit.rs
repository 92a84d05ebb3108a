//! Implicit methods. One Newton iteration solves their stage equations M (u - b) = γ f(t + τ, y + γ u, u).
//! The methods differ in b, y, γ and in how the step follows from the stage velocity u.

use super::newton::Newton;
use super::{Coefficients, Integrator, MethodRow, Settings, StepError, Tableau, axpy, fit, refuse};
use crate::physics::{ForceKinds, Linearization, Power, State, System};
use std::f64::consts::SQRT_2;

/// The implicit methods that one stepper runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ImplicitScheme {
    /// Backward Euler, solved to the tolerance.
    Euler,
    /// The first Newton iterate of backward Euler from u = v0: force and Jacobians at x0 + h v0.
    PredictedEuler,
    /// The same with force and Jacobians at x0, and this linearization of the force.
    LinearizedEuler(Linearization),
    Midpoint,
    Trapezoidal,
    /// The trapezoidal rule over [t, t + g h], then the second-order backward difference through start and
    /// stage to t + h. It is L-stable: modes that are fast against h die out, and slow ones keep their energy
    /// to z⁴ a step. With g = 2 - √2 both stages have the same γ = g h/2.
    TrBdf2,
}

impl ImplicitScheme {
    /// The kinds of forces it accepts. One Newton step is of first order for any force. The line search of
    /// Newton's iteration needs a force linear in v. None solves for the forces of rods with the positions.
    pub(super) const fn takes(self) -> ForceKinds {
        match self {
            Self::PredictedEuler | Self::LinearizedEuler(_) => {
                ForceKinds::ANY.without(ForceKinds::CONSTRAINED)
            }
            _ => ForceKinds::LINEAR,
        }
    }

    /// The Runge-Kutta method it is equal to; the linearised ones are so for linear forces.
    pub(super) fn tableau(self) -> Tableau {
        match self {
            Self::Euler | Self::PredictedEuler | Self::LinearizedEuler(_) => Tableau {
                a: &[&[1.0]],
                b: &[1.0],
                c: &[1.0],
            },
            Self::Midpoint => Tableau {
                a: &[&[0.5]],
                b: &[1.0],
                c: &[0.5],
            },
            Self::Trapezoidal => Tableau {
                a: &[&[], &[0.5, 0.5]],
                b: &[0.5, 0.5],
                c: &[0.0, 1.0],
            },
            Self::TrBdf2 => Tableau {
                a: &[&[], &[IMPLICIT, IMPLICIT], &[WEIGHT, WEIGHT, IMPLICIT]],
                b: &[WEIGHT, WEIGHT, IMPLICIT],
                c: &[0.0, STAGE, 1.0],
            },
        }
    }
}

// Coefficients of TR-BDF2, in units of the step.

/// Where the trapezoidal stage ends: g = 2 - √2.
const STAGE: f64 = 2.0 - SQRT_2;
/// The implicit coefficient of both stages, g/2.
const IMPLICIT: f64 = 0.5 * STAGE;
/// How far the difference formula goes beyond the stage: 1/(g (2 - g)) = (1 + √2)/2.
const BEYOND: f64 = 0.5 * (1.0 + SQRT_2);
/// The weight of the start and of the stage in the whole step: √2/4.
const WEIGHT: f64 = 0.25 * SQRT_2;
pub(super) const IMPLICIT_EULER: MethodRow = MethodRow {
    id: "implicit_euler",
    name: "implicit Euler",
    coefficients: Coefficients::Implicit(ImplicitScheme::Euler),
    energy: Some("1/(1 + z²)"),
    source: "Hairer, Wanner, Solving ODEs II, IV.3",
    not: "linearized_implicit_predicted, which stops after one Newton iteration",
};

pub(super) const LINEARIZED_IMPLICIT_PREDICTED: MethodRow = MethodRow {
    id: "linearized_implicit_predicted",
    name: "linearly implicit Euler, predicted",
    coefficients: Coefficients::Implicit(ImplicitScheme::PredictedEuler),
    energy: Some("1/(1 + z²)"),
    source: "implicit Euler's first Newton iterate from v0; Hairer, Wanner, Solving ODEs II, IV.7-8",
    not: "linearized_implicit_at_start, whose force and Jacobians are those at x0; implicit_euler, \
          which iterates until it has converged",
};

pub(super) const LINEARIZED_IMPLICIT_AT_START: MethodRow = MethodRow {
    id: "linearized_implicit_at_start",
    name: "linearly implicit Euler, at the start",
    coefficients: Coefficients::Implicit(ImplicitScheme::LinearizedEuler(Linearization::Exact)),
    energy: Some("1/(1 + z²)"),
    source: "Baraff & Witkin 1998, Large Steps in Cloth Simulation, with the exact Jacobian",
    not: "linearized_implicit_predicted, whose force and Jacobians are those at x0 + h v0",
};

pub(super) const LINEARIZED_IMPLICIT_MATERIAL: MethodRow = MethodRow {
    id: "linearized_implicit_material",
    name: "linearly implicit Euler, K = k n nᵀ",
    coefficients: Coefficients::Implicit(ImplicitScheme::LinearizedEuler(Linearization::Material)),
    energy: Some("1/(1 + z²)"),
    source: "Baraff & Witkin 1998 with K = k n nᵀ; what rapier's spring joint converges to",
    not: "linearized_implicit_at_start: here the stiffness of a spring's turning is left out, so transverse \
          motion is only as stable as symplectic Euler's",
};

pub(super) const IMPLICIT_MIDPOINT: MethodRow = MethodRow {
    id: "implicit_midpoint",
    name: "implicit midpoint",
    coefficients: Coefficients::Implicit(ImplicitScheme::Midpoint),
    energy: Some("1"),
    source: "Hairer, Lubich, Wanner, Geometric Numerical Integration, II.1 (Gauss, s = 1)",
    not: "midpoint, its explicit namesake, or trapezoidal, its conjugate",
};

pub(super) const TRAPEZOIDAL: MethodRow = MethodRow {
    id: "trapezoidal",
    name: "trapezoidal rule",
    coefficients: Coefficients::Implicit(ImplicitScheme::Trapezoidal),
    energy: Some("1"),
    source: "Crank & Nicolson 1947; Newmark 1959 with β = 1/4, γ = 1/2",
    not: "heun, its explicit namesake; conjugate to a symplectic method, not one itself",
};

pub(super) const TR_BDF2: MethodRow = MethodRow {
    id: "tr_bdf2",
    name: "TR-BDF2",
    coefficients: Coefficients::Implicit(ImplicitScheme::TrBdf2),
    energy: Some("1 - (z²/(z² + (2 + √2)²))²"),
    source: "Bank et al. 1985, IEEE Trans. CAD 4; Hosea & Shampine 1996, Appl. Numer. Math. 20",
    not: "trapezoidal, which lets stiff modes ring; BDF2, which needs two steps of the past",
};

/// The stepper that all implicit methods share.
pub struct Implicit {
    scheme: ImplicitScheme,
    newton: Newton,
    /// The unknown: a velocity.
    u: Vec<f64>,
    /// The velocity u departs from.
    b: Vec<f64>,
    /// The position to which γ u is added; once the stage is solved, its position.
    y: Vec<f64>,
    a: Vec<f64>,
}

impl Implicit {
    pub fn new(scheme: ImplicitScheme, settings: &Settings) -> Self {
        Self {
            scheme,
            newton: Newton::new(*settings),
            u: Vec::new(),
            b: Vec::new(),
            y: Vec::new(),
            a: Vec::new(),
        }
    }

    /// Solves for `u` and moves `y` to the stage's position; returns the powers there.
    fn solve(&mut self, system: &dyn System, t: f64, gamma: f64) -> Result<Power, StepError> {
        let power = self
            .newton
            .solve(system, t, gamma, &self.b, &self.y, &mut self.u)?;
        axpy(&mut self.y, gamma, &self.u);
        Ok(power)
    }

    /// Applies the trapezoidal rule over 2 γ from the state; returns the powers at its start and its end.
    fn trapezoid(
        &mut self,
        system: &dyn System,
        gamma: f64,
        end: f64,
        state: &State,
    ) -> Result<[Power; 2], StepError> {
        let start = system.acceleration(state.t, &state.x, &state.v, &mut self.a);
        axpy(&mut self.b, gamma, &self.a);
        axpy(&mut self.y, gamma, &state.v);
        Ok([start, self.solve(system, end, gamma)?])
    }
}

impl Integrator for Implicit {
    fn step(&mut self, system: &dyn System, h: f64, state: &mut State) -> Result<(), StepError> {
        refuse(self, system)?;
        let n = state.x.len();
        for buffer in [&mut self.u, &mut self.b, &mut self.y, &mut self.a] {
            fit(buffer, n);
        }
        self.u.copy_from_slice(&state.v);
        self.b.copy_from_slice(&state.v);
        self.y.copy_from_slice(&state.x);
        let (t, end) = (state.t, state.t + h);
        let mut work = state.work;
        match self.scheme {
            ImplicitScheme::Euler => work.advance(self.solve(system, end, h)?, h),
            ImplicitScheme::PredictedEuler => {
                let newton = &mut self.newton;
                let power = newton.first(system, end, h, &self.b, &self.y, &mut self.u)?;
                axpy(&mut self.y, h, &self.u);
                work.advance(power, h);
            }
            ImplicitScheme::LinearizedEuler(linearization) => {
                let power = self
                    .newton
                    .single(system, t, h, linearization, state, &mut self.u)?;
                axpy(&mut self.y, h, &self.u);
                work.advance(power, h);
            }
            ImplicitScheme::Midpoint => {
                let power = self.solve(system, t + 0.5 * h, 0.5 * h)?;
                work.advance(power, h);
                self.y.copy_from_slice(&state.x);
                axpy(&mut self.y, h, &self.u);
                // v1 = v0 + 2 (u - v0), so that a velocity without acceleration keeps its bits.
                for (u, v) in self.u.iter_mut().zip(&state.v) {
                    *u = v + 2.0 * (*u - v);
                }
            }
            ImplicitScheme::Trapezoidal => {
                for power in self.trapezoid(system, 0.5 * h, end, state)? {
                    work.advance(power, 0.5 * h);
                }
            }
            ImplicitScheme::TrBdf2 => {
                let gamma = IMPLICIT * h;
                for power in self.trapezoid(system, gamma, t + STAGE * h, state)? {
                    work.advance(power, WEIGHT * h);
                }
                // Differences are taken from the start, so that a velocity without acceleration keeps its bits.
                for (y, x) in self.y.iter_mut().zip(&state.x) {
                    *y = x + BEYOND * (*y - x);
                }
                for ((b, u), v) in self.b.iter_mut().zip(&self.u).zip(&state.v) {
                    *b = v + BEYOND * (u - v);
                }
                work.advance(self.solve(system, end, gamma)?, gamma);
            }
        }
        state.x.copy_from_slice(&self.y);
        state.v.copy_from_slice(&self.u);
        state.work = work;
        state.t = end;
        Ok(())
    }

    fn takes(&self) -> ForceKinds {
        self.scheme.takes()
    }

    fn linear_solves(&self) -> u64 {
        self.newton.solves
    }

    fn newton_iterations(&self) -> u64 {
        self.newton.iterations
    }
}
