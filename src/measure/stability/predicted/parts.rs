//! The mass-normalised matrices of x'' = -K x - C v, and the parts of them that do not couple.

use crate::physics::{Jacobian, Linearization, State, System, Triplets};
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

    fn matrices(&self) -> [&Matrix; 3] {
        [&self.stiffness, &self.damping, &self.material]
    }

    /// Orders parts, the largest first.
    fn order(&self, other: &Self) -> Ordering {
        let matrices = self.matrices().into_iter().zip(other.matrices());
        let sizes = other.n().cmp(&self.n());
        matrices.fold(sizes, |order, (a, b)| order.then_with(|| a.order(b)))
    }
}

/// Entries of sums of a few forces agree with their mirror images to a few roundings.
const SYMMETRIC: f64 = 1e-13;

/// The scene's parts about a state, largest first, equal ones together; None where a derivative is not
/// finite.
pub(super) fn parts<S: System + ?Sized>(system: &S, state: &State) -> Option<Vec<Part>> {
    let State { t, x, v, .. } = state;
    let inverse_mass = system.inverse_mass();
    let n = system.dim();
    let mut exact = Jacobian::default();
    system.jacobian(*t, x, v, Linearization::Exact, &mut exact);
    let mut material = Jacobian::default();
    system.jacobian(*t, x, v, Linearization::Material, &mut material);
    let scaled = |triplets: &Triplets| scaled(n, inverse_mass, triplets);
    let whole = [
        scaled(&exact.position)?,
        scaled(&exact.velocity)?,
        scaled(&material.position)?,
    ];
    // The same one rounding away, in directions that stretch what lies along an axis.
    let signs = [2.0, -2.0, 2.0, -2.0, 2.0, -2.0, -2.0].into_iter().cycle();
    let away = x.iter().zip(signs);
    let away: Vec<f64> = away.map(|(x, sign)| x + sign * f64::EPSILON * x).collect();
    let mut there = Jacobian::default();
    system.jacobian(*t, &away, v, Linearization::Exact, &mut there);
    let moved = whole[0].combined(1.0, &scaled(&there.position)?, -1.0);
    let mut parts = separate(&driven(whole), &moved, inverse_mass);
    parts.sort_by(Part::order);
    parts.dedup_by(|next, kept| {
        let same = next.matrices() == kept.matrices();
        kept.copies += usize::from(same);
        same
    });
    Some(parts)
}

/// -M^(-1/2) D M^(-1/2) over the free coordinates, without what is only a rounding of its
/// neighbours: directions such as cos(π/2) would couple axes that do not couple.
fn scaled(n: usize, inverse_mass: &[f64], triplets: &Triplets) -> Option<Matrix> {
    let mut entries = Vec::new();
    for &(row, column, value) in triplets {
        let weight = inverse_mass[row] * inverse_mass[column];
        if weight > 0.0 {
            let value = -value * weight.sqrt();
            if !value.is_finite() {
                return None;
            }
            entries.push((row, column, value));
        }
    }
    let matrix = Matrix::new(n, entries);
    // The largest of a particle's three.
    let size = |i: usize| {
        let own = 3 * (i / 3)..(3 * (i / 3) + 3).min(n);
        own.map(|i| matrix.at(i, i).abs()).fold(0.0, f64::max)
    };
    let sizes: Vec<f64> = (0..n).map(size).collect();
    let kept = matrix
        .entries()
        .filter(|&(i, j, v)| v.abs() > f64::EPSILON * (sizes[i] * sizes[j]).sqrt());
    Some(Matrix::new(n, kept))
}

/// A time, s, no longer than the shortest time scale of the forces about a state: from the row sums of the
/// Jacobians (Gershgorin). None where no force depends on the state.
///
/// Entries are scaled once they are summed, unlike those of [`parts`]: a search starts from this time, and
/// what a chaotic scene does at a step depends on its last bit.
pub(in crate::measure::stability) fn shortest<S: System + ?Sized>(
    system: &S,
    state: &State,
) -> Option<f64> {
    let State { t, x, v, .. } = state;
    let mut jacobian = Jacobian::default();
    system.jacobian(*t, x, v, Linearization::Exact, &mut jacobian);
    let weights = system.inverse_mass();
    let largest = |triplets: &Triplets| {
        let mut matrix = Matrix::new(system.dim(), triplets.iter().copied());
        for (row, entries) in matrix.rows.iter_mut().enumerate() {
            for (column, value) in entries {
                *value *= (weights[row] * weights[*column]).sqrt();
            }
        }
        matrix.norm()
    };
    let rate = largest(&jacobian.position)
        .sqrt()
        .max(largest(&jacobian.velocity));
    (rate > 0.0 && rate.is_finite()).then(|| 1.0 / rate)
}

/// The matrices without the columns of coordinates that no force moves: such a one drives others and nothing
/// drives it, so eigenvalues are those of the rest.
fn driven(mut whole: [Matrix; 3]) -> [Matrix; 3] {
    loop {
        let moved = |i: usize| whole.iter().any(|matrix| !matrix.rows[i].is_empty());
        let moved: Vec<bool> = (0..whole[0].n()).map(moved).collect();
        let count = |whole: &[Matrix; 3]| whole.iter().flat_map(Matrix::entries).count();
        let before = count(&whole);
        whole = whole.map(|matrix| {
            let kept = matrix.entries().filter(|(_, column, _)| moved[*column]);
            Matrix::new(matrix.n(), kept)
        });
        if count(&whole) == before {
            return whole;
        }
    }
}

/// Splits by what is coupled; fixed coordinates are in no part. `moved` is what rounding moves K by.
fn separate(whole: &[Matrix; 3], moved: &Matrix, inverse_mass: &[f64]) -> Vec<Part> {
    let n = inverse_mass.len();
    let mut parent: Vec<usize> = (0..n).collect();
    fn root(parent: &mut [usize], mut i: usize) -> usize {
        while parent[i] != i {
            parent[i] = parent[parent[i]];
            i = parent[i];
        }
        i
    }
    for (row, column, _) in whole.iter().flat_map(Matrix::entries) {
        let (a, b) = (root(&mut parent, row), root(&mut parent, column));
        parent[a.max(b)] = a.min(b);
    }
    let mut members: Vec<Vec<usize>> = vec![Vec::new(); n];
    let mut place = vec![0; n];
    for i in (0..n).filter(|&i| inverse_mass[i] > 0.0) {
        let at = root(&mut parent, i);
        place[i] = members[at].len();
        members[at].push(i);
    }
    members.retain(|coordinates| !coordinates.is_empty());
    let part = |coordinates: &Vec<usize>| {
        let of = |matrix: &Matrix| matrix.part(coordinates, &place);
        Part::new(whole.each_ref().map(of), of(moved).norm(), 1)
    };
    members.iter().map(part).collect()
}

/// A square sparse matrix: the columns of each row, ascending, and their entries.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Matrix {
    rows: Vec<Vec<(usize, f64)>>,
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
