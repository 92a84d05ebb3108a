//! Which linear solver, from the matrix alone.

use super::matrix::Matrix;

/// What solves with the symmetric part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Dense Cholesky.
    Dense,
    /// Sparse Cholesky.
    Sparse,
    /// Conjugate gradients.
    Conjugate,
}

/// Up to this many rows a dense factor is as fast or faster.
const DENSE: usize = 60;
/// Multiplications of a sparse factorisation in the time of one multiplication of a product with
/// the matrix: the former run in blocks, the latter waits for memory. An estimate.
const DENSER: f64 = 4.0;

impl Kind {
    pub(super) fn is_dense(matrix: &Matrix) -> bool {
        matrix.size() <= DENSE
    }

    /// By size first; among many unknowns by the work each is expected to take.
    ///
    /// With D the blocks on the diagonal, D⁻¹ A has its eigenvalues between the smallest of M / D
    /// and about 2, so conjugate gradients gain the next `digits` (natural ones) in
    /// digits sqrt(2 D / M) / 2 iterations: the larger γ ω, the more. A factor of `fill` numbers
    /// takes fill² / n multiplications, whatever the stiffness. A function of this matrix and its
    /// pattern, never of what was solved before.
    pub(super) fn of(
        matrix: &Matrix,
        inverse_mass: &[f64],
        digits: f64,
        fill: impl FnOnce() -> usize,
    ) -> Self {
        let n = matrix.size();
        if Self::is_dense(matrix) {
            return Self::Dense;
        }
        let iterations = iterations(matrix, inverse_mass, digits);
        let product = (9 * matrix.diagonal.len() + 18 * matrix.lower.len()) as f64;
        let fill = fill() as f64;
        if iterations * product * DENSER <= fill * fill / n as f64 {
            Self::Conjugate
        } else {
            Self::Sparse
        }
    }
}

/// Expected of conjugate gradients.
pub(super) fn iterations(matrix: &Matrix, inverse_mass: &[f64], digits: f64) -> f64 {
    let mut stiffest = 1.0_f64;
    for (row, &at) in matrix.coordinates().iter().enumerate() {
        if let Some(w) = inverse_mass.get(at) {
            let ratio = matrix.diagonal[row / 3][(row % 3, row % 3)] * w;
            stiffest = stiffest.max(ratio);
        }
    }
    0.5 * digits * (2.0 * stiffest).sqrt()
}
