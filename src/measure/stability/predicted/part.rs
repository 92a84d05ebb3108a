//! The mass-normalised matrices of coordinates that couple.

use faer::Mat;
use std::cmp::Ordering;

/// Coordinates that couple with each other and with no others, such as all x of a chain along x.
/// Scaled by the roots of the masses: K and C are symmetric where forces derive from a potential.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Part {
    /// K = -M^(-1/2) ∂f/∂x M^(-1/2), 1/s².
    pub stiffness: Matrix,
    /// C = -M^(-1/2) ∂f/∂v M^(-1/2), 1/s.
    pub damping: Matrix,
    /// K', as K but of springs along themselves only, 1/s².
    pub material: Matrix,
    /// Whether all three are symmetric.
    pub symmetric: bool,
    /// How far rounding of the positions moves K, 1/s²: lengths far from the origin are known no better.
    pub rounding: f64,
    /// How often it occurs.
    pub copies: usize,
}

impl Part {
    /// Matrices that are symmetric but for rounding are made so, and stiffnesses that are nothing but rounding 0:
    /// no rank or ratio can be read off them.
    pub fn new(mut matrices: [Matrix; 3], rounding: f64, copies: usize) -> Self {
        for at in [0, 2] {
            if matrices[at].norm() <= 2.0 * rounding {
                matrices[at] = Matrix::new(matrices[at].n(), []);
            }
        }
        let mut symmetric = true;
        let [stiffness, damping, material] = matrices.map(|matrix| {
            if matrix.skewness() <= SYMMETRIC * matrix.norm() {
                matrix.symmetric_part()
            } else {
                symmetric = false;
                matrix
            }
        });
        Self {
            stiffness,
            damping,
            material,
            symmetric,
            rounding,
            copies,
        }
    }

    pub fn n(&self) -> usize {
        self.stiffness.n()
    }

    pub fn matrices(&self) -> [&Matrix; 3] {
        [&self.stiffness, &self.damping, &self.material]
    }

    /// Orders parts, the largest first.
    pub fn order(&self, other: &Self) -> Ordering {
        let matrices = self.matrices().into_iter().zip(other.matrices());
        let sizes = other.n().cmp(&self.n());
        matrices.fold(sizes, |order, (a, b)| order.then_with(|| a.order(b)))
    }
}

/// Entries of sums of a few forces agree with their mirror images to a few roundings.
pub(super) const SYMMETRIC: f64 = 1e-13;

/// A square sparse matrix: the columns of each row, ascending, and their entries.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Matrix {
    pub rows: Vec<Vec<(usize, f64)>>,
}

impl Matrix {
    /// A matrix of these entries; repeated places add up, in the order given.
    pub fn new(n: usize, entries: impl IntoIterator<Item = (usize, usize, f64)>) -> Self {
        let mut rows = vec![Vec::new(); n];
        for (row, column, value) in entries {
            rows[row].push((column, value));
        }
        for row in &mut rows {
            row.sort_by_key(|&(column, _)| column);
            row.dedup_by(|next, kept| {
                let same = next.0 == kept.0;
                if same {
                    kept.1 += next.1;
                }
                same
            });
        }
        Self { rows }
    }

    pub fn n(&self) -> usize {
        self.rows.len()
    }

    pub fn entries(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        let rows = self.rows.iter().enumerate();
        rows.flat_map(|(row, entries)| entries.iter().map(move |&(column, v)| (row, column, v)))
    }

    /// Orders matrices by the number of their entries, then by these in turn.
    pub fn order(&self, other: &Self) -> Ordering {
        let values = |m: &Self| -> Vec<f64> { m.entries().map(|(.., value)| value).collect() };
        let (own, others) = (values(self), values(other));
        let values = own.partial_cmp(&others).unwrap_or(Ordering::Equal);
        own.len().cmp(&others.len()).then(values)
    }

    /// The entry at this place, 0 where there is none.
    pub fn at(&self, row: usize, column: usize) -> f64 {
        let found = self.rows[row].iter().find(|entry| entry.0 == column);
        found.map_or(0.0, |entry| entry.1)
    }

    /// The part of it over these coordinates, ascending, which couple with no others; `place` numbers
    /// them 0, 1, ... .
    pub fn part(&self, coordinates: &[usize], place: &[usize]) -> Self {
        let renumbered = |&(column, value): &(usize, f64)| (place[column], value);
        let row = |&row: &usize| self.rows[row].iter().map(renumbered).collect();
        Self {
            rows: coordinates.iter().map(row).collect(),
        }
    }

    /// a A + b B.
    pub fn combined(&self, a: f64, other: &Self, b: f64) -> Self {
        let ours = self.entries().map(|(row, column, v)| (row, column, a * v));
        let theirs = other.entries().map(|(row, column, v)| (row, column, b * v));
        Self::new(self.n(), ours.chain(theirs))
    }

    fn transposed(&self) -> Self {
        let turned = self.entries().map(|(row, column, v)| (column, row, v));
        Self::new(self.n(), turned)
    }

    pub fn symmetric_part(&self) -> Self {
        self.combined(0.5, &self.transposed(), 0.5)
    }

    /// Largest |A - Aᵀ|.
    pub fn skewness(&self) -> f64 {
        let difference = self.combined(1.0, &self.transposed(), -1.0);
        difference.entries().fold(0.0, |m, (.., v)| m.max(v.abs()))
    }

    /// Largest sum of magnitudes in a row: no eigenvalue is larger.
    pub fn norm(&self) -> f64 {
        let sum = |row: &Vec<(usize, f64)>| row.iter().map(|(_, v)| v.abs()).sum();
        self.rows.iter().map(sum).fold(0.0, f64::max)
    }

    /// y = A x.
    pub fn product(&self, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        self.add_product(1.0, x, y);
    }

    /// y += a A x.
    pub fn add_product(&self, a: f64, x: &[f64], y: &mut [f64]) {
        for (y, row) in y.iter_mut().zip(&self.rows) {
            let mut sum = 0.0;
            for &(column, value) in row {
                sum += value * x[column];
            }
            *y += a * sum;
        }
    }

    /// xᵀ A x.
    pub fn form(&self, x: &[f64]) -> f64 {
        let mut y = vec![0.0; x.len()];
        self.add_product(1.0, x, &mut y);
        dot(x, &y)
    }

    pub fn dense(&self) -> Mat<f64> {
        let mut dense = Mat::zeros(self.n(), self.n());
        for (row, column, value) in self.entries() {
            dense[(row, column)] = value;
        }
        dense
    }
}

pub(super) fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

pub(super) fn norm(x: &[f64]) -> f64 {
    dot(x, x).sqrt()
}
