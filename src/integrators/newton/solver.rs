//! One linear solve: with the symmetric part, by what the matrix calls for, and refined where that is not
//! all of the matrix.

use super::conjugate::{Conjugate, ConjugateEnd, dot};
use super::factors::{Dense, Sparse, SparseLu, solve_dense_lu};
use super::matrix::Matrix;
use super::{StepError, fit, largest};
use crate::vector::axpy;

/// Refinements before LU takes over; each gains the digits the symmetric part has right.
const REFINEMENTS: usize = 8;
/// Residual of a refined solve, relative to the right side in the largest norm: a few last bits.
const REFINED: f64 = 4.0 * f64::EPSILON;
/// Beyond this many times the iterations it was chosen for, conjugate gradients give way.
const PATIENCE: f64 = 8.0;
/// Up to this many rows a dense factor is as fast or faster.
const DENSE: usize = 60;
/// Multiplications of a sparse factorisation in the time of one multiplication of a product with
/// the matrix: the former run in blocks, the latter waits for memory. An estimate.
const DENSER: f64 = 4.0;

/// What solves with the symmetric part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Algorithm {
    /// Dense Cholesky.
    Dense,
    /// Sparse Cholesky.
    Sparse,
    /// Conjugate gradients.
    Conjugate,
}

/// Factors and their memory, for matrices of one pattern.
#[derive(Default)]
pub(super) struct LinearSolver {
    /// Instead of what the matrix calls for.
    pub forced: Option<Algorithm>,
    dense: Dense,
    sparse: Option<Sparse>,
    lu: Option<SparseLu>,
    conjugate: Conjugate,
    right: Vec<f64>,
    left: Vec<f64>,
}

impl LinearSolver {
    /// What was made for another pattern is of no use.
    pub(super) fn forget(&mut self) {
        self.sparse = None;
        self.lu = None;
    }

    /// Replaces `z` by A⁻¹ z, if the symmetric part of A is positive definite (as far as was seen): to
    /// rounding with factors, to `tolerance` of the norm of `z` by iteration. False, and nothing solved, if
    /// it is not.
    pub(super) fn solve(
        &mut self,
        matrix: &Matrix,
        inverse_mass: &[f64],
        tolerance: f64,
        z: &mut [f64],
    ) -> Result<bool, StepError> {
        let kind = self.kind(matrix, inverse_mass, tolerance)?;
        if kind == Algorithm::Conjugate {
            if !self.conjugate.prepare(matrix) {
                return Ok(false);
            }
            let cap = PATIENCE * iterations(matrix, inverse_mass, tolerance);
            // As many as there are unknowns is what exact arithmetic needs.
            let cap = (cap as usize).clamp(100, 10 * matrix.size() + 100);
            self.right.clear();
            self.right.extend_from_slice(z);
            match self.by_iteration(matrix, tolerance, cap, z) {
                ConjugateEnd::Solved => return Ok(true),
                ConjugateEnd::Indefinite => return Ok(false),
                ConjugateEnd::Slow => z.copy_from_slice(&self.right),
            }
        }
        let dense = kind == Algorithm::Dense;
        let definite = if dense {
            self.dense.factorise(matrix)
        } else {
            self.sparse(matrix)?.factorise(matrix)
        };
        if !definite {
            return Ok(false);
        }
        let mut solve = |z: &mut [f64]| match &mut self.sparse {
            Some(sparse) if !dense => sparse.solve(z),
            _ => self.dense.solve(z),
        };
        if matrix.is_symmetric() {
            solve(z);
        } else if !refine(matrix, z, &mut self.right, &mut self.left, solve) {
            z.copy_from_slice(&self.right);
            self.solve_lu(matrix, z)?;
        }
        Ok(true)
    }

    /// What `solve` takes: by size first; among many unknowns by the work each is expected to take.
    ///
    /// A factor of `fill` numbers takes fill² / n multiplications, whatever the stiffness. A function of
    /// this matrix and its pattern, never of what was solved before.
    pub(super) fn kind(
        &mut self,
        matrix: &Matrix,
        inverse_mass: &[f64],
        tolerance: f64,
    ) -> Result<Algorithm, StepError> {
        if let Some(kind) = self.forced {
            return Ok(kind);
        }
        if is_small(matrix) {
            return Ok(Algorithm::Dense);
        }
        let product = (9 * matrix.diagonal.len() + 18 * matrix.lower.len()) as f64;
        let iterated = iterations(matrix, inverse_mass, tolerance) * product * DENSER;
        let fill = self.sparse(matrix)?.fill() as f64;
        Ok(if iterated <= fill * fill / matrix.size() as f64 {
            Algorithm::Conjugate
        } else {
            Algorithm::Sparse
        })
    }

    fn sparse(&mut self, matrix: &Matrix) -> Result<&mut Sparse, StepError> {
        match &mut self.sparse {
            Some(sparse) => Ok(sparse),
            none => Ok(none.insert(Sparse::new(matrix)?)),
        }
    }

    /// With the matrix itself, definite or not.
    ///
    /// # Errors
    /// [`StepError::Singular`].
    pub(super) fn solve_lu(&mut self, matrix: &Matrix, z: &mut [f64]) -> Result<(), StepError> {
        let particle = matrix.worst(z);
        let solved = if is_small(matrix) {
            solve_dense_lu(matrix, z)
        } else {
            if self.lu.is_none() {
                self.lu = SparseLu::new(matrix);
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
    ) -> ConjugateEnd {
        if matrix.is_symmetric() {
            return self.conjugate.solve(matrix, tolerance, cap, z);
        }
        let enough = tolerance * norm(z);
        let n = z.len();
        let mut left = std::mem::take(&mut self.left);
        fit(&mut left, n);
        left.copy_from_slice(z);
        z.fill(0.0);
        let mut ended = ConjugateEnd::Slow;
        for _ in 0..REFINEMENTS {
            // Half of what is allowed goes to the symmetric part.
            let inner = (0.5 * enough / norm(&left)).min(0.5);
            ended = self.conjugate.solve(matrix, inner, cap, &mut left);
            if ended != ConjugateEnd::Solved {
                break;
            }
            axpy(z, 1.0, &left);
            matrix.product(z, &mut left);
            for (left, right) in left.iter_mut().zip(&self.right) {
                *left = right - *left;
            }
            if norm(&left) <= enough {
                break;
            }
            ended = ConjugateEnd::Slow;
        }
        self.left = left;
        ended
    }
}

pub(super) fn is_small(matrix: &Matrix) -> bool {
    matrix.size() <= DENSE
}

/// What theory expects of conjugate gradients, to a tolerance.
///
/// With D the blocks on the diagonal, D⁻¹ A has its eigenvalues between the smallest of M / D and about 2, so
/// the next ln(2 / tolerance) natural digits take sqrt(2 D / M) / 2 iterations each: the larger γ ω, the more.
fn iterations(matrix: &Matrix, inverse_mass: &[f64], tolerance: f64) -> f64 {
    let digits = (2.0 / tolerance).ln();
    0.5 * digits * (2.0 * matrix.stiffest(inverse_mass)).sqrt()
}

fn norm(z: &[f64]) -> f64 {
    dot(z, z).sqrt()
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
        axpy(z, 1.0, left);
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
