//! Newton's iteration for M (u - b) = γ f(t, y + γ u, u), over a dense LU or sparse factors.
//!
//! Plain full steps: a line search and a regularised stiffness are not here yet, so a solve that
//! does not converge is an error, never a silent continuation.

mod linear;
mod sparse;

use super::{StepError, axpy, fit};
use crate::system::{Jacobian, Linearization, Power, State, System};
use linear::Solver;

/// Quadratic convergence needs four to six; more means it is not converging.
const MAX_ITERATIONS: u32 = 50;
/// Roundings that a residual may consist of when it stops shrinking.
const ROUNDING: f64 = 8.0;

pub(super) struct Newton {
    tolerance: f64,
    solver: Solver,
    jacobian: Jacobian,
    x: Vec<f64>,
    a: Vec<f64>,
    residual: Vec<f64>,
    power: Power,
    solves: u64,
}

impl Newton {
    pub(super) fn new(tolerance: f64) -> Self {
        Self {
            tolerance,
            solver: Solver::default(),
            jacobian: Jacobian::default(),
            x: Vec::new(),
            a: Vec::new(),
            residual: Vec::new(),
            power: Power::default(),
            solves: 0,
        }
    }

    pub(super) fn solves(&self) -> u64 {
        self.solves
    }

    /// The powers at the converged stage.
    pub(super) fn last_power(&self) -> Power {
        self.power
    }

    /// Improves `u` until |r| <= tolerance (|M (u - b)| + |γ f|), or until it stops shrinking
    /// within a few roundings of the positions: far from the origin forces are no better.
    pub(super) fn solve(
        &mut self,
        system: &dyn System,
        t: f64,
        gamma: f64,
        b: &[f64],
        y: &[f64],
        u: &mut [f64],
    ) -> Result<(), StepError> {
        let n = u.len();
        fit(&mut self.x, n);
        fit(&mut self.a, n);
        fit(&mut self.residual, n);
        let inverse_mass = system.inverse_mass();
        let mut relative = f64::INFINITY;
        for iteration in 0..MAX_ITERATIONS {
            for ((x, y), u) in self.x.iter_mut().zip(y).zip(u.iter()) {
                *x = y + gamma * u;
            }
            self.power = system.acceleration(t, &self.x, u, &mut self.a);
            let (mut left, mut right, mut off) = (0.0_f64, 0.0_f64, 0.0_f64);
            for i in 0..n {
                let w = inverse_mass[i];
                self.residual[i] = if w > 0.0 {
                    let (inertia, impulse) = ((u[i] - b[i]) / w, gamma * self.a[i] / w);
                    left += inertia * inertia;
                    right += impulse * impulse;
                    off += (inertia - impulse) * (inertia - impulse);
                    impulse - inertia
                } else {
                    0.0
                };
            }
            let scale = left.sqrt() + right.sqrt();
            let off = off.sqrt();
            if !off.is_finite() || !scale.is_finite() {
                return Err(StepError::NotFinite);
            }
            let before = relative;
            relative = if scale > 0.0 { off / scale } else { 0.0 };
            // A guess is not a solution, however loose the tolerance.
            let solved = relative <= self.tolerance && (iteration > 0 || off == 0.0);
            // Newton squares a small residual until only rounding is left of it.
            let stalled = relative >= 0.5 * before;
            if solved || (stalled && off <= ROUNDING * self.rounding(inverse_mass, gamma, b, u)) {
                return Ok(());
            }
            self.jacobian.clear();
            system.jacobian(t, &self.x, u, Linearization::Exact, &mut self.jacobian);
            self.correct(inverse_mass, gamma)?;
            axpy(u, 1.0, &self.residual);
        }
        Err(StepError::NotConverged {
            iterations: MAX_ITERATIONS,
            residual: relative,
            tolerance: self.tolerance,
        })
    }

    /// What one rounding of positions and velocities does to the residual, in its norm:
    /// eps (γ |∂f/∂x| |x| + M (|u| + |b|)), with the Jacobian of the last iteration.
    fn rounding(&self, inverse_mass: &[f64], gamma: f64, b: &[f64], u: &[f64]) -> f64 {
        let mut size = vec![0.0; u.len()];
        for &(row, column, value) in &self.jacobian.position {
            size[row] += gamma * (value * self.x[column]).abs();
        }
        let mut squares = 0.0;
        for (i, &w) in inverse_mass.iter().enumerate() {
            if w > 0.0 {
                let size = size[i] + (u[i].abs() + b[i].abs()) / w;
                squares += size * size;
            }
        }
        f64::EPSILON * squares.sqrt()
    }

    /// One Newton step of backward Euler from the state itself:
    /// (M - h C - h² K) Δv = h (f0 + h K v0), everything taken at (x0, v0). Returns the powers there.
    pub(super) fn single(
        &mut self,
        system: &dyn System,
        t: f64,
        h: f64,
        linearization: Linearization,
        state: &State,
        u: &mut [f64],
    ) -> Result<Power, StepError> {
        let n = u.len();
        fit(&mut self.a, n);
        fit(&mut self.residual, n);
        let inverse_mass = system.inverse_mass();
        // Forces that depend on time are met at the end of the step, as in implicit Euler.
        let power = system.acceleration(t + h, &state.x, &state.v, &mut self.a);
        self.jacobian.clear();
        system.jacobian(t + h, &state.x, &state.v, linearization, &mut self.jacobian);
        for i in 0..n {
            let w = inverse_mass[i];
            self.residual[i] = if w > 0.0 { h * self.a[i] / w } else { 0.0 };
        }
        for &(row, column, value) in &self.jacobian.position {
            if inverse_mass[row] > 0.0 {
                self.residual[row] += h * h * value * state.v[column];
            }
        }
        self.correct(inverse_mass, h)?;
        for (u, du) in u.iter_mut().zip(&self.residual) {
            *u += du;
        }
        if u.iter().all(|u| u.is_finite()) {
            Ok(power)
        } else {
            Err(StepError::NotFinite)
        }
    }

    /// Replaces the residual by (M - γ C - γ² K)⁻¹ residual.
    fn correct(&mut self, inverse_mass: &[f64], gamma: f64) -> Result<(), StepError> {
        self.solves += 1;
        self.solver
            .solve(inverse_mass, gamma, &self.jacobian, &mut self.residual)
    }
}
