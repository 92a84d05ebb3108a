//! The linear solve inside Newton: a dense LU for a few unknowns, sparse factors for many.

use super::super::StepError;
use super::sparse::{Entry, Sparse};
use crate::system::Jacobian;
use nalgebra::{DMatrix, DVector};

/// Up to this many free coordinates a dense factorisation is faster (measured).
const DENSE: usize = 60;

/// Solves (M - γ C - γ² K) z = r over the free coordinates; r and z have full length.
#[derive(Default)]
pub(super) struct Solver {
    /// Position of each coordinate among the free ones, or `FIXED`.
    place: Vec<usize>,
    free: Vec<usize>,
    /// The sparse matrix's entries, in the order they are emitted.
    matrix: Vec<Entry>,
    sparse: Option<Sparse>,
}

const FIXED: usize = usize::MAX;

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
        let mut matrix = std::mem::take(&mut self.matrix);
        matrix.clear();
        self.entries(inverse_mass, gamma, jacobian, |row, column, value| {
            matrix.push((row, column, value));
        });
        let mut sparse = match self.sparse.take() {
            Some(sparse) if sparse.fits(&matrix) => sparse,
            _ => Sparse::new(self.free.len(), &matrix)?,
        };
        let right: Vec<f64> = self.free.iter().map(|&at| r[at]).collect();
        let solved = sparse.solve(&matrix, &right);
        self.sparse = Some(sparse);
        self.matrix = matrix;
        solved
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
