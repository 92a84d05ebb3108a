//! The matrix M - γ C - γ² K in blocks of 3 x 3, with a kept pattern.
//!
//! Where each piece of a Jacobian goes is looked up once ([`Pattern`]); after that, assembling is one
//! pass that adds.

use super::pattern::{Pattern, Place};
use crate::physics::{Jacobian, PairBlock, Slope};
use nalgebra::Matrix3;

/// Rows and columns are coordinates in threes, one block a particle, those without a free coordinate
/// left out. A fixed coordinate in a block with free ones, or one that pads the last block, is a row
/// and column of the identity.
#[derive(Default)]
pub(super) struct Matrix {
    pattern: Pattern,
    /// A_jj.
    pub diagonal: Vec<Matrix3<f64>>,
    /// A_ij below the diagonal, column by column, rows ascending.
    pub lower: Vec<Matrix3<f64>>,
    /// A_ji of the same places; as long as `lower` in an unsymmetric matrix, else empty.
    pub upper: Vec<Matrix3<f64>>,
}

impl Matrix {
    /// Rows, a multiple of three.
    pub(super) fn size(&self) -> usize {
        3 * self.diagonal.len()
    }

    pub(super) fn is_symmetric(&self) -> bool {
        self.upper.is_empty()
    }

    /// Rows and values of the blocks below the diagonal in a column of blocks.
    #[inline(always)]
    pub(super) fn below(&self, column: usize) -> (std::ops::Range<usize>, &[u32]) {
        let range = self.pattern.starts[column]..self.pattern.starts[column + 1];
        (range.clone(), &self.pattern.rows[range])
    }

    /// The coordinates of each block's rows, `usize::MAX` for those that stand for none.
    pub(super) fn coordinates(&self) -> &[usize] {
        &self.pattern.coordinates
    }

    /// Overwrites it with the matrix of this Jacobian. Returns whether the pattern is a new one.
    pub(super) fn assemble(
        &mut self,
        inverse_mass: &[f64],
        gamma: f64,
        jacobian: &Jacobian,
    ) -> bool {
        let kept = self.pattern.fits(inverse_mass, jacobian);
        if !kept {
            self.pattern = Pattern::new(inverse_mass, jacobian);
        }
        let blocks = self.pattern.coordinates.len() / 3;
        self.diagonal.clear();
        self.diagonal.resize(blocks, Matrix3::zeros());
        self.lower.clear();
        self.lower.resize(self.pattern.rows.len(), Matrix3::zeros());
        self.upper.clear();
        let slopes = [(Slope::Velocity, -gamma), (Slope::Position, -gamma * gamma)];
        let skew = slopes.iter().any(|&(by, _)| {
            let skew = |pair: &PairBlock| !is_symmetric(&pair.block);
            jacobian.pairs(by).iter().any(skew)
                || jacobian.triplets(by).iter().any(|(r, c, _)| r != c)
        });
        if skew {
            self.upper.resize(self.lower.len(), Matrix3::zeros());
        }
        for (row, &at) in self.pattern.coordinates.iter().enumerate() {
            if let Some(&w) = inverse_mass.get(at).filter(|w| **w > 0.0) {
                self.diagonal[row / 3][(row % 3, row % 3)] = 1.0 / w;
            }
        }
        for (by, factor) in slopes {
            let places = &self.pattern.slopes[by as usize];
            for (place, pair) in places.pairs.iter().zip(jacobian.pairs(by)) {
                let block = pair.block * factor;
                for end in place.ends {
                    if let Some(diagonal) = self.diagonal.get_mut(end as usize) {
                        *diagonal -= block;
                    }
                }
                if let Some(lower) = self.lower.get_mut(place.off as usize) {
                    *lower += block;
                    if let Some(upper) = self.upper.get_mut(place.off as usize) {
                        *upper += block;
                    }
                }
            }
            for (&place, &(.., value)) in places.triplets.iter().zip(jacobian.triplets(by)) {
                let value = factor * value;
                match place {
                    Place::Diagonal(at, cell) => self.diagonal[at as usize][cell] += value,
                    Place::Lower(at, cell) => self.lower[at as usize][cell] += value,
                    Place::Upper(at, cell) => self.upper[at as usize][cell] += value,
                    Place::Nowhere => {}
                }
            }
        }
        self.pin();
        if skew
            && self.diagonal.iter().all(is_symmetric)
            && (self.lower.iter().zip(&self.upper)).all(|(l, u)| *l == u.transpose())
        {
            self.upper.clear();
        }
        !kept
    }

    fn pin(&mut self) {
        if self.pattern.pinned.is_empty() {
            return;
        }
        for &row in &self.pattern.pinned {
            let block = &mut self.diagonal[row / 3];
            block.row_mut(row % 3).fill(0.0);
            block.column_mut(row % 3).fill(0.0);
            block[(row % 3, row % 3)] = 1.0;
        }
        let pinned = &self.pattern.pinned;
        for column in 0..self.diagonal.len() {
            for at in self.pattern.starts[column]..self.pattern.starts[column + 1] {
                let row = self.pattern.rows[at] as usize;
                for axis in 0..3 {
                    let rows = pinned.binary_search(&(3 * row + axis)).is_ok();
                    let columns = pinned.binary_search(&(3 * column + axis)).is_ok();
                    if rows {
                        self.lower[at].row_mut(axis).fill(0.0);
                    }
                    if columns {
                        self.lower[at].column_mut(axis).fill(0.0);
                    }
                    if let Some(upper) = self.upper.get_mut(at) {
                        if rows {
                            upper.column_mut(axis).fill(0.0);
                        }
                        if columns {
                            upper.row_mut(axis).fill(0.0);
                        }
                    }
                }
            }
        }
    }

    /// Adds `shift` times the masses to the diagonal.
    pub(super) fn add_masses(&mut self, shift: f64, inverse_mass: &[f64]) {
        for (row, &at) in self.pattern.coordinates.iter().enumerate() {
            if let Some(&w) = inverse_mass.get(at).filter(|w| **w > 0.0) {
                self.diagonal[row / 3][(row % 3, row % 3)] += shift / w;
            }
        }
    }

    /// The symmetric part's blocks: on the diagonal, and below it.
    pub(super) fn symmetric_diagonal(&self, at: usize) -> Matrix3<f64> {
        if self.upper.is_empty() {
            self.diagonal[at]
        } else {
            symmetric(&self.diagonal[at])
        }
    }

    #[inline(always)]
    pub(super) fn symmetric_lower(&self, at: usize) -> Matrix3<f64> {
        match self.upper.get(at) {
            Some(upper) => (self.lower[at] + upper.transpose()) * 0.5,
            None => self.lower[at],
        }
    }

    /// out = A z.
    pub(super) fn product(&self, z: &[f64], out: &mut [f64]) {
        if self.upper.is_empty() {
            self.symmetric_product(z, out);
        } else {
            let blocks = |at: usize| (self.lower[at], self.upper[at]);
            self.by_columns(z, out, |at| self.diagonal[at], blocks);
        }
    }

    /// out = ½ (A + Aᵀ) z.
    pub(super) fn symmetric_product(&self, z: &[f64], out: &mut [f64]) {
        if self.upper.is_empty() {
            let blocks = |at: usize| (self.lower[at], self.lower[at].transpose());
            self.by_columns(z, out, |at| self.diagonal[at], blocks);
        } else {
            let blocks = |at: usize| {
                let lower = self.symmetric_lower(at);
                (lower, lower.transpose())
            };
            self.by_columns(z, out, |at| self.symmetric_diagonal(at), blocks);
        }
    }

    #[inline(always)]
    fn by_columns(
        &self,
        z: &[f64],
        out: &mut [f64],
        diagonal: impl Fn(usize) -> Matrix3<f64>,
        blocks: impl Fn(usize) -> (Matrix3<f64>, Matrix3<f64>),
    ) {
        out.fill(0.0);
        for column in 0..self.diagonal.len() {
            let here = three(z, column);
            let mut sum = diagonal(column) * here;
            let (range, rows) = self.below(column);
            for (at, &row) in range.zip(rows) {
                let (below, above) = blocks(at);
                let row = row as usize;
                sum += above * three(z, row);
                let other = below * here;
                let out = &mut out[3 * row..3 * row + 3];
                out[0] += other[0];
                out[1] += other[1];
                out[2] += other[2];
            }
            let out = &mut out[3 * column..3 * column + 3];
            out[0] += sum[0];
            out[1] += sum[1];
            out[2] += sum[2];
        }
    }

    /// Every entry (row, column, value), in an order that depends on the pattern alone.
    pub(super) fn for_each(&self, mut entry: impl FnMut(usize, usize, f64)) {
        let mut whole = |i: usize, j: usize, block: &Matrix3<f64>| {
            for c in 0..3 {
                for r in 0..3 {
                    entry(3 * i + r, 3 * j + c, block[(r, c)]);
                }
            }
        };
        for (column, diagonal) in self.diagonal.iter().enumerate() {
            whole(column, column, diagonal);
            let (range, rows) = self.below(column);
            for (at, &row) in range.zip(rows) {
                let upper = match self.upper.get(at) {
                    Some(upper) => *upper,
                    None => self.lower[at].transpose(),
                };
                whole(row as usize, column, &self.lower[at]);
                whole(column, row as usize, &upper);
            }
        }
    }
}

#[inline(always)]
pub(super) fn three(z: &[f64], block: usize) -> nalgebra::Vector3<f64> {
    let z = &z[3 * block..3 * block + 3];
    nalgebra::Vector3::new(z[0], z[1], z[2])
}

fn symmetric(block: &Matrix3<f64>) -> Matrix3<f64> {
    (block + block.transpose()) * 0.5
}

fn is_symmetric(block: &Matrix3<f64>) -> bool {
    block[(0, 1)] == block[(1, 0)]
        && block[(0, 2)] == block[(2, 0)]
        && block[(1, 2)] == block[(2, 1)]
}
