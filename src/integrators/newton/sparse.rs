//! Sparse solves with kept patterns: Cholesky of the symmetric part, refined against the matrix
//! itself; LU where that does not converge.
//!
//! Springs make the matrix symmetric, and positive definite unless they are compressed; the turning
//! of dampers adds an unsymmetric part that is small beside the masses at any sensible step. So a
//! Cholesky factor is nearly always a few times cheaper than LU, and as exact.

use super::super::{StepError, largest};
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Llt, Lu, SymbolicLlt, SymbolicLu};
use faer::sparse::{Argsort, Pair, SparseColMat, SymbolicSparseColMat};
use faer::{Col, Side};

/// A matrix entry: row, column, value; repeated places add up.
pub(super) type Entry = (usize, usize, f64);

/// Refinements before LU takes over; each gains the digits the symmetric part has right.
const REFINEMENTS: usize = 8;
/// Residual of a refined solve, relative to the right side in the largest norm: a few last bits.
const REFINED: f64 = 4.0 * f64::EPSILON;

/// Solves n by n systems whose entries come in the same places every time.
pub(super) struct Sparse {
    n: usize,
    /// Emitted entries, repeated places included.
    entries: usize,
    lower: Pattern<SymbolicLlt<usize>>,
    /// Made when it is first needed.
    full: Option<Pattern<SymbolicLu<usize>>>,
    values: Vec<f64>,
}

/// Where entries go, and the symbolic factor of that.
struct Pattern<S> {
    places: SymbolicSparseColMat<usize>,
    order: Argsort<usize>,
    symbolic: S,
}

impl<S> Pattern<S> {
    fn new(
        n: usize,
        places: impl Iterator<Item = (usize, usize)>,
        symbolic: impl FnOnce(&SymbolicSparseColMat<usize>) -> Option<S>,
    ) -> Result<Self, StepError> {
        let pairs: Vec<_> = places.map(|(row, col)| Pair { row, col }).collect();
        let (places, order) = SymbolicSparseColMat::try_new_from_indices(n, n, &pairs)
            .map_err(|_| StepError::Singular)?;
        let symbolic = symbolic(&places).ok_or(StepError::Singular)?;
        Ok(Self {
            places,
            order,
            symbolic,
        })
    }

    fn matrix(&self, values: &[f64]) -> Option<SparseColMat<usize, f64>> {
        SparseColMat::new_from_argsort(self.places.clone(), &self.order, values).ok()
    }
}

impl Sparse {
    pub(super) fn new(n: usize, entries: &[Entry]) -> Result<Self, StepError> {
        let lower = entries.iter().map(|&(row, column, _)| folded(row, column));
        Ok(Self {
            n,
            entries: entries.len(),
            lower: Pattern::new(n, lower, |places| {
                SymbolicLlt::try_new(places.as_ref(), Side::Lower).ok()
            })?,
            full: None,
            values: Vec::new(),
        })
    }

    /// Whether it was made for that many entries; that their places are the same is a promise of
    /// [`System::jacobian`](crate::system::System::jacobian).
    pub(super) fn fits(&self, entries: &[Entry]) -> bool {
        self.entries == entries.len()
    }

    /// Solves with right side `r` of length n.
    pub(super) fn solve(&mut self, entries: &[Entry], r: &[f64]) -> Result<Vec<f64>, StepError> {
        match self.by_cholesky(entries, r) {
            Some(z) => Ok(z),
            None => self.by_lu(entries, r),
        }
    }

    /// None where the symmetric part is not positive definite, or not the greater part.
    fn by_cholesky(&mut self, entries: &[Entry], r: &[f64]) -> Option<Vec<f64>> {
        self.values.clear();
        // Both triangles fold onto the lower one, each with half its value.
        self.values.extend(
            entries
                .iter()
                .map(|&(row, column, value)| if row == column { value } else { 0.5 * value }),
        );
        let matrix = self.lower.matrix(&self.values)?;
        let symbolic = self.lower.symbolic.clone();
        let factor = Llt::try_new_with_symbolic(symbolic, matrix.as_ref(), Side::Lower).ok()?;
        let size = largest(r);
        let mut z = vec![0.0; self.n];
        let mut left = Col::<f64>::from_fn(self.n, |i| r[i]);
        let mut before = f64::INFINITY;
        for _ in 0..REFINEMENTS {
            factor.solve_in_place(left.as_mut());
            for (z, correction) in z.iter_mut().zip(left.iter()) {
                *z += correction;
            }
            for (left, r) in left.iter_mut().zip(r) {
                *left = *r;
            }
            for &(row, column, value) in entries {
                left[row] -= value * z[column];
            }
            let off = largest(left.iter());
            if off <= REFINED * size {
                return Some(z);
            }
            if off > 0.5 * before {
                // No longer shrinking: at rounding for this matrix, or not converging at all.
                return (off <= 1e-13 * size).then_some(z);
            }
            before = off;
        }
        None
    }

    fn by_lu(&mut self, entries: &[Entry], r: &[f64]) -> Result<Vec<f64>, StepError> {
        let full = match self.full.take() {
            Some(full) => full,
            None => {
                let places = entries.iter().map(|&(row, column, _)| (row, column));
                Pattern::new(self.n, places, |places| {
                    SymbolicLu::try_new(places.as_ref()).ok()
                })?
            }
        };
        self.values.clear();
        self.values
            .extend(entries.iter().map(|&(_, _, value)| value));
        let matrix = full.matrix(&self.values).ok_or(StepError::Singular)?;
        let lu = Lu::try_new_with_symbolic(full.symbolic.clone(), matrix.as_ref());
        self.full = Some(full);
        let mut z = Col::<f64>::from_fn(self.n, |i| r[i]);
        lu.map_err(|_| StepError::Singular)?
            .solve_in_place(z.as_mut());
        Ok(z.iter().copied().collect())
    }
}

/// A place in the lower triangle.
fn folded(row: usize, column: usize) -> (usize, usize) {
    (row.max(column), row.min(column))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Off by how much a solution is, relative to the right side.
    fn residual(entries: &[Entry], z: &[f64], r: &[f64]) -> f64 {
        let mut left = r.to_vec();
        for &(row, column, value) in entries {
            left[row] -= value * z[column];
        }
        largest(&left) / largest(r)
    }

    /// A tridiagonal matrix: `diagonal`, and 1 + `skew` above, 1 - `skew` below.
    fn tridiagonal(n: usize, diagonal: f64, skew: f64) -> Vec<Entry> {
        let mut entries: Vec<Entry> = (0..n).map(|i| (i, i, diagonal)).collect();
        for i in 1..n {
            entries.push((i - 1, i, 1.0 + skew));
            entries.push((i, i - 1, 1.0 - skew));
        }
        entries
    }

    #[test]
    fn both_ways_solve_what_they_take() {
        let n = 100;
        let r: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
        // Symmetric, slightly and strongly unsymmetric, indefinite.
        for (diagonal, skew, cholesky) in [
            (3.0, 0.0, true),
            (3.0, 1e-3, true),
            (3.0, 40.0, false),
            (-3.0, 0.0, false),
            (0.5, 0.0, false),
        ] {
            let entries = tridiagonal(n, diagonal, skew);
            let mut sparse = Sparse::new(n, &entries).unwrap();
            assert_eq!(
                sparse.by_cholesky(&entries, &r).is_some(),
                cholesky,
                "{diagonal} {skew}"
            );
            for _ in 0..2 {
                let z = sparse.solve(&entries, &r).unwrap();
                let off = residual(&entries, &z, &r);
                // Condition numbers below 200: a few tens of last bits.
                assert!(off < 1e-13, "{diagonal} {skew}: {off}");
            }
            // Half a refinement is no solution: the check of the residual is what makes it one.
            if skew > 0.0 {
                let wrong = tridiagonal(n, diagonal, 0.0);
                let z = sparse.solve(&wrong, &r).unwrap();
                assert!(residual(&entries, &z, &r) > 1e-5);
            }
        }
    }
}
