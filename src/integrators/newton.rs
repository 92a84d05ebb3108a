//! Newton's iteration for M (u - b) = γ f(t, y + γ u, u), over a dense or a sparse LU.
//!
//! Plain full steps: a line search and a regularised stiffness are not here yet, so a solve that
//! does not converge is an error, never a silent continuation.

mod linear;

use super::{StepError, fit};
use crate::system::{Jacobian, Linearization, Power, State, System};
use linear::Solver;

/// Quadratic convergence needs four to six; more means it is not converging.
const MAX_ITERATIONS: u32 = 50;

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

    /// Improves `u` until |r| <= tolerance (|M (u - b)| + |γ f|) or until a correction is rounding.
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
        let mut rounding = false;
        for _ in 0..MAX_ITERATIONS {
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
            relative = if scale > 0.0 { off / scale } else { 0.0 };
            if relative <= self.tolerance || rounding {
                return Ok(());
            }
            self.jacobian.clear();
            system.jacobian(t, &self.x, u, Linearization::Exact, &mut self.jacobian);
            self.correct(inverse_mass, gamma)?;
            let (mut largest, mut ulp) = (0.0_f64, 0.0_f64);
            for i in 0..n {
                let du = self.residual[i];
                u[i] += du;
                largest = largest.max(du.abs());
                // The smallest velocity change that still moves a position by its last bit.
                ulp = ulp.max(f64::EPSILON * (u[i].abs() + self.x[i].abs() / gamma.abs()));
            }
            // The correction just made is below what positions resolve: as converged as doubles get.
            rounding = largest <= 4.0 * ulp;
        }
        Err(StepError::NotConverged {
            iterations: MAX_ITERATIONS,
            residual: relative,
            tolerance: self.tolerance,
        })
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
