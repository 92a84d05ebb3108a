//! The matrix M - γ C - γ² K in blocks of 3 x 3. A system emits the entries of its Jacobian in the same places
//! at every call, so the sparsity pattern is kept and the places of pairs are looked up once.

use super::worst_particle;
use crate::physics::{Derivative, Jacobian, PairBlock};
use nalgebra::{Matrix3, Vector3};
use std::cmp::Ordering;
use std::ops::Range;

/// Each block has three coordinates, those of a particle; particles without a free coordinate are left out. A
/// fixed coordinate in a block with free ones, or one that pads the last block, has a row and column of the
/// identity.
#[derive(Default)]
pub(super) struct Matrix {
    /// A_jj.
    pub diagonal: Vec<Matrix3<f64>>,
    /// A_ij below the diagonal, column by column, rows ascending.
    pub lower: Vec<Matrix3<f64>>,
    /// A_ji for the same places; empty where the matrix is symmetric.
    upper: Vec<Matrix3<f64>>,
    /// Whether the matrix is not symmetric. It need not have blocks off the diagonal for that: a magnetic field
    /// turns each particle for itself.
    skew: bool,
    pattern: Pattern,
}

/// The places of blocks, and the places to which the entries of a Jacobian go.
#[derive(Default)]
struct Pattern {
    /// Which coordinates are free.
    free: Vec<bool>,
    /// The block of each particle; `NOWHERE` without a free coordinate.
    blocks: Vec<usize>,
    /// The coordinate of each row, also where the row pads the last block.
    coordinates: Vec<usize>,
    /// Whether each row is one of the identity.
    pinned: Vec<bool>,
    /// The index at which each column of `lower` begins, and the end of the last.
    starts: Vec<usize>,
    /// The block row of each entry of `lower`.
    rows: Vec<u32>,
    /// The entries of ∂f/∂x, then those of ∂f/∂v.
    emitted: [Emitted; 2],
}

/// The places of the entries that a system emitted last.
#[derive(Default)]
struct Emitted {
    ends: Vec<[u32; 2]>,
    /// The index of each pair in `lower`; `NOWHERE` where an end is fixed.
    off: Vec<usize>,
    entries: Vec<(usize, usize)>,
}

const NOWHERE: usize = usize::MAX;
const BOTH: [Derivative; 2] = [Derivative::Position, Derivative::Velocity];

impl Pattern {
    /// Whether a Jacobian has this pattern: the same places in the same order.
    fn fits(&self, inverse_mass: &[f64], jacobian: &Jacobian) -> bool {
        let free = inverse_mass.iter().map(|w| *w > 0.0);
        free.eq(self.free.iter().copied())
            && BOTH.iter().all(|&by| {
                let emitted = &self.emitted[by as usize];
                let ends = jacobian.pairs(by).iter().map(|pair| &pair.ends);
                ends.eq(&emitted.ends) && entries(jacobian, by).eq(emitted.entries.iter().copied())
            })
    }

    fn new(inverse_mass: &[f64], jacobian: &Jacobian) -> Self {
        let free: Vec<bool> = inverse_mass.iter().map(|w| *w > 0.0).collect();
        let mut count = 0..;
        let place = |free: &[bool]| free.contains(&true).then(|| count.next()).flatten();
        let blocks: Vec<usize> = (free.chunks(3).map(place))
            .map(|block| block.unwrap_or(NOWHERE))
            .collect();
        let particles = (0..blocks.len()).filter(|&p| blocks[p] != NOWHERE);
        let coordinates: Vec<usize> = particles.flat_map(|p| 3 * p..3 * p + 3).collect();
        let pinned = coordinates.iter().map(|&at| free.get(at) != Some(&true));
        let mut pattern = Self {
            pinned: pinned.collect(),
            blocks,
            coordinates,
            free,
            ..Self::default()
        };
        // The blocks below the diagonal, column by column.
        let pairs = BOTH.iter().flat_map(|&by| jacobian.pairs(by));
        let pairs = pairs.map(|pair| pair.ends.map(|end| pattern.block(end as usize)));
        let entries_ = BOTH.iter().flat_map(|&by| entries(jacobian, by));
        let entries_ = entries_.map(|(r, c)| [r, c].map(|at| pattern.block(at / 3)));
        let mut below: Vec<(usize, usize)> = (pairs.chain(entries_))
            .filter(|&[i, j]| i != j && i != NOWHERE && j != NOWHERE)
            .map(|[i, j]| (i.min(j), i.max(j)))
            .collect();
        below.sort_unstable();
        below.dedup();
        pattern.starts = (0..=pattern.coordinates.len() / 3)
            .map(|column| below.partition_point(|&(c, _)| c < column))
            .collect();
        pattern.rows = below.iter().map(|&(_, row)| row as u32).collect();
        pattern.emitted = BOTH.map(|by| {
            let pairs = jacobian.pairs(by).iter();
            let blocks = |pair: &PairBlock| pair.ends.map(|end| pattern.block(end as usize));
            Emitted {
                ends: pairs.clone().map(|pair| pair.ends).collect(),
                off: pairs.map(|pair| pattern.off(blocks(pair))).collect(),
                entries: entries(jacobian, by).collect(),
            }
        });
        pattern
    }

    fn block(&self, particle: usize) -> usize {
        self.blocks.get(particle).copied().unwrap_or(NOWHERE)
    }

    /// The index in `lower` of the block that couples two blocks.
    fn off(&self, [i, j]: [usize; 2]) -> usize {
        let (column, row) = (i.min(j), i.max(j) as u32);
        let Some(&[start, end]) = self.starts.get(column..).and_then(|s| s.first_chunk()) else {
            return NOWHERE;
        };
        let found = self.rows[start..end].binary_search(&row);
        found.map_or(NOWHERE, |at| start + at)
    }
}

/// The places of a Jacobian's triplets.
fn entries(jacobian: &Jacobian, by: Derivative) -> impl Iterator<Item = (usize, usize)> {
    jacobian.triplets(by).iter().map(|&(r, c, _)| (r, c))
}

impl Matrix {
    /// The number of rows, a multiple of three.
    pub(super) fn size(&self) -> usize {
        3 * self.diagonal.len()
    }

    pub(super) fn is_symmetric(&self) -> bool {
        !self.skew
    }

    /// The indices in `lower` and the block rows of the blocks below the diagonal in a column.
    #[inline(always)]
    pub(super) fn below(&self, column: usize) -> (Range<usize>, &[u32]) {
        let range = self.pattern.starts[column]..self.pattern.starts[column + 1];
        (range.clone(), &self.pattern.rows[range])
    }

    /// Copies from coordinates to rows; rows that only pad are 0.
    pub(super) fn gather(&self, values: &[f64], rows: &mut Vec<f64>) {
        rows.clear();
        let coordinates = self.pattern.coordinates.iter();
        rows.extend(coordinates.map(|&at| values.get(at).copied().unwrap_or(0.0)));
    }

    /// Copies from rows to coordinates; coordinates without a row are 0.
    pub(super) fn scatter(&self, rows: &[f64], values: &mut [f64]) {
        values.fill(0.0);
        for (&at, row) in self.pattern.coordinates.iter().zip(rows) {
            if let Some(value) = values.get_mut(at) {
                *value = *row;
            }
        }
    }

    /// The particle with the largest entry.
    pub(super) fn worst(&self, rows: &[f64]) -> usize {
        let row = 3 * worst_particle(rows);
        self.pattern.coordinates.get(row).map_or(0, |at| at / 3)
    }

    /// The largest diagonal entry in units of its mass, at least 1.
    pub(super) fn stiffest(&self, inverse_mass: &[f64]) -> f64 {
        let mut stiffest = 1.0_f64;
        for (row, &at) in self.pattern.coordinates.iter().enumerate() {
            if let Some(w) = inverse_mass.get(at) {
                stiffest = stiffest.max(self.diagonal[row / 3][(row % 3, row % 3)] * w);
            }
        }
        stiffest
    }

    /// Overwrites it with the matrix of this Jacobian. Returns whether the pattern is new.
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
        let pattern = &self.pattern;
        let restart = |blocks: &mut Vec<Matrix3<f64>>, n: usize| {
            blocks.clear();
            blocks.resize(n, Matrix3::zeros());
        };
        restart(&mut self.diagonal, pattern.coordinates.len() / 3);
        restart(&mut self.lower, pattern.rows.len());
        let slopes = [
            (Derivative::Velocity, -gamma),
            (Derivative::Position, -gamma * gamma),
        ];
        let skew = BOTH.iter().any(|&by| {
            let skew = |pair: &PairBlock| !is_symmetric(&pair.block);
            jacobian.pairs(by).iter().any(skew) || entries(jacobian, by).any(|(r, c)| r != c)
        });
        restart(&mut self.upper, if skew { pattern.rows.len() } else { 0 });
        self.add_masses(1.0, inverse_mass);
        let pattern = &self.pattern;
        for (by, factor) in slopes {
            let off = &pattern.emitted[by as usize].off;
            for (pair, &off) in jacobian.pairs(by).iter().zip(off) {
                let block = pair.block * factor;
                for end in pair.ends {
                    if let Some(diagonal) = self.diagonal.get_mut(pattern.block(end as usize)) {
                        *diagonal -= block;
                    }
                }
                if let Some(lower) = self.lower.get_mut(off) {
                    *lower += block;
                    if let Some(upper) = self.upper.get_mut(off) {
                        *upper += block;
                    }
                }
            }
            for &(r, c, value) in jacobian.triplets(by) {
                let [i, j] = [r, c].map(|at| pattern.block(at / 3));
                let block = match i.cmp(&j) {
                    Ordering::Equal => self.diagonal.get_mut(i),
                    Ordering::Greater => self.lower.get_mut(pattern.off([i, j])),
                    Ordering::Less => self.upper.get_mut(pattern.off([i, j])),
                };
                if let Some(block) = block {
                    block[(r % 3, c % 3)] += factor * value;
                }
            }
        }
        self.pin();
        let mirrored = |(l, u): (&Matrix3<f64>, &Matrix3<f64>)| *l == u.transpose();
        self.skew = skew
            && !(self.diagonal.iter().all(is_symmetric)
                && self.lower.iter().zip(&self.upper).all(mirrored));
        if !self.skew {
            self.upper.clear();
        }
        !kept
    }

    /// Makes rows and columns of fixed coordinates those of the identity.
    fn pin(&mut self) {
        let Self {
            diagonal,
            lower,
            upper,
            pattern,
            ..
        } = self;
        if !pattern.pinned.contains(&true) {
            return;
        }
        for column in 0..diagonal.len() {
            for axis in (0..3).filter(|axis| pattern.pinned[3 * column + axis]) {
                clear_row(&mut diagonal[column], axis);
                clear_column(&mut diagonal[column], axis);
                diagonal[column][(axis, axis)] = 1.0;
            }
            for at in pattern.starts[column]..pattern.starts[column + 1] {
                let row = pattern.rows[at] as usize;
                for axis in 0..3 {
                    if pattern.pinned[3 * row + axis] {
                        clear_row(&mut lower[at], axis);
                        if let Some(upper) = upper.get_mut(at) {
                            clear_column(upper, axis);
                        }
                    }
                    if pattern.pinned[3 * column + axis] {
                        clear_column(&mut lower[at], axis);
                        if let Some(upper) = upper.get_mut(at) {
                            clear_row(upper, axis);
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

    /// A diagonal block of the symmetric part.
    pub(super) fn symmetric_diagonal(&self, at: usize) -> Matrix3<f64> {
        if self.is_symmetric() {
            self.diagonal[at]
        } else {
            symmetric(&self.diagonal[at])
        }
    }

    /// A block of the symmetric part below the diagonal.
    #[inline(always)]
    pub(super) fn symmetric_lower(&self, at: usize) -> Matrix3<f64> {
        match self.upper.get(at) {
            Some(upper) => (self.lower[at] + upper.transpose()) * 0.5,
            None => self.lower[at],
        }
    }

    /// out = A z.
    pub(super) fn product(&self, z: &[f64], out: &mut [f64]) {
        if self.is_symmetric() {
            self.symmetric_product(z, out);
        } else {
            let blocks = |at: usize| (self.lower[at], self.upper[at]);
            self.by_columns(z, out, |at| self.diagonal[at], blocks);
        }
    }

    /// out = ½ (A + Aᵀ) z.
    pub(super) fn symmetric_product(&self, z: &[f64], out: &mut [f64]) {
        if self.is_symmetric() {
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

    /// Visits every entry (row, column, value), in an order that depends on the pattern alone.
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
pub(super) fn three(z: &[f64], block: usize) -> Vector3<f64> {
    let z = &z[3 * block..3 * block + 3];
    Vector3::new(z[0], z[1], z[2])
}

fn clear_row(block: &mut Matrix3<f64>, axis: usize) {
    block.row_mut(axis).fill(0.0);
}

fn clear_column(block: &mut Matrix3<f64>, axis: usize) {
    block.column_mut(axis).fill(0.0);
}

fn symmetric(block: &Matrix3<f64>) -> Matrix3<f64> {
    (block + block.transpose()) * 0.5
}

fn is_symmetric(block: &Matrix3<f64>) -> bool {
    block[(0, 1)] == block[(1, 0)]
        && block[(0, 2)] == block[(2, 0)]
        && block[(1, 2)] == block[(2, 1)]
}
