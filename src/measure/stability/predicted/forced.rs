//! Motion that feels no force, taken out before eigenvalues are looked for.
//!
//! Where nothing restores and nothing damps (free rigid motion, springs at rest length that turn, motion
//! across slack springs), 0 is a double eigenvalue of (x, v)' = (v, -K x - C v) with one eigenvector.
//! Rounding parts the two by its root, and one of them then looks like a mode that grows. So ranks decide
//! what is zero, not eigenvalues.

use super::part::{Matrix, Part};
use faer::Mat;

impl Part {
    /// The part over the directions in which some force acts, and how many directions that leaves out; None
    /// where it leaves out none, or where the ranks are not found.
    ///
    /// With w orthogonal to every column of K, C and K', wᵀ v never changes: the eigenvalues are those of what
    /// is left, and 0 twice. What is left may be symmetric where the whole is not: dampers couple a motion
    /// across a slack spring to the one along it, and nothing couples it back.
    pub fn forced(&self) -> Option<(Self, usize)> {
        let n = self.n();
        let matrices = [&self.stiffness, &self.damping, &self.material];
        // Of one size, so that one tolerance serves all.
        let scaled = matrices.map(|matrix| (matrix.dense(), matrix.norm()));
        let columns = Mat::from_fn(n, 3 * n, |i, j| {
            let (dense, norm) = &scaled[j / n];
            if *norm > 0.0 {
                dense[(i, j % n)] / norm
            } else {
                0.0
            }
        });
        let svd = columns.thin_svd().ok()?;
        let values = svd.S().column_vector();
        // Positions blur directions as they blur K. Without K that is not known, and of no matter to drag.
        let blurred = if self.stiffness.norm() > 0.0 {
            self.zero() / self.stiffness.norm()
        } else {
            0.0
        };
        let tolerance = blurred.max(rounding(n));
        let rank = (0..n).filter(|&i| values[i] > tolerance).count();
        if rank == n {
            return None;
        }
        let acting = svd.U().subcols(0, rank);
        let restricted = |matrix: &Matrix| {
            let dense = acting.transpose() * matrix.dense() * acting;
            let entries = (0..rank).flat_map(|i| (0..rank).map(move |j| (i, j)));
            Matrix::new(rank, entries.map(|(i, j)| (i, j, dense[(i, j)])))
        };
        // A product with the basis rounds all of K.
        let left = Self::new(matrices.map(restricted), 0.5 * self.zero(), self.copies);
        Some((left, n - rank))
    }

    /// An orthonormal basis of the displacements that change some force, as columns: the row space of K. None
    /// where its rank is not found.
    ///
    /// The other displacements change no velocity, so a step's map needs only these: each of the others is an
    /// eigenvalue 0 (of a map: 1) with nothing else in its block.
    pub fn felt(&self) -> Option<Mat<f64>> {
        let n = self.n();
        if self.stiffness.norm() == 0.0 {
            return Some(Mat::zeros(n, 0));
        }
        let svd = self.stiffness.dense().svd().ok()?;
        let values = svd.S().column_vector();
        let rank = (0..n).filter(|&i| values[i] > self.zero()).count();
        Some(svd.V().subcols(0, rank).to_owned())
    }

    /// Eigenvalues and singular values of K that are rounding of 0, 1/s².
    pub fn zero(&self) -> f64 {
        rounding(self.n()) * self.stiffness.norm() + 2.0 * self.rounding
    }
}

/// The relative error of the eigenvalues of a symmetric matrix of n rows.
fn rounding(n: usize) -> f64 {
    8.0 * n as f64 * f64::EPSILON
}
