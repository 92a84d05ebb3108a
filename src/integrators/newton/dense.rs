//! Dense factors, for a few unknowns.

use super::matrix::Matrix;
use nalgebra::{Cholesky, DMatrix, DVectorViewMut, Dyn};

/// L Lᵀ of the symmetric part.
#[derive(Default)]
pub(super) struct Dense {
    factor: Option<Cholesky<f64, Dyn>>,
}

impl Dense {
    /// False where the symmetric part is not positive definite.
    pub(super) fn factorise(&mut self, matrix: &Matrix) -> bool {
        let n = matrix.size();
        // The memory of the last factor.
        let mut entries = match self.factor.take() {
            Some(factor) => factor.unpack_dirty(),
            None => DMatrix::zeros(n, n),
        };
        if entries.nrows() != n {
            entries = DMatrix::zeros(n, n);
        }
        entries.fill(0.0);
        for column in 0..matrix.diagonal.len() {
            let diagonal = matrix.symmetric_diagonal(column);
            entries
                .fixed_view_mut::<3, 3>(3 * column, 3 * column)
                .copy_from(&diagonal);
            let (range, rows) = matrix.below(column);
            for (at, &row) in range.zip(rows) {
                let block = matrix.symmetric_lower(at);
                entries
                    .fixed_view_mut::<3, 3>(3 * row as usize, 3 * column)
                    .copy_from(&block);
            }
        }
        self.factor = Cholesky::new(entries);
        self.factor.is_some()
    }

    pub(super) fn solve(&self, z: &mut [f64]) {
        if let Some(factor) = &self.factor {
            let n = z.len();
            factor.solve_mut(&mut DVectorViewMut::from_slice(z, n));
        }
    }
}

/// Solves with an LU of the matrix itself; false where it is singular.
pub(super) fn solve_lu(matrix: &Matrix, z: &mut [f64]) -> bool {
    let n = matrix.size();
    if n == 0 {
        // All fixed: nalgebra's LU does not take it.
        return true;
    }
    let mut entries = DMatrix::zeros(n, n);
    matrix.for_each(|row, column, value| entries[(row, column)] += value);
    entries
        .lu()
        .solve_mut(&mut DVectorViewMut::from_slice(z, n))
}
