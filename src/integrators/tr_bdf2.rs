//! TR-BDF2: a trapezoidal stage, then a backward difference over it. Made for stiff oscillation.

use super::newton::Newton;
use super::{
    Amplification, EnergyLaw, Exact, Integrator, Method, Oscillator, PerStep, Settings, Stable,
    StepError, axpy, fit,
};
use crate::system::{State, System};
use std::f64::consts::SQRT_2;

/// Where the trapezoidal stage ends, in steps: g = 2 - √2 gives both stages one implicit coefficient.
const STAGE: f64 = 2.0 - SQRT_2;
/// That coefficient, g/2.
const IMPLICIT: f64 = 0.5 * STAGE;
/// How far the difference formula goes beyond the stage: 1/(g (2 - g)) = (1 + √2)/2.
const BEYOND: f64 = 0.5 * (1.0 + SQRT_2);
/// What start and stage weigh in the step as a whole: √2/4.
const WEIGHT: f64 = 0.25 * SQRT_2;
/// z² at which a step takes a quarter of the energy: 4/g² = (2 + √2)².
const CORNER: f64 = 6.0 + 4.0 * SQRT_2;

pub(super) const TR_BDF2: Method = Method {
    id: "tr_bdf2",
    name: "TR-BDF2",
    order: 2,
    order_damped: 2,
    symplectic: false,
    reversible: false,
    // The start, and for each of two stages one to see that it has converged.
    evaluations: PerStep::PerIteration { plus: 3 },
    oscillator: Oscillator {
        stable: Stable::Always,
        // |R(iz)|² of R(ζ) = (1 + (√2 - 1) ζ) / (1 - g ζ/2)², which vanishes at infinity.
        energy: EnergyLaw::Factor {
            factor: |z| 1.0 - (z * z / (z * z + CORNER)).powi(2),
            formula: "1 - (z²/(z² + (2 + √2)²))²",
        },
    },
    amplification: Amplification::Rational {
        // R = (1 + (√2 - 1) z) / (1 - g z/2)².
        numerator: &[1.0, SQRT_2 - 1.0],
        denominator: &[1.0, SQRT_2 - 2.0, 1.5 - SQRT_2],
    },
    exact: Exact::of_order(2),
    source: "Bank et al. 1985, IEEE Trans. CAD 4; Hosea & Shampine 1996, Appl. Numer. Math. 20",
    not: "trapezoidal, which lets stiff modes ring; BDF2, which needs two steps of the past",
    build: |settings| Box::new(TrBdf2::new(settings)),
};

/// Over [t, t + g h] the trapezoidal rule, then the second-order backward difference through start and
/// stage to t + h. One-step, second order, L-stable: what is fast against h dies out, what is slow
/// keeps its energy to z⁴ a step.
///
/// Both stages are M (u - b) = γ f(t', y + γ u, u) with γ = g h/2.
pub struct TrBdf2 {
    newton: Newton,
    /// The unknown: a velocity.
    u: Vec<f64>,
    /// The velocity u departs from.
    b: Vec<f64>,
    /// The position γ u is added to.
    y: Vec<f64>,
    a: Vec<f64>,
}

impl TrBdf2 {
    pub fn new(settings: &Settings) -> Self {
        Self {
            newton: Newton::new(settings.tolerance),
            u: Vec::new(),
            b: Vec::new(),
            y: Vec::new(),
            a: Vec::new(),
        }
    }
}

impl Integrator for TrBdf2 {
    fn step(&mut self, system: &dyn System, h: f64, state: &mut State) -> Result<(), StepError> {
        let n = state.x.len();
        for buffer in [&mut self.u, &mut self.b, &mut self.y, &mut self.a] {
            fit(buffer, n);
        }
        let gamma = IMPLICIT * h;
        let mut work = state.work;

        let start = system.acceleration(state.t, &state.x, &state.v, &mut self.a);
        self.u.copy_from_slice(&state.v);
        self.b.copy_from_slice(&state.v);
        self.y.copy_from_slice(&state.x);
        axpy(&mut self.b, gamma, &self.a);
        axpy(&mut self.y, gamma, &state.v);
        let at = state.t + STAGE * h;
        self.newton
            .solve(system, at, gamma, &self.b, &self.y, &mut self.u)?;
        work.advance(start, WEIGHT * h);
        work.advance(self.newton.last_power(), WEIGHT * h);

        // Differences from the start, so that what does not accelerate keeps its bits.
        axpy(&mut self.y, gamma, &self.u);
        for (y, x) in self.y.iter_mut().zip(&state.x) {
            *y = x + BEYOND * (*y - x);
        }
        for ((b, u), v) in self.b.iter_mut().zip(&self.u).zip(&state.v) {
            *b = v + BEYOND * (u - v);
        }
        let end = state.t + h;
        self.newton
            .solve(system, end, gamma, &self.b, &self.y, &mut self.u)?;
        work.advance(self.newton.last_power(), gamma);

        axpy(&mut self.y, gamma, &self.u);
        state.x.copy_from_slice(&self.y);
        state.v.copy_from_slice(&self.u);
        state.work = work;
        state.t = end;
        Ok(())
    }

    fn linear_solves(&self) -> u64 {
        self.newton.solves()
    }

    fn newton_iterations(&self) -> u64 {
        self.newton.iterations()
    }
}
