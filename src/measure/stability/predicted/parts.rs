//! The mass-normalised matrices of x'' = -K x - C v, and the parts of them that do not couple.

use crate::measure::stability::matrix::Matrix;
use crate::physics::{Jacobian, Linearization, System, Triplets};
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
    /// How often it occurs.
    pub copies: usize,
}

impl Part {
    pub fn n(&self) -> usize {
        self.stiffness.n()
    }

    fn matrices(&self) -> [&Matrix; 3] {
        [&self.stiffness, &self.damping, &self.material]
    }

    /// The largest first.
    fn order(&self, other: &Self) -> Ordering {
        let matrices = self.matrices().into_iter().zip(other.matrices());
        let sizes = other.n().cmp(&self.n());
        matrices.fold(sizes, |order, (a, b)| order.then_with(|| a.order(b)))
    }
}

/// Entries of sums of a few forces agree with their mirror images to a few roundings.
const SYMMETRIC: f64 = 1e-13;

/// The scene's parts at (t, x, v), largest first, equal ones together; None where a derivative is not
/// finite.
pub(super) fn parts<S: System + ?Sized>(
    system: &S,
    t: f64,
    x: &[f64],
    v: &[f64],
) -> Option<Vec<Part>> {
    let inverse_mass = system.inverse_mass();
    let n = system.dim();
    let mut exact = Jacobian::default();
    system.jacobian(t, x, v, Linearization::Exact, &mut exact);
    let mut material = Jacobian::default();
    system.jacobian(t, x, v, Linearization::Material, &mut material);
    let scaled = |triplets: &Triplets| scaled(n, inverse_mass, triplets);
    let whole = [
        scaled(&exact.position)?,
        scaled(&exact.velocity)?,
        scaled(&material.position)?,
    ];
    let mut parts = separate(&whole, inverse_mass);
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
        .filter(|&(i, j, v)| v.abs() > f64::EPSILON * (sizes[i] * sizes[j]).sqrt())
        .collect();
    Some(Matrix::new(n, kept))
}

/// Splits by what is coupled; fixed coordinates are in no part. Matrices that are symmetric but for
/// rounding are made so.
fn separate(whole: &[Matrix; 3], inverse_mass: &[f64]) -> Vec<Part> {
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
        let mut symmetric = true;
        let [stiffness, damping, material] = whole.each_ref().map(|whole| {
            let matrix = whole.part(coordinates, &place);
            if matrix.skewness() <= SYMMETRIC * matrix.norm() {
                matrix.symmetric_part()
            } else {
                symmetric = false;
                matrix
            }
        });
        Part {
            stiffness,
            damping,
            material,
            symmetric,
            copies: 1,
        }
    };
    members.iter().map(part).collect()
}
