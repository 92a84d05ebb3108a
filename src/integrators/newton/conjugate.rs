//! Conjugate gradients with a block-Jacobi preconditioner, for many unknowns and modest stiffness.
//!
//! faer's own (`matrix_free::conjugate_gradient`) does not fit, since it does not report an indefinite matrix.
//! Its step length comes from a pivoted factor of pᵀ A p, which for a negative number has rank 0 and no error,
//! so the step is 0 and it runs to its limit of iterations. Here negative curvature means that another
//! direction is needed. (Nocedal & Wright 2006, Numerical Optimization, 7.1.)

use super::fit;
use super::matrix::{Matrix, three};
use nalgebra::Matrix3;

#[derive(Default)]
pub(super) struct Conjugate {
    /// Inverses of the blocks on the diagonal.
    inverse: Vec<Matrix3<f64>>,
    residual: Vec<f64>,
    preconditioned: Vec<f64>,
    direction: Vec<f64>,
    image: Vec<f64>,
}

/// How a solve ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ConjugateEnd {
    Solved,
    /// Negative curvature was found: the matrix is not positive definite.
    Indefinite,
    /// The limit of iterations was reached.
    Slow,
}

impl Conjugate {
    /// False where a block on the diagonal is not positive definite.
    pub(super) fn prepare(&mut self, matrix: &Matrix) -> bool {
        self.inverse.clear();
        for at in 0..matrix.diagonal.len() {
            let Some(inverse) = inverse(&matrix.symmetric_diagonal(at)) else {
                return false;
            };
            self.inverse.push(inverse);
        }
        let n = matrix.size();
        fit(&mut self.residual, n);
        fit(&mut self.preconditioned, n);
        fit(&mut self.direction, n);
        fit(&mut self.image, n);
        true
    }

    /// Replaces the right side `z` by the solution for the symmetric part, to `tolerance` of the
    /// right side's norm.
    ///
    /// The iteration starts from 0, so every iterate is a descent direction.
    pub(super) fn solve(
        &mut self,
        matrix: &Matrix,
        tolerance: f64,
        cap: usize,
        z: &mut [f64],
    ) -> ConjugateEnd {
        self.residual.copy_from_slice(z);
        z.fill(0.0);
        let enough = tolerance * dot(&self.residual, &self.residual).sqrt();
        let mut product = self.precondition();
        self.direction.copy_from_slice(&self.preconditioned);
        for _ in 0..cap {
            if product == 0.0 {
                return ConjugateEnd::Solved;
            }
            matrix.symmetric_product(&self.direction, &mut self.image);
            let curvature = dot(&self.direction, &self.image);
            // NaN counts as indefinite.
            if curvature.is_nan() || curvature <= 0.0 {
                return ConjugateEnd::Indefinite;
            }
            let length = product / curvature;
            let mut squares = [0.0; 4];
            for (((z, residual), d), image) in z
                .chunks_mut(4)
                .zip(self.residual.chunks_mut(4))
                .zip(self.direction.chunks(4))
                .zip(self.image.chunks(4))
            {
                for ((((z, residual), d), image), square) in z
                    .iter_mut()
                    .zip(residual)
                    .zip(d)
                    .zip(image)
                    .zip(&mut squares)
                {
                    *z += length * d;
                    *residual -= length * image;
                    *square += *residual * *residual;
                }
            }
            if squares.iter().sum::<f64>().sqrt() <= enough {
                return ConjugateEnd::Solved;
            }
            let before = std::mem::replace(&mut product, self.precondition());
            let ratio = product / before;
            for (d, p) in self.direction.iter_mut().zip(&self.preconditioned) {
                *d = p + ratio * *d;
            }
        }
        ConjugateEnd::Slow
    }

    /// Preconditions the residual; returns the product of the residual and the result.
    fn precondition(&mut self) -> f64 {
        for (at, inverse) in self.inverse.iter().enumerate() {
            let z = inverse * three(&self.residual, at);
            self.preconditioned[3 * at..3 * at + 3].copy_from_slice(z.as_slice());
        }
        dot(&self.residual, &self.preconditioned)
    }
}

/// The inverse of a block; None where it is not positive definite, by Sylvester's criterion.
fn inverse(block: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    let minor = block[(0, 0)] * block[(1, 1)] - block[(0, 1)] * block[(1, 0)];
    let definite = block[(0, 0)] > 0.0 && minor > 0.0 && block.determinant() > 0.0;
    block.try_inverse().filter(|_| definite)
}

/// The dot product in four running sums, which gives the same bits on every machine.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    for (a, b) in a.chunks(4).zip(b.chunks(4)) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += a * b;
        }
    }
    sums.iter().sum()
}
