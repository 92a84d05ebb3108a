//! The linear solve inside Newton: dense LU for a few unknowns, sparse LU with a kept pattern for
//! many. LU, not Cholesky: dampers make the matrix unsymmetric, compressed springs indefinite.

use super::super::StepError;
use crate::system::Jacobian;
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Lu, SymbolicLu};
use faer::sparse::{Argsort, Pair, SparseColMat, SymbolicSparseColMat};
use nalgebra::{DMatrix, DVector};

/// Below this many free coordinates a dense factorisation is faster (measured: about 60).
const DENSE: usize = 60;

/// Solves (M - γ C - γ² K) z = r over the free coordinates; r and z have full length.
#[derive(Default)]
pub(super) struct Solver {
    /// Position of each coordinate among the free ones, or `FIXED`.
    place: Vec<usize>,
    free: Vec<usize>,
    /// The sparse entries' values, in the order they are emitted.
    values: Vec<f64>,
    sparse: Option<Sparse>,
}

const FIXED: usize = usize::MAX;

/// The sparse matrix's pattern and its symbolic factor, kept while the pattern stays.
struct Sparse {
    /// Emitted entries, repeated places included.
    entries: usize,
    pattern: SymbolicSparseColMat<usize>,
    order: Argsort<usize>,
    symbolic: SymbolicLu<usize>,
}

impl Solver {
    pub(super) fn solve(
        &mut self,
        inverse_mass: &[f64],
        gamma: f64,
        jacobian: &Jacobian,
        r: &mut [f64],
    ) -> Result<(), StepError> {
        if self.place.len() != inverse_mass.len() {
            self.index(inverse_mass);
        }
        if self.free.is_empty() {
            return Ok(());
        }
        let solution = if self.free.len() <= DENSE {
            self.solve_dense(inverse_mass, gamma, jacobian, r)?
        } else {
            self.solve_sparse(inverse_mass, gamma, jacobian, r)?
        };
        for (&at, z) in self.free.iter().zip(solution) {
            r[at] = z;
        }
        Ok(())
    }

    fn index(&mut self, inverse_mass: &[f64]) {
        self.free = (0..inverse_mass.len())
            .filter(|&i| inverse_mass[i] > 0.0)
            .collect();
        self.place = vec![FIXED; inverse_mass.len()];
        for (place, &at) in self.free.iter().enumerate() {
            self.place[at] = place;
        }
        self.sparse = None;
    }

    fn solve_dense(
        &mut self,
        inverse_mass: &[f64],
        gamma: f64,
        jacobian: &Jacobian,
        r: &[f64],
    ) -> Result<Vec<f64>, StepError> {
        let n = self.free.len();
        let mut matrix = DMatrix::zeros(n, n);
        self.entries(inverse_mass, gamma, jacobian, |row, column, value| {
            matrix[(row, column)] += value;
        });
        let mut z = DVector::from_iterator(n, self.free.iter().map(|&at| r[at]));
        if !matrix.lu().solve_mut(&mut z) {
            return Err(StepError::Singular);
        }
        Ok(z.data.into())
    }

    fn solve_sparse(
        &mut self,
        inverse_mass: &[f64],
        gamma: f64,
        jacobian: &Jacobian,
        r: &[f64],
    ) -> Result<Vec<f64>, StepError> {
        let mut values = std::mem::take(&mut self.values);
        values.clear();
        self.entries(inverse_mass, gamma, jacobian, |_, _, value| {
            values.push(value);
        });
        // The pattern is a promise of `System::jacobian`; its length is checked, its places are not.
        let sparse = match self.sparse.take() {
            Some(sparse) if sparse.entries == values.len() => sparse,
            _ => {
                let mut places = Vec::with_capacity(values.len());
                self.entries(inverse_mass, gamma, jacobian, |row, col, _| {
                    places.push(Pair { row, col });
                });
                Sparse::new(self.free.len(), &places)?
            }
        };
        let mut z = faer::Col::<f64>::from_fn(self.free.len(), |i| r[self.free[i]]);
        let solved = sparse.solve(&values, &mut z);
        self.sparse = Some(sparse);
        self.values = values;
        solved.map(|()| z.iter().copied().collect())
    }

    /// Every entry of the matrix as (row, column, value) among the free coordinates, in an order
    /// that depends on the pattern alone.
    fn entries(
        &self,
        inverse_mass: &[f64],
        gamma: f64,
        jacobian: &Jacobian,
        mut entry: impl FnMut(usize, usize, f64),
    ) {
        for (place, &at) in self.free.iter().enumerate() {
            entry(place, place, 1.0 / inverse_mass[at]);
        }
        for (triplets, factor) in [
            (&jacobian.velocity, -gamma),
            (&jacobian.position, -gamma * gamma),
        ] {
            for &(row, column, value) in triplets {
                let (row, column) = (self.place[row], self.place[column]);
                if row != FIXED && column != FIXED {
                    entry(row, column, factor * value);
                }
            }
        }
    }
}

impl Sparse {
    fn new(n: usize, places: &[Pair<usize, usize>]) -> Result<Self, StepError> {
        let (pattern, order) = SymbolicSparseColMat::try_new_from_indices(n, n, places)
            .map_err(|_| StepError::Singular)?;
        let symbolic = SymbolicLu::try_new(pattern.as_ref()).map_err(|_| StepError::Singular)?;
        Ok(Self {
            entries: places.len(),
            pattern,
            order,
            symbolic,
        })
    }

    fn solve(&self, values: &[f64], z: &mut faer::Col<f64>) -> Result<(), StepError> {
        let matrix = SparseColMat::new_from_argsort(self.pattern.clone(), &self.order, values)
            .map_err(|_| StepError::Singular)?;
        let lu = Lu::try_new_with_symbolic(self.symbolic.clone(), matrix.as_ref())
            .map_err(|_| StepError::Singular)?;
        lu.solve_in_place(z.as_mut());
        Ok(())
    }
}
