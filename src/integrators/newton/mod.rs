//! Newton's iteration for M (u - b) = γ f(t, y + γ u, u), globalised by a line search.
//!
//! It takes descent directions, and full steps wherever they descend ([`search`]). The matrix has blocks of
//! 3 x 3 ([`matrix`]), and the algorithm that suits it solves the linear systems ([`solver`]). Every decision
//! depends on the present equation alone, so an integrator that was used gives the same bits as a fresh one.
//!
//! Newton's own direction A⁻¹ r descends where the symmetric part of A = M - γ C - γ² K is positive
//! definite: r·d = dᵀ A d. Compressed springs and the turning of dampers can make it indefinite. The negative
//! part is then left out spring by spring ([`Linearization::Definite`]; Teran et al. 2005, SCA; for springs
//! Choi & Ko 2002). Where a system does not separate that part, masses are added until A is definite. A
//! definite A is not changed, so convergence to a minimum stays quadratic.

mod conjugate;
mod factors;
mod matrix;
mod search;
mod solver;
#[cfg(test)]
mod tests;

use super::{Settings, StepError, fit, largest, worst_particle};
use crate::physics::{Derivative, Jacobian, Linearization, Power, State, System};
use matrix::Matrix;
use search::{Merit, StageEquation, Trial};
use solver::LinearSolver;

/// The number of roundings that a residual may consist of when it stops shrinking.
const ROUNDING: f64 = 8.0;
/// The largest relative residual of linear systems that are solved by iteration.
const FORCING: f64 = 1e-3;
/// The relative residual below which Newton's step is tried even where it need not descend. After a failure
/// it is tried again once the residual has halved.
const LINEAR: f64 = 0.1;
/// The tolerance of the single solve of methods that do not iterate: factors solve it to rounding.
const PLAIN: f64 = 0.0;
/// The first multiple of the masses that is added, and the factor by which it grows.
const SHIFT: f64 = 1.0;
const GROWTH: f64 = 4.0;
/// The number of tries with masses added: up to 4³⁰, 1e18 times the masses.
const SHIFTS: u32 = 30;

pub(super) struct Newton {
    settings: Settings,
    solver: LinearSolver,
    matrix: Matrix,
    jacobian: Jacobian,
    /// The present iterate, and a trial for the next.
    at: Trial,
    next: Trial,
    /// Whether the last trial was accepted for being nothing but rounding.
    rounded: bool,
    /// The direction, over all coordinates and over the matrix's rows.
    d: Vec<f64>,
    z: Vec<f64>,
    /// The number of linear systems solved so far.
    pub(super) solves: u64,
    /// The number of iterations so far; a single linearised step does not count.
    pub(super) iterations: u64,
}

impl Newton {
    pub(super) fn new(settings: Settings) -> Self {
        Self {
            settings,
            solver: LinearSolver::default(),
            matrix: Matrix::default(),
            jacobian: Jacobian::in_blocks(),
            at: Trial::default(),
            next: Trial::default(),
            rounded: false,
            d: Vec::new(),
            z: Vec::new(),
            solves: 0,
            iterations: 0,
        }
    }

    /// Improves `u` until |r| <= tolerance (|M (u - b)| + |γ f|), or until r stops shrinking and consists of a
    /// few roundings of the positions: far from the origin forces are no more precise. Returns the powers
    /// there.
    ///
    /// # Errors
    /// [`StepError::NotConverged`], [`StepError::NotFinite`] at the first guess, and
    /// [`StepError::Singular`]; `u` is then as it was.
    pub(super) fn solve(
        &mut self,
        system: &dyn System,
        t: f64,
        gamma: f64,
        b: &[f64],
        y: &[f64],
        u: &mut [f64],
    ) -> Result<Power, StepError> {
        let stage = StageEquation {
            system,
            t,
            gamma,
            b,
            y,
        };
        self.iterate(&stage, u, |_| {})?;
        u.copy_from_slice(&self.at.u);
        Ok(self.at.power)
    }

    /// Leaves the solution in `self.at`; calls `seen` with every accepted iterate.
    fn iterate(
        &mut self,
        stage: &StageEquation,
        guess: &[f64],
        mut seen: impl FnMut(&Trial),
    ) -> Result<(), StepError> {
        fit(&mut self.d, guess.len());
        self.at.u.clear();
        self.at.u.extend_from_slice(guess);
        self.at.evaluate(stage);
        if !self.at.is_finite() {
            let particle = self.at.particle();
            return Err(StepError::NotFinite { particle });
        }
        self.rounded = false;
        let mut before = f64::INFINITY;
        let mut merit = Merit::Potential;
        let mut full_step_below = LINEAR;
        for iteration in 0..self.settings.iterations {
            seen(&self.at);
            // A guess is not a solution, however loose the tolerance.
            let solved = self.at.norm == 0.0
                || (iteration > 0 && self.at.relative <= self.settings.tolerance);
            // Newton squares a small residual in each iteration until only rounding is left.
            let stalled = self.at.relative >= 0.5 * before;
            if solved || (stalled && (self.rounded || self.at.norm <= self.floor(stage))) {
                return Ok(());
            }
            self.rounded = false;
            before = self.at.relative;
            self.iterations += 1;
            // The linear solve is as precise as Newton's squaring of the residual needs, and no more precise
            // than the tolerance.
            let wanted = (0.1 * self.at.relative).min(FORCING);
            let left = 0.25 * self.settings.tolerance / self.at.relative;
            let precise = wanted.max(left).min(0.1);
            let own = self.direction(stage, Linearization::Exact, precise)?;
            if !own {
                if self.at.relative <= full_step_below {
                    if self.full_step(stage) {
                        std::mem::swap(&mut self.at, &mut self.next);
                        continue;
                    }
                    full_step_below = 0.5 * self.at.relative;
                }
                self.descend(stage, precise)?;
            }
            // A direction from a matrix without its negative part descends, but its length may be too short.
            while !self.advance(stage, merit, !own) {
                if merit == Merit::Slope {
                    return Err(self.not_converged(iteration));
                }
                // The potential does not decide: rounding hides its change, or these forces have none.
                merit = Merit::Slope;
            }
            std::mem::swap(&mut self.at, &mut self.next);
        }
        Err(self.not_converged(self.settings.iterations))
    }

    fn not_converged(&self, iterations: u32) -> StepError {
        StepError::NotConverged {
            iterations,
            residual: self.at.relative,
            tolerance: self.settings.tolerance,
            particle: self.at.particle(),
        }
    }

    /// Overwrites `self.d` with A⁻¹ r at `self.at`, solved at least to `tolerance`. False where the matrix is
    /// not positive definite, so that this need not be a descent direction.
    ///
    /// # Errors
    /// [`StepError::Singular`] where there is no memory for factors.
    fn direction(
        &mut self,
        stage: &StageEquation,
        kept: Linearization,
        tolerance: f64,
    ) -> Result<bool, StepError> {
        self.assemble(stage, kept);
        self.try_direction(stage, tolerance)
    }

    /// Overwrites `self.d` with a descent direction where Newton's direction need not be one.
    ///
    /// # Errors
    /// [`StepError::Singular`] where no multiple of the masses makes the matrix definite.
    fn descend(&mut self, stage: &StageEquation, tolerance: f64) -> Result<(), StepError> {
        let mut definite = self.direction(stage, Linearization::Definite, tolerance)?;
        let (mut shift, mut added) = (SHIFT, 0.0);
        for _ in 0..SHIFTS {
            if definite {
                return Ok(());
            }
            let inverse_mass = stage.system.inverse_mass();
            self.matrix.add_masses(shift - added, inverse_mass);
            definite = self.try_direction(stage, tolerance)?;
            (added, shift) = (shift, shift * GROWTH);
        }
        let particle = self.at.particle();
        definite
            .then_some(())
            .ok_or(StepError::Singular { particle })
    }

    /// Leaves in `self.next` Newton's full step with the exact matrix of [`direction`](Self::direction),
    /// definite or not. True if Φ does not rise and at most a tenth of the residual is left.
    ///
    /// A plane chain under compression is unstable against buckling sideways, where no force acts: Φ then has a
    /// saddle, which solves the equation as well as a minimum does. The directions of
    /// [`descend`](Self::descend) converge to it only linearly.
    fn full_step(&mut self, stage: &StageEquation) -> bool {
        self.matrix.gather(&self.at.residual, &mut self.z);
        if self.solver.solve_lu(&self.matrix, &mut self.z).is_err() {
            return false;
        }
        self.solves += 1;
        self.matrix.scatter(&self.z, &mut self.d);
        self.try_full_step(stage)
    }

    fn assemble(&mut self, stage: &StageEquation, kept: Linearization) {
        let (system, t) = (stage.system, stage.t);
        self.jacobian.clear();
        system.jacobian(t, &self.at.x, &self.at.u, kept, &mut self.jacobian);
        self.assembled(system, stage.gamma);
    }

    /// Assembles the matrix of `self.jacobian`.
    fn assembled(&mut self, system: &dyn System, gamma: f64) {
        let inverse_mass = system.inverse_mass();
        if self.matrix.assemble(inverse_mass, gamma, &self.jacobian) {
            self.solver.forget();
        }
    }

    /// Overwrites `self.d` with the solution of the assembled system. False where the matrix is not positive
    /// definite, or so nearly singular that the direction is not finite.
    fn try_direction(&mut self, stage: &StageEquation, tolerance: f64) -> Result<bool, StepError> {
        self.matrix.gather(&self.at.residual, &mut self.z);
        let (solver, inverse_mass) = (&mut self.solver, stage.system.inverse_mass());
        if !solver.solve(&self.matrix, inverse_mass, tolerance, &mut self.z)? {
            return Ok(false);
        }
        self.solves += 1;
        self.matrix.scatter(&self.z, &mut self.d);
        // Both vectors are scaled, since near rest their products would underflow. A direction that has
        // itself underflowed to 0 is accepted, since it changes nothing.
        let (far, steep) = (largest(&self.d), largest(&self.at.residual));
        let pairs = self.d.iter().zip(&self.at.residual);
        let along: f64 = pairs.map(|(d, r)| (d / far) * (r / steep)).sum();
        // A NaN is not accepted.
        Ok(far == 0.0 || (along > 0.0 && far.is_finite()))
    }

    /// The norm of the change that a few roundings of positions and velocities make to the residual at `self.at`:
    /// eps (γ |∂f/∂x| max(|y|, |γ u|) + γ |∂f/∂v| |u| + M (|u| + |b|)), with the last Jacobian.
    fn floor(&mut self, stage: &StageEquation) -> f64 {
        let (at, size) = (&self.at, &mut self.z);
        size.clear();
        size.resize(at.u.len(), 0.0);
        // y and γ u may cancel, so their sum has the absolute rounding of the larger.
        let parts = stage.y.iter().zip(&at.u);
        let reach: Vec<f64> = parts
            .map(|(y, u)| y.abs().max((stage.gamma * u).abs()))
            .collect();
        for (by, reach) in [
            (Derivative::Position, &reach),
            (Derivative::Velocity, &at.u),
        ] {
            (self.jacobian).add_magnitudes(by, stage.gamma, reach, size);
        }
        let mut squares = 0.0;
        for (i, &w) in stage.system.inverse_mass().iter().enumerate() {
            if w > 0.0 {
                let size = size[i] + (at.u[i].abs() + stage.b[i].abs()) / w;
                squares += size * size;
            }
        }
        ROUNDING * f64::EPSILON * squares.sqrt()
    }

    /// What the roundings of the forces add to [`floor`](Self::floor): those that cancel, such as a weight and the drag
    /// that holds it, have the rounding of the larger. As costly as an evaluation, so it is only asked where needed.
    fn cancelled(&self, stage: &StageEquation) -> f64 {
        let mut own = vec![0.0; self.at.u.len()];
        (stage.system).rounding(stage.t, &self.at.x, &self.at.u, &mut own);
        let weights = own.iter().zip(stage.system.inverse_mass());
        let free = weights.filter(|(_, w)| **w > 0.0);
        let squares: f64 = free.map(|(own, w)| (own / w) * (own / w)).sum();
        ROUNDING * stage.gamma * squares.sqrt()
    }

    /// Replaces `u` by Newton's first iterate from it: u + (M - γ C - γ² K)⁻¹ r, with everything taken at
    /// (y + γ u, u). Returns the powers there.
    ///
    /// As in [`single`](Self::single) there is no line search, and the matrix is used as it is.
    pub(super) fn first(
        &mut self,
        system: &dyn System,
        t: f64,
        gamma: f64,
        b: &[f64],
        y: &[f64],
        u: &mut [f64],
    ) -> Result<Power, StepError> {
        let stage = StageEquation {
            system,
            t,
            gamma,
            b,
            y,
        };
        fit(&mut self.d, u.len());
        self.at.u.clear();
        self.at.u.extend_from_slice(u);
        self.at.evaluate(&stage);
        self.assemble(&stage, Linearization::Exact);
        self.matrix.gather(&self.at.residual, &mut self.z);
        self.correct(system, u)?;
        Ok(self.at.power)
    }

    /// One Newton step of backward Euler from the state itself:
    /// (M - h C - h² K) Δv = h (f0 + h K v0), with everything taken at (x0, v0). Returns the powers there.
    ///
    /// As in the literature there is no line search, and the matrix is used as it is, definite or not.
    pub(super) fn single(
        &mut self,
        system: &dyn System,
        t: f64,
        h: f64,
        linearization: Linearization,
        state: &State,
        u: &mut [f64],
    ) -> Result<Power, StepError> {
        fit(&mut self.d, u.len());
        let mut right = vec![0.0; u.len()];
        let inverse_mass = system.inverse_mass();
        // What is driven is where it is at the start, too, and goes on with its velocity there.
        let (mut x, mut v) = (state.x.clone(), state.v.clone());
        system.place(t, &mut x, &mut v);
        let power = system.acceleration(t, &x, &v, &mut right);
        self.jacobian.clear();
        system.jacobian(t, &x, &v, linearization, &mut self.jacobian);
        for (right, &w) in right.iter_mut().zip(inverse_mass) {
            *right = if w > 0.0 { h * *right / w } else { 0.0 };
        }
        self.jacobian
            .add_product(Derivative::Position, h * h, &v, &mut right);
        for (right, &w) in right.iter_mut().zip(inverse_mass) {
            *right = if w > 0.0 { *right } else { 0.0 };
        }
        self.assembled(system, h);
        self.matrix.gather(&right, &mut self.z);
        self.correct(system, u)?;
        Ok(power)
    }

    /// Adds the solution of the assembled system, with the right side `self.z`, to `u`.
    fn correct(&mut self, system: &dyn System, u: &mut [f64]) -> Result<(), StepError> {
        let inverse_mass = system.inverse_mass();
        self.solves += 1;
        let (solver, matrix) = (&mut self.solver, &self.matrix);
        // A few unknowns are always solved by LU: at huge steps the result is all rounding, and is then the same
        // for the methods that use this function.
        if solver::is_small(matrix) || !solver.solve(matrix, inverse_mass, PLAIN, &mut self.z)? {
            solver.solve_lu(matrix, &mut self.z)?;
        }
        self.matrix.scatter(&self.z, &mut self.d);
        for (u, du) in u.iter_mut().zip(&self.d) {
            *u += du;
        }
        if u.iter().all(|u| u.is_finite()) {
            Ok(())
        } else {
            Err(StepError::NotFinite {
                particle: worst_particle(u),
            })
        }
    }
}
