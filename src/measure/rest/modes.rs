//! The slowest oscillations about a rest: x'' = -K x of the forces linearised there, without dampers.

use crate::physics::{Jacobian, Linearization, ParticleSystem, System};
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::Llt;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, Side};

/// One oscillation.
#[derive(Debug, Clone, PartialEq)]
pub struct Mode {
    /// ω², 1/s²: below 0 where the rest is left, 0 where nothing restores.
    pub stiffness: f64,
    /// The displacements, three a particle, the largest component 1.
    pub shape: Vec<f64>,
}

/// The softest oscillations about a rest.
#[derive(Debug, Clone, PartialEq)]
pub struct Modes {
    /// Ascending in stiffness: all of a small scene.
    pub lowest: Vec<Mode>,
    /// Whether there are no more than these.
    pub all: bool,
}

impl Modes {
    /// Whether all that leave the rest or cost nothing are among them.
    pub fn counted(&self) -> bool {
        let stiffest = self.lowest.last();
        self.all || stiffest.is_some_and(|mode| mode.stiffness > 0.0)
    }

    /// How many of them leave the rest.
    pub fn unstable(&self) -> usize {
        self.count(|stiffness| stiffness < 0.0)
    }

    /// How many of them no force restores.
    pub fn free(&self) -> usize {
        self.count(|stiffness| stiffness == 0.0)
    }

    fn count(&self, which: fn(f64) -> bool) -> usize {
        let found = self.lowest.iter();
        found.filter(|mode| which(mode.stiffness)).count()
    }
}

/// How many modes that are restored are looked for in a large scene, and how many more the space holds.
const WANTED: usize = 8;
const SPARE: usize = 12;
/// The most numbers that a space may hold: where many motions cost nothing, others are hidden behind them.
const SPACE: usize = 4_000_000;
/// Up to this many coordinates all modes are found at once.
const SMALL: usize = 60;
/// Stiffnesses below this part of the largest are rounding.
const ZERO: f64 = 64.0 * f64::EPSILON;
/// The first multiple of the masses that is added to make the stiffness definite, a part of the largest, and its growth.
const SHIFT: f64 = 1e-13;
const GROWTH: f64 = 16.0;
const SHIFTS: usize = 12;
/// What is added where some motions cost nothing, a part of the largest.
const APART: f64 = 1e-9;
/// Iterations after which a softest stiffness is known well enough to tell it from 0.
const SETTLED: usize = 5;
/// A stiffness that changes by a smaller part in one iteration has been found.
const FOUND: f64 = 1e-12;
/// The most iterations: neighbours as close as 0.8 gain a tenth each.
const ITERATIONS: usize = 400;

/// The softest modes about a rest, by subspace iteration with the inverse (Bathe 1971): of matrices of any size what the
/// sparse factors of one take. None where a derivative is not finite or nothing can move.
///
/// Of forces without a potential, as those of moving air on triangles, the symmetric part counts.
pub fn modes(system: &ParticleSystem, x: &[f64]) -> Option<Modes> {
    let matrix = Stiffness::new(system, x)?;
    let n = matrix.coordinates.len();
    let zero = ZERO * matrix.norm;
    let (values, vectors): (Vec<f64>, _) = if n <= SMALL {
        let eigen = matrix.dense().self_adjoint_eigen(Side::Lower).ok()?;
        let values = eigen.S().column_vector().iter().copied().collect();
        (values, eigen.U().to_owned())
    } else {
        matrix.softest()?
    };
    let mode = |k: usize| {
        let stiffness: f64 = values[k];
        let mut shape = vec![0.0; x.len()];
        for (row, (&at, weight)) in matrix.coordinates.iter().zip(&matrix.weights).enumerate() {
            shape[at] = vectors[(row, k)] * weight;
        }
        let largest = shape
            .iter()
            .fold(0.0_f64, |m, c| if c.abs() > m.abs() { *c } else { m });
        if largest != 0.0 {
            shape.iter_mut().for_each(|c| *c /= largest);
        }
        Mode {
            stiffness: if stiffness.abs() <= zero {
                0.0
            } else {
                stiffness
            },
            shape,
        }
    };
    Some(Modes {
        lowest: (0..values.len()).map(mode).collect(),
        all: n <= SMALL,
    })
}

/// M^(-1/2) K M^(-1/2) over the free coordinates, 1/s², its symmetric part.
struct Stiffness {
    /// Entries (row, column, value); those of one place are added.
    entries: Vec<Triplet<usize, usize, f64>>,
    /// The coordinate of each row, and M^(-1/2) there.
    coordinates: Vec<usize>,
    weights: Vec<f64>,
    /// The largest sum of magnitudes in a row.
    norm: f64,
}

impl Stiffness {
    fn new(system: &ParticleSystem, x: &[f64]) -> Option<Self> {
        let rest = vec![0.0; x.len()];
        let mut jacobian = Jacobian::default();
        system.jacobian(0.0, x, &rest, Linearization::Exact, &mut jacobian);
        let inverse_mass = system.inverse_mass();
        let coordinates: Vec<usize> = (0..x.len()).filter(|&i| inverse_mass[i] > 0.0).collect();
        let mut row = vec![usize::MAX; x.len()];
        for (at, &coordinate) in coordinates.iter().enumerate() {
            row[coordinate] = at;
        }
        let weights: Vec<f64> = coordinates
            .iter()
            .map(|&i| inverse_mass[i].sqrt())
            .collect();
        let mut entries = Vec::new();
        for &(r, c, value) in &jacobian.position {
            let [r, c] = [row[r], row[c]];
            if r == usize::MAX || c == usize::MAX || value == 0.0 {
                continue;
            }
            let value = -0.5 * value * weights[r] * weights[c];
            if !value.is_finite() {
                return None;
            }
            entries.push(Triplet::new(r, c, value));
            entries.push(Triplet::new(c, r, value));
        }
        let mut matrix = Self {
            entries,
            coordinates,
            weights,
            norm: 0.0,
        };
        let n = matrix.coordinates.len();
        let mut sums = vec![0.0; n];
        let whole = matrix.shifted(0.0)?;
        for entry in whole.triplet_iter() {
            sums[entry.row] += entry.val.abs();
        }
        matrix.norm = sums.into_iter().fold(0.0, f64::max);
        (n > 0).then_some(matrix)
    }

    fn dense(&self) -> Mat<f64> {
        let n = self.coordinates.len();
        let mut dense = Mat::zeros(n, n);
        for entry in &self.entries {
            dense[(entry.row, entry.col)] += entry.val;
        }
        dense
    }

    /// The matrix with `shift` added to its diagonal, where every entry is present.
    fn shifted(&self, shift: f64) -> Option<SparseColMat<usize, f64>> {
        let n = self.coordinates.len();
        let mut entries = self.entries.clone();
        entries.extend((0..n).map(|i| Triplet::new(i, i, shift)));
        SparseColMat::try_new_from_triplets(n, n, &entries).ok()
    }

    /// The smallest eigenvalues, ascending, and unit vectors.
    fn softest(&self) -> Option<(Vec<f64>, Mat<f64>)> {
        let n = self.coordinates.len();
        let size = if self.norm > 0.0 { self.norm } else { 1.0 };
        let (mut shift, mut found) = (SHIFT * size, None);
        for _ in 0..SHIFTS {
            found = self.shifted(shift)?.sp_cholesky(Side::Lower).ok();
            if found.is_some() {
                break;
            }
            shift *= GROWTH;
        }
        let factor = found?;
        let first = (WANTED + SPARE).min(n);
        let stiffness = self.shifted(0.0)?;
        if let Some((mut values, vectors)) = self.iterated(&stiffness, &factor, Some(shift), first)
        {
            values.truncate(self.wanted(&values));
            return Some((values, vectors));
        }
        // Beside what nothing restores, whose inverse is huge, the inverse tells nothing of the others.
        let factor = self
            .shifted(shift.max(APART * size))?
            .sp_cholesky(Side::Lower)
            .ok()?;
        let mut columns = first;
        loop {
            let (mut values, vectors) = self.iterated(&stiffness, &factor, None, columns)?;
            let wanted = self.wanted(&values);
            if wanted + SPARE <= columns || columns == n || 2 * columns * n > SPACE {
                values.truncate(wanted);
                return Some((values, vectors));
            }
            columns = (2 * columns).min(n);
        }
    }

    /// How many of these stiffnesses, ascending, are to be found: those that restore nothing, and some that do.
    fn wanted(&self, values: &[f64]) -> usize {
        let zero = ZERO * self.norm;
        let hidden = values.iter().take_while(|value| **value <= zero).count();
        (hidden + WANTED).min(values.len())
    }

    /// The smallest eigenvalues in a space of so many columns, ascending, and unit vectors: from the inverse at this
    /// shift, which keeps more digits of the smallest, or from the matrix.
    fn iterated(
        &self,
        stiffness: &SparseColMat<usize, f64>,
        factor: &Llt<usize, f64>,
        of_inverse: Option<f64>,
        columns: usize,
    ) -> Option<(Vec<f64>, Mat<f64>)> {
        // Any start that no mode is orthogonal to; always the same.
        let mut seed = 1_u64;
        let mut basis = Mat::from_fn(self.coordinates.len(), columns, |_, _| {
            seed = seed
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        });
        let mut before = vec![f64::INFINITY; columns];
        for iteration in 0..ITERATIONS {
            basis = basis.qr().compute_thin_Q();
            let image = factor.solve(&basis);
            let projected = match of_inverse {
                // The softest first, in the order of eigenvalues.
                Some(_) => -(basis.transpose() * &image),
                None => basis.transpose() * (stiffness * &basis),
            };
            let projected = Mat::from_fn(columns, columns, |i, j| {
                0.5 * (projected[(i, j)] + projected[(j, i)])
            });
            let eigen = projected.self_adjoint_eigen(Side::Lower).ok()?;
            let values = eigen
                .S()
                .column_vector()
                .iter()
                .map(|value| match of_inverse {
                    Some(shift) => -1.0 / value - shift,
                    None => *value,
                });
            let values: Vec<f64> = values.collect();
            if values.iter().any(|value| !value.is_finite()) {
                return None;
            }
            let same = |k: usize| {
                let [now, then] = [values[k], before[k]];
                (now - then).abs() <= FOUND * now.abs()
                    || now.abs().max(then.abs()) <= ZERO * self.norm
            };
            let sought = columns.saturating_sub(SPARE).max(1);
            let done = (0..self.wanted(&values).min(sought)).all(same);
            let soft = values.iter().any(|value| *value <= ZERO * self.norm);
            if soft && of_inverse.is_some() && (done || iteration > SETTLED) {
                return None;
            }
            if done {
                return Some((values, &basis * eigen.U()));
            }
            before = values;
            basis = &image * eigen.U();
        }
        None
    }
}
