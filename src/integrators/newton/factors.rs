//! Factors of the matrix: dense for few unknowns, sparse with a kept pattern for many.

use super::StepError;
use super::matrix::Matrix;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::solvers::Solve;
use faer::prelude::{Col, MatMut, Par};
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::linalg::solvers::{Lu, SymbolicLu};
use faer::sparse::{
    Argsort, Pair, SparseColMat, SparseColMatRef, SymbolicSparseColMat, SymbolicSparseColMatRef,
};
use faer::{Conj, Side};
use nalgebra::{Cholesky, DMatrix, DVectorViewMut, Dyn};

/// The dense Cholesky factor L Lᵀ of the symmetric part.
#[derive(Default)]
pub(super) struct Dense {
    factor: Option<Cholesky<f64, Dyn>>,
}

impl Dense {
    /// Factorises; false where the symmetric part is not positive definite.
    pub(super) fn factorise(&mut self, matrix: &Matrix) -> bool {
        let n = matrix.size();
        // The memory of the last factor is reused.
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
pub(super) fn solve_dense_lu(matrix: &Matrix, z: &mut [f64]) -> bool {
    let n = matrix.size();
    if n == 0 {
        // nalgebra's LU does not accept a matrix without rows.
        return true;
    }
    let mut entries = DMatrix::zeros(n, n);
    matrix.for_each(|row, column, value| entries[(row, column)] += value);
    entries
        .lu()
        .solve_mut(&mut DVectorViewMut::from_slice(z, n))
}

/// The sparse Cholesky factor L Lᵀ of the symmetric part, for one pattern. Factors after the first need no
/// allocation.
pub(super) struct Sparse {
    symbolic: SymbolicCholesky<usize>,
    starts: Vec<usize>,
    rows: Vec<usize>,
    values: Vec<f64>,
    factor: Vec<f64>,
    memory: MemBuffer,
}

impl Sparse {
    /// Orders the unknowns (AMD) and lays out the factor.
    pub(super) fn new(matrix: &Matrix) -> Result<Self, StepError> {
        let n = matrix.size();
        let (mut starts, mut rows) = (vec![0], Vec::new());
        for column in 0..n {
            let (block, axis) = (column / 3, column % 3);
            rows.extend((axis..3).map(|r| 3 * block + r));
            for &row in matrix.below(block).1 {
                rows.extend((0..3).map(|r| 3 * row as usize + r));
            }
            starts.push(rows.len());
        }
        let places = SymbolicSparseColMatRef::new_checked(n, n, &starts, None, &rows);
        let ordering = SymmetricOrdering::Amd;
        // With blocks of three supernodes pay at any size: on cloths of 186 and 582 unknowns they take a half
        // and a third of the time of single columns.
        let blocked = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        };
        let symbolic = factorize_symbolic_cholesky(places, Side::Lower, ordering, blocked);
        let symbolic = symbolic.map_err(|_| StepError::Singular { particle: 0 })?;
        let scratch = symbolic
            .factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default())
            .or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        Ok(Self {
            values: vec![0.0; rows.len()],
            factor: vec![0.0; symbolic.len_val()],
            memory: MemBuffer::new(scratch),
            symbolic,
            starts,
            rows,
        })
    }

    /// The number of entries of the factor.
    pub(super) fn fill(&self) -> usize {
        self.symbolic.len_val()
    }

    /// Factorises; false where the symmetric part is not positive definite.
    pub(super) fn factorise(&mut self, matrix: &Matrix) -> bool {
        let n = matrix.size();
        for block in 0..matrix.diagonal.len() {
            let diagonal = matrix.symmetric_diagonal(block);
            let (range, _) = matrix.below(block);
            for axis in 0..3 {
                let mut at = self.starts[3 * block + axis];
                for r in axis..3 {
                    self.values[at] = diagonal[(r, axis)];
                    at += 1;
                }
                for place in range.clone() {
                    let lower = matrix.symmetric_lower(place);
                    for r in 0..3 {
                        self.values[at + r] = lower[(r, axis)];
                    }
                    at += 3;
                }
            }
        }
        let places = SymbolicSparseColMatRef::new_checked(n, n, &self.starts, None, &self.rows);
        self.symbolic
            .factorize_numeric_llt(
                &mut self.factor,
                SparseColMatRef::new(places, &self.values),
                Side::Lower,
                Default::default(),
                Par::Seq,
                MemStack::new(&mut self.memory),
                Default::default(),
            )
            .is_ok()
    }

    pub(super) fn solve(&mut self, z: &mut [f64]) {
        let n = z.len();
        LltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(z, n, 1),
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
    }
}

/// The sparse LU factorisation of the matrix itself.
pub(super) struct SparseLu {
    places: SymbolicSparseColMat<usize>,
    order: Argsort<usize>,
    symbolic: SymbolicLu<usize>,
}

impl SparseLu {
    /// None where the memory for it cannot be laid out.
    pub(super) fn new(matrix: &Matrix) -> Option<Self> {
        let n = matrix.size();
        let mut pairs = Vec::new();
        matrix.for_each(|row, col, _| pairs.push(Pair { row, col }));
        let (places, order) = SymbolicSparseColMat::try_new_from_indices(n, n, &pairs).ok()?;
        let symbolic = SymbolicLu::try_new(places.as_ref()).ok()?;
        Some(Self {
            places,
            order,
            symbolic,
        })
    }

    /// Factorises and solves; false where the matrix is singular.
    pub(super) fn solve(&self, matrix: &Matrix, z: &mut [f64]) -> bool {
        let mut values = Vec::new();
        matrix.for_each(|_, _, value| values.push(value));
        let places = self.places.clone();
        let Ok(entries) = SparseColMat::new_from_argsort(places, &self.order, &values) else {
            return false;
        };
        let Ok(lu) = Lu::try_new_with_symbolic(self.symbolic.clone(), entries.as_ref()) else {
            return false;
        };
        let mut solution = Col::<f64>::from_fn(z.len(), |i| z[i]);
        lu.solve_in_place(solution.as_mut());
        for (z, solution) in z.iter_mut().zip(solution.iter()) {
            *z = *solution;
        }
        true
    }
}
