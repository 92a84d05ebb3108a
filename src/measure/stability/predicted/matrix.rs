//! Square sparse matrices by rows.

use faer::Mat;

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
        let mut matrix = Self {
            starts: vec![0; n + 1],
            columns: Vec::new(),
            values: Vec::new(),
        };
        let mut last = None;
        for (row, column, value) in entries {
            if last == Some((row, column)) {
                if let Some(sum) = matrix.values.last_mut() {
                    *sum += value;
                }
            } else {
                matrix.columns.push(column);
                matrix.values.push(value);
                matrix.starts[row + 1] = matrix.values.len();
                last = Some((row, column));
            }
        }
        for row in 0..n {
            matrix.starts[row + 1] = matrix.starts[row + 1].max(matrix.starts[row]);
        }
        matrix
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

    pub(super) fn values(&self) -> &[f64] {
        &self.values
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

    pub(super) fn symmetric_part(&self) -> Self {
        let half = self
            .entries()
            .map(|(row, column, v)| (row, column, 0.5 * v));
        let turned = self
            .entries()
            .map(|(row, column, v)| (column, row, 0.5 * v));
        Self::new(self.n(), half.chain(turned).collect())
    }

    /// Largest |A - Aᵀ|.
    pub(super) fn skewness(&self) -> f64 {
        let off = self
            .entries()
            .map(|(row, column, v)| (v - self.at(column, row)).abs());
        off.fold(0.0, f64::max)
    }

    /// Largest sum of magnitudes in a row: no eigenvalue is larger.
    pub(super) fn norm(&self) -> f64 {
        let rows = self.starts.windows(2);
        let sums = rows.map(|row| self.values[row[0]..row[1]].iter().map(|v| v.abs()).sum());
        sums.fold(0.0, |largest: f64, sum: f64| largest.max(sum))
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
