//! Square sparse matrices by rows.

use faer::Mat;
use std::cmp::Ordering;

/// n by n, rows one after the other, columns ascending within a row.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Matrix {
    starts: Vec<usize>,
    columns: Vec<usize>,
    values: Vec<f64>,
}

impl Matrix {
    /// Repeated places add up, in the order given.
    pub(super) fn new(n: usize, mut entries: Vec<(usize, usize, f64)>) -> Self {
        entries.sort_by_key(|&(row, column, _)| (row, column));
        entries.dedup_by(|next, kept| {
            let same = (next.0, next.1) == (kept.0, kept.1);
            if same {
                kept.2 += next.2;
            }
            same
        });
        Self {
            starts: (0..=n)
                .map(|row| entries.partition_point(|entry| entry.0 < row))
                .collect(),
            columns: entries.iter().map(|entry| entry.1).collect(),
            values: entries.iter().map(|entry| entry.2).collect(),
        }
    }

    pub(super) fn n(&self) -> usize {
        self.starts.len() - 1
    }

    pub(super) fn entries(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        (0..self.n()).flat_map(move |row| {
            let places = self.starts[row]..self.starts[row + 1];
            places.map(move |at| (row, self.columns[at], self.values[at]))
        })
    }

    /// By the number of their entries, then by these in turn.
    pub(super) fn order(&self, other: &Self) -> Ordering {
        let lengths = self.values.len().cmp(&other.values.len());
        lengths.then_with(|| {
            let values = self.values.partial_cmp(&other.values);
            values.unwrap_or(Ordering::Equal)
        })
    }

    /// The entry at this place, 0 where there is none.
    pub(super) fn at(&self, row: usize, column: usize) -> f64 {
        let places = self.starts[row]..self.starts[row + 1];
        let found = self.columns[places.clone()].binary_search(&column);
        found.map_or(0.0, |at| self.values[places.start + at])
    }

    /// The part of it over these coordinates, renumbered 0, 1, ... by `place`.
    pub(super) fn part(&self, coordinates: &[usize], place: &[usize]) -> Self {
        let mut entries = Vec::new();
        for (row, &coordinate) in coordinates.iter().enumerate() {
            for at in self.starts[coordinate]..self.starts[coordinate + 1] {
                entries.push((row, place[self.columns[at]], self.values[at]));
            }
        }
        Self::new(coordinates.len(), entries)
    }

    /// a A + b B.
    pub(super) fn combined(&self, a: f64, other: &Self, b: f64) -> Self {
        let ours = self.entries().map(|(row, column, v)| (row, column, a * v));
        let theirs = other.entries().map(|(row, column, v)| (row, column, b * v));
        Self::new(self.n(), ours.chain(theirs).collect())
    }

    fn transposed(&self) -> Self {
        let turned = self.entries().map(|(row, column, v)| (column, row, v));
        Self::new(self.n(), turned.collect())
    }

    pub(super) fn symmetric_part(&self) -> Self {
        self.combined(0.5, &self.transposed(), 0.5)
    }

    /// Largest |A - Aᵀ|.
    pub(super) fn skewness(&self) -> f64 {
        let difference = self.combined(1.0, &self.transposed(), -1.0);
        difference.values.iter().fold(0.0, |m, v| m.max(v.abs()))
    }

    /// Largest sum of magnitudes in a row: no eigenvalue is larger.
    pub(super) fn norm(&self) -> f64 {
        let rows = self.starts.windows(2);
        let sums = rows.map(|row| self.values[row[0]..row[1]].iter().map(|v| v.abs()).sum());
        sums.fold(0.0, |largest: f64, sum: f64| largest.max(sum))
    }

    /// y = A x.
    pub(super) fn product(&self, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        self.add_product(1.0, x, y);
    }

    /// y += a A x.
    pub(super) fn add_product(&self, a: f64, x: &[f64], y: &mut [f64]) {
        for (y, row) in y.iter_mut().zip(self.starts.windows(2)) {
            let mut sum = 0.0;
            for at in row[0]..row[1] {
                sum += self.values[at] * x[self.columns[at]];
            }
            *y += a * sum;
        }
    }

    /// xᵀ A x.
    pub(super) fn form(&self, x: &[f64]) -> f64 {
        let mut y = vec![0.0; x.len()];
        self.add_product(1.0, x, &mut y);
        dot(x, &y)
    }

    pub(super) fn dense(&self) -> Mat<f64> {
        let mut dense = Mat::zeros(self.n(), self.n());
        for (row, column, value) in self.entries() {
            dense[(row, column)] += value;
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
