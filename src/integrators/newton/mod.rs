//! Newton's iteration for M (u - b) = γ f(t, y + γ u, u), globalised.
//!
//! Full steps wherever they descend ([`search`]), in directions that always do ([`regularise`]),
//! over blocks of 3 x 3 ([`matrix`]) and the linear solver the matrix calls for ([`choose`]). Every
//! decision depends on the equation at hand alone, so an integrator that was used gives the same
//! bits as a fresh one.

mod choose;
mod conjugate;
mod dense;
mod matrix;
mod pattern;
mod regularise;
mod search;
mod solver;
mod sparse;
mod stage;
#[cfg(test)]
mod tests;

use super::{StepError, fit, worst_particle};
use crate::physics::{Jacobian, Linearization, Power, Slope, State, System};
use choose::Kind;
use matrix::Matrix;
use search::{Merit, Search};
use solver::{Solved, Solver};
use stage::{Stage, Trial};

/// Quadratic convergence needs four to six, a way around hills a few dozen, along a valley that bends
/// hundreds; more means it is not converging.
const MAX_ITERATIONS: u32 = 2_000;
/// Roundings that a residual may consist of when it stops shrinking.
const ROUNDING: f64 = 8.0;
/// Where linear systems are solved by iteration, to this share of the residual at most.
const FORCING: f64 = 1e-3;
/// Relative residual from which on Newton's step is tried even where it need not descend, and again
/// whenever half of the residual at the last failure is left.
const LINEAR: f64 = 0.1;
/// One plain solve, of the methods that do not iterate, is solved to rounding, by factors.
const PLAIN: f64 = 0.0;

pub(super) struct Newton {
    tolerance: f64,
    solver: Solver,
    matrix: Matrix,
    jacobian: Jacobian,
    /// Where the iteration is, and where it may go next.
    at: Trial,
    next: Trial,
    /// The direction, over all coordinates and over the matrix's rows.
    d: Vec<f64>,
    z: Vec<f64>,
    solves: u64,
    iterations: u64,
}

impl Newton {
    pub(super) fn new(tolerance: f64) -> Self {
        Self {
            tolerance,
            solver: Solver::default(),
            matrix: Matrix::default(),
            jacobian: Jacobian::in_blocks(),
            at: Trial::default(),
            next: Trial::default(),
            d: Vec::new(),
            z: Vec::new(),
            solves: 0,
            iterations: 0,
        }
    }

    pub(super) fn solves(&self) -> u64 {
        self.solves
    }

    /// Iterations of Newton's method in all; a single linearised step is none.
    pub(super) fn iterations(&self) -> u64 {
        self.iterations
    }

    /// Improves `u` until |r| <= tolerance (|M (u - b)| + |γ f|), or until it stops shrinking
    /// within a few roundings of the positions: far from the origin forces are no better. Returns the
    /// powers there.
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
        let stage = Stage {
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

    /// Leaves the solution in `self.at`; `seen` is shown every accepted iterate.
    fn iterate(
        &mut self,
        stage: &Stage,
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
        let mut before = f64::INFINITY;
        let mut merit = Merit::Potential;
        let mut leap = LINEAR;
        for iteration in 0..MAX_ITERATIONS {
            seen(&self.at);
            // A guess is not a solution, however loose the tolerance.
            let solved =
                self.at.off == 0.0 || (iteration > 0 && self.at.relative <= self.tolerance);
            // Newton squares a small residual until only rounding is left of it.
            let stalled = self.at.relative >= 0.5 * before;
            if solved || (stalled && self.at.off <= self.floor(stage)) {
                return Ok(());
            }
            before = self.at.relative;
            self.iterations += 1;
            // In step with Newton, which squares the residual; no further than is asked for.
            let wanted = (0.1 * self.at.relative).min(FORCING);
            let left = 0.25 * self.tolerance / self.at.relative;
            let precise = wanted.max(left).min(0.1);
            let own = self.newton(stage, precise)?;
            if !own {
                if self.at.relative <= leap {
                    if self.leap(stage) {
                        std::mem::swap(&mut self.at, &mut self.next);
                        continue;
                    }
                    leap = 0.5 * self.at.relative;
                }
                self.descend(stage, precise)?;
            }
            while !self.advance(stage, merit, own) {
                if merit == Merit::Slope {
                    return Err(self.not_converged(iteration));
                }
                // The potential cannot tell: rounding hides it, or it is not these forces'.
                merit = Merit::Slope;
            }
            std::mem::swap(&mut self.at, &mut self.next);
        }
        Err(self.not_converged(MAX_ITERATIONS))
    }

    /// Leaves the next iterate in `self.next`; false where no step is good.
    fn advance(&mut self, stage: &Stage, merit: Merit, own: bool) -> bool {
        let search = Search {
            stage,
            d: &self.d,
            jacobian: &self.jacobian,
            merit,
            extend: !own,
            tolerance: self.tolerance,
        };
        let (jacobian, size) = (&self.jacobian, &mut self.z);
        let mut known = None;
        search.run(&mut self.at, &mut self.next, |from| {
            *known.get_or_insert_with(|| floor(stage, jacobian, from, size))
        })
    }

    fn floor(&mut self, stage: &Stage) -> f64 {
        floor(stage, &self.jacobian, &self.at, &mut self.z)
    }

    fn not_converged(&self, iterations: u32) -> StepError {
        StepError::NotConverged {
            iterations,
            residual: self.at.relative,
            tolerance: self.tolerance,
            particle: self.at.particle(),
        }
    }

    /// One Newton step of backward Euler from the state itself:
    /// (M - h C - h² K) Δv = h (f0 + h K v0), everything taken at (x0, v0). Returns the powers there.
    ///
    /// As the literature has it: no search, and the matrix as it is, definite or not.
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
        fit(&mut self.d, n);
        let mut a = vec![0.0; n];
        let inverse_mass = system.inverse_mass();
        // Forces that depend on time are met at the end of the step, as in implicit Euler.
        let power = system.acceleration(t + h, &state.x, &state.v, &mut a);
        self.jacobian.clear();
        system.jacobian(t + h, &state.x, &state.v, linearization, &mut self.jacobian);
        let right = &mut a;
        for (right, &w) in right.iter_mut().zip(inverse_mass) {
            *right = if w > 0.0 { h * *right / w } else { 0.0 };
        }
        self.jacobian
            .add_product(Slope::Position, h * h, &state.v, right);
        for (right, &w) in right.iter_mut().zip(inverse_mass) {
            if w == 0.0 {
                *right = 0.0;
            }
        }
        if self.matrix.assemble(inverse_mass, h, &self.jacobian) {
            self.solver.forget();
        }
        self.z.clear();
        let values = self.matrix.coordinates().iter();
        self.z
            .extend(values.map(|&at| right.get(at).copied().unwrap_or(0.0)));
        self.solves += 1;
        let (solver, matrix) = (&mut self.solver, &self.matrix);
        // A few unknowns by LU whatever their matrix, as ever: at huge steps it is all rounding, and
        // both of these methods then meet the same.
        if Kind::is_dense(matrix)
            || solver.solve(matrix, inverse_mass, PLAIN, &mut self.z)? == Solved::Indefinite
        {
            solver.solve_lu(matrix, &mut self.z)?;
        }
        self.spread();
        for (u, du) in u.iter_mut().zip(&self.d) {
            *u += du;
        }
        if u.iter().all(|u| u.is_finite()) {
            Ok(power)
        } else {
            Err(StepError::NotFinite {
                particle: worst_particle(u),
            })
        }
    }
}

/// The particle with the largest entry, rows of a matrix standing for these coordinates.
fn worst(coordinates: &[usize], rows: &[f64]) -> usize {
    let row = 3 * worst_particle(rows);
    coordinates.get(row).map_or(0, |at| at / 3)
}

/// What a few roundings of positions and velocities do to the residual at `at`, in its norm:
/// eps (γ |∂f/∂x| max(|y|, |γ u|) + M (|u| + |b|)), with the last Jacobian. `size` is scratch.
fn floor(stage: &Stage, jacobian: &Jacobian, at: &Trial, size: &mut Vec<f64>) -> f64 {
    size.clear();
    size.resize(at.u.len(), 0.0);
    // y and γ u may cancel: their sum is no better than they are.
    let parts = stage.y.iter().zip(&at.u);
    let reach: Vec<f64> = parts
        .map(|(y, u)| y.abs().max((stage.gamma * u).abs()))
        .collect();
    jacobian.add_magnitudes(Slope::Position, stage.gamma, &reach, size);
    let mut squares = 0.0;
    for (i, &w) in stage.system.inverse_mass().iter().enumerate() {
        if w > 0.0 {
            let size = size[i] + (at.u[i].abs() + stage.b[i].abs()) / w;
            squares += size * size;
        }
    }
    ROUNDING * f64::EPSILON * squares.sqrt()
}
