//! One linear solve: with the symmetric part, and refined where that is not all of the matrix.

use super::super::{StepError, largest};
use super::choose::{Kind, iterations};
use super::conjugate::{Conjugate, Ended};
use super::dense::{self, Dense};
use super::matrix::Matrix;
use super::sparse::{Sparse, SparseLu};

/// Refinements before LU takes over; each gains the digits the symmetric part has right.
const REFINEMENTS: usize = 8;
/// Residual of a refined solve, relative to the right side in the largest norm: a few last bits.
const REFINED: f64 = 4.0 * f64::EPSILON;
/// Beyond this many times the iterations it was chosen for, conjugate gradients give way.
const PATIENCE: f64 = 8.0;

/// Factors and their memory, for matrices of one pattern.
#[derive(Default)]
pub(super) struct Solver {
    /// Instead of what the matrix calls for.
    pub forced: Option<Kind>,
    dense: Dense,
    sparse: Option<Sparse>,
    lu: Option<SparseLu>,
    conjugate: Conjugate,
    right: Vec<f64>,
    left: Vec<f64>,
}

/// What could be done with a matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Solved {
    /// Solved, and the symmetric part is positive definite (as far as was seen).
    Definite,
    /// The symmetric part is not positive definite; nothing was solved.
    Indefinite,
}

impl Solver {
    /// What was made for another pattern is of no use.
    pub(super) fn forget(&mut self) {
        self.sparse = None;
        self.lu = None;
    }

    /// Replaces `z` by A⁻¹ z, if the symmetric part of A is positive definite: to rounding with
    /// factors, to `tolerance` of the norm of `z` by iteration.
    pub(super) fn solve(
        &mut self,
        matrix: &Matrix,
        inverse_mass: &[f64],
        tolerance: f64,
        z: &mut [f64],
    ) -> Result<Solved, StepError> {
        match self.kind(matrix, inverse_mass, tolerance)? {
            Kind::Conjugate => {
                if !self.conjugate.prepare(matrix) {
                    return Ok(Solved::Indefinite);
                }
                let cap = PATIENCE * iterations(matrix, inverse_mass, digits(tolerance));
                // As many as there are unknowns is what exact arithmetic needs.
                let cap = (cap as usize).clamp(100, 10 * matrix.size() + 100);
                self.right.clear();
                self.right.extend_from_slice(z);
                match self.by_iteration(matrix, tolerance, cap, z) {
                    Ended::Solved => return Ok(Solved::Definite),
                    Ended::Indefinite => return Ok(Solved::Indefinite),
                    Ended::Slow => z.copy_from_slice(&self.right),
                }
                self.by_sparse(matrix, z)
            }
            Kind::Dense => {
                if !self.dense.factorise(matrix) {
                    return Ok(Solved::Indefinite);
                }
                if !matrix.is_symmetric() {
                    let dense = &self.dense;
                    let refined = refine(matrix, z, &mut self.right, &mut self.left, |left| {
                        dense.solve(left);
                    });
                    if !refined {
                        z.copy_from_slice(&self.right);
                        self.solve_lu(matrix, z)?;
                    }
                } else {
                    self.dense.solve(z);
                }
                Ok(Solved::Definite)
            }
            Kind::Sparse => self.by_sparse(matrix, z),
        }
    }

    /// What `solve` takes.
    pub(super) fn kind(
        &mut self,
        matrix: &Matrix,
        inverse_mass: &[f64],
        tolerance: f64,
    ) -> Result<Kind, StepError> {
        if let Some(kind) = self.forced {
            return Ok(kind);
        }
        let mut failed = None;
        let kind = Kind::of(matrix, inverse_mass, digits(tolerance), || {
            self.laid_out(matrix).map_or_else(
                |error| {
                    failed = Some(error);
                    0
                },
                |sparse| sparse.fill(),
            )
        });
        failed.map_or(Ok(kind), Err)
    }

    fn laid_out(&mut self, matrix: &Matrix) -> Result<&mut Sparse, StepError> {
        match &mut self.sparse {
            Some(_) => {}
            empty => *empty = Some(Sparse::new(matrix)?),
        }
        self.sparse
            .as_mut()
            .ok_or(StepError::Singular { particle: 0 })
    }

    fn by_sparse(&mut self, matrix: &Matrix, z: &mut [f64]) -> Result<Solved, StepError> {
        if !self.laid_out(matrix)?.factorise(matrix) {
            return Ok(Solved::Indefinite);
        }
        let Some(sparse) = &mut self.sparse else {
            return Ok(Solved::Indefinite);
        };
        if matrix.is_symmetric() {
            sparse.solve(z);
        } else if !refine(matrix, z, &mut self.right, &mut self.left, |left| {
            sparse.solve(left);
        }) {
            z.copy_from_slice(&self.right);
            self.solve_lu(matrix, z)?;
        }
        Ok(Solved::Definite)
    }

    /// With the matrix itself, definite or not.
    ///
    /// # Errors
    /// [`StepError::Singular`].
    pub(super) fn solve_lu(&mut self, matrix: &Matrix, z: &mut [f64]) -> Result<(), StepError> {
        let particle = super::worst(matrix.coordinates(), z);
        let solved = if Kind::is_dense(matrix) {
            dense::solve_lu(matrix, z)
        } else {
            match &mut self.lu {
                Some(_) => {}
                empty => *empty = SparseLu::new(matrix),
            }
            self.lu.as_ref().is_some_and(|lu| lu.solve(matrix, z))
        };
        if solved {
            Ok(())
        } else {
            Err(StepError::Singular { particle })
        }
    }

    /// Conjugate gradients on the symmetric part, again on what is left of the whole.
    fn by_iteration(
        &mut self,
        matrix: &Matrix,
        tolerance: f64,
        cap: usize,
        z: &mut [f64],
    ) -> Ended {
        if matrix.is_symmetric() {
            return self.conjugate.solve(matrix, tolerance, cap, z);
        }
        let enough = tolerance * norm(z);
        let n = z.len();
        let mut left = std::mem::take(&mut self.left);
        super::super::fit(&mut left, n);
        left.copy_from_slice(z);
        z.fill(0.0);
        let mut ended = Ended::Slow;
        for _ in 0..REFINEMENTS {
            // Half of what is allowed goes to the symmetric part.
            let inner = (0.5 * enough / norm(&left)).min(0.5);
            ended = self.conjugate.solve(matrix, inner, cap, &mut left);
            if ended != Ended::Solved {
                break;
            }
            super::super::axpy(z, 1.0, &left);
            matrix.product(z, &mut left);
            for (left, right) in left.iter_mut().zip(&self.right) {
                *left = right - *left;
            }
            if norm(&left) <= enough {
                break;
            }
            ended = Ended::Slow;
        }
        self.left = left;
        ended
    }
}

/// What theory says conjugate gradients have to gain, in natural digits.
fn digits(tolerance: f64) -> f64 {
    (2.0 / tolerance).ln()
}

fn norm(z: &[f64]) -> f64 {
    super::conjugate::dot(z, z).sqrt()
}

/// Solves with the whole matrix through `solve`, which knows its symmetric part only; false where
/// that does not converge. `right` is left with what `z` was.
fn refine(
    matrix: &Matrix,
    z: &mut [f64],
    right: &mut Vec<f64>,
    left: &mut Vec<f64>,
    mut solve: impl FnMut(&mut [f64]),
) -> bool {
    right.clear();
    right.extend_from_slice(z);
    left.clear();
    left.extend_from_slice(z);
    let size = largest(right.iter());
    z.fill(0.0);
    let mut before = f64::INFINITY;
    for _ in 0..REFINEMENTS {
        solve(left);
        super::super::axpy(z, 1.0, left);
        matrix.product(z, left);
        for (left, right) in left.iter_mut().zip(right.iter()) {
            *left = right - *left;
        }
        let off = largest(left.iter());
        if off <= REFINED * size {
            return true;
        }
        // NaN is not less.
        if off.is_nan() || off > 0.5 * before {
            // No longer shrinking: at rounding for this matrix, or not converging at all.
            return off <= 1e-13 * size;
        }
        before = off;
    }
    false
}
