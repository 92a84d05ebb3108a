//! A linear solve. The algorithm that suits the matrix solves with its symmetric part; iterative refinement
//! follows where the matrix is not symmetric.

use super::conjugate::{Conjugate, ConjugateEnd, dot};
use super::factors::{Dense, Sparse, SparseLu, solve_dense_lu};
use super::matrix::Matrix;
use super::{StepError, fit, largest};
use crate::vector::axpy;

/// The number of refinements before LU takes over. The closer the matrix is to its symmetric part, the more
/// digits each one gains.
const REFINEMENTS: usize = 8;
/// The residual of a refined solve, relative to the right side in the maximum norm: a few last bits.
const REFINED: f64 = 4.0 * f64::EPSILON;
/// Conjugate gradients are given up after this many times the iterations that were expected.
const BUDGET: f64 = 8.0;
/// The number of rows up to which a dense factor is at least as fast.
const DENSE: usize = 60;
/// The multiplications that a sparse factorisation does in the time of one in a product with the matrix. The
/// factorisation runs in blocks, and the product waits for memory. An estimate.
const DENSER: f64 = 4.0;

/// The algorithm that solves with the symmetric part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Algorithm {
    /// Dense Cholesky.
    Dense,
    /// Sparse Cholesky.
    Sparse,
    /// Conjugate gradients.
    Conjugate,
}

/// A solver of linear systems. It keeps factors and their memory, for matrices of one pattern.
#[derive(Default)]
pub(super) struct LinearSolver {
    /// An algorithm that replaces the one the matrix calls for.
    pub forced: Option<Algorithm>,
    dense: Dense,
    sparse: Option<Sparse>,
    lu: Option<SparseLu>,
    conjugate: Conjugate,
    right: Vec<f64>,
    residual: Vec<f64>,
}

impl LinearSolver {
    /// Drops the factors, since the pattern is new.
    pub(super) fn forget(&mut self) {
        self.sparse = None;
        self.lu = None;
    }

    /// Replaces `z` by A⁻¹ z, if the symmetric part of A is found positive definite. Factors solve to rounding,
    /// conjugate gradients to `tolerance` of the norm of `z`. False, with nothing solved, if it is not positive
    /// definite.
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
            let cap = BUDGET * iterations(matrix, inverse_mass, tolerance);
            // In exact arithmetic as many iterations as unknowns are enough.
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
        } else if !refine(matrix, z, &mut self.right, &mut self.residual, solve) {
            z.copy_from_slice(&self.right);
            self.solve_lu(matrix, z)?;
        }
        Ok(true)
    }

    /// The algorithm that `solve` uses: dense for few unknowns, else the one with the least expected work.
    ///
    /// A factor of `fill` numbers takes fill² / n multiplications, independent of the stiffness. The choice
    /// depends on this matrix and its pattern alone, never on earlier solves.
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

    /// Solves with LU of the matrix itself, definite or not.
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

    /// Solves by conjugate gradients on the symmetric part, with refinement for the whole matrix.
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
        let mut residual = std::mem::take(&mut self.residual);
        fit(&mut residual, n);
        residual.copy_from_slice(z);
        z.fill(0.0);
        let mut ended = ConjugateEnd::Slow;
        for _ in 0..REFINEMENTS {
            // The solve with the symmetric part may use half of the tolerance.
            let inner = (0.5 * enough / norm(&residual)).min(0.5);
            ended = self.conjugate.solve(matrix, inner, cap, &mut residual);
            if ended != ConjugateEnd::Solved {
                break;
            }
            axpy(z, 1.0, &residual);
            matrix.product(z, &mut residual);
            for (residual, right) in residual.iter_mut().zip(&self.right) {
                *residual = right - *residual;
            }
            if norm(&residual) <= enough {
                break;
            }
            ended = ConjugateEnd::Slow;
        }
        self.residual = residual;
        ended
    }
}

pub(super) fn is_small(matrix: &Matrix) -> bool {
    matrix.size() <= DENSE
}

/// The number of iterations that conjugate gradients are expected to take, by theory.
///
/// With D the blocks on the diagonal, the eigenvalues of D⁻¹ A lie between the smallest of M / D and about 2. So
/// each factor of e in ln(2 / tolerance) takes sqrt(2 D / M) / 2 iterations, more the larger γ ω is.
fn iterations(matrix: &Matrix, inverse_mass: &[f64], tolerance: f64) -> f64 {
    let digits = (2.0 / tolerance).ln();
    0.5 * digits * (2.0 * matrix.stiffest(inverse_mass)).sqrt()
}

fn norm(z: &[f64]) -> f64 {
    dot(z, z).sqrt()
}

/// Solves with the whole matrix by refinement through `solve`, which solves with its symmetric part; false
/// where that does not converge. `right` then holds the original `z`.
fn refine(
    matrix: &Matrix,
    z: &mut [f64],
    right: &mut Vec<f64>,
    residual: &mut Vec<f64>,
    mut solve: impl FnMut(&mut [f64]),
) -> bool {
    right.clear();
    right.extend_from_slice(z);
    residual.clear();
    residual.extend_from_slice(z);
    let size = largest(right.iter());
    z.fill(0.0);
    let mut before = f64::INFINITY;
    for _ in 0..REFINEMENTS {
        solve(residual);
        axpy(z, 1.0, residual);
        matrix.product(z, residual);
        for (residual, right) in residual.iter_mut().zip(right.iter()) {
            *residual = right - *residual;
        }
        let off = largest(residual.iter());
        if off <= REFINED * size {
            return true;
        }
        // NaN ends the refinement too.
        if off.is_nan() || off > 0.5 * before {
            // The residual no longer shrinks: it is at rounding for this matrix, or does not converge.
            return off <= 1e-13 * size;
        }
        before = off;
    }
    false
}
