//! The mass-normalised matrices of x'' = -K x - C v, and the parts of them that do not couple.

use super::matrix::Matrix;
use crate::system::{Jacobian, Linearization, System, Triplets};
use std::cmp::Ordering;

/// Coordinates that couple with each other and with no others, such as all x of a chain along x.
/// Scaled by the roots of the masses: K and C are symmetric where forces derive from a potential.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Component {
    /// -M^(-1/2) ∂f/∂x M^(-1/2), 1/s².
    pub stiffness: Matrix,
    /// -M^(-1/2) ∂f/∂v M^(-1/2), 1/s.
    pub damping: Matrix,
    /// As `stiffness`, of springs along themselves only, 1/s².
    pub material: Matrix,
}

impl Component {
    pub(super) fn n(&self) -> usize {
        self.stiffness.n()
    }

    /// Matrices that are symmetric but for rounding are made so; whether they all are.
    fn symmetrise(&mut self) -> bool {
        let mut symmetric = true;
        for matrix in [&mut self.stiffness, &mut self.damping, &mut self.material] {
            if matrix.skewness() <= SYMMETRIC * matrix.norm() {
                *matrix = matrix.symmetric_part();
            } else {
                symmetric = false;
            }
        }
        symmetric
    }

    fn order(&self, other: &Self) -> Ordering {
        let matrices = |c: &Self| [c.stiffness.clone(), c.damping.clone(), c.material.clone()];
        let sizes = other.n().cmp(&self.n());
        matrices(self)
            .iter()
            .zip(&matrices(other))
            .fold(sizes, |order, (ours, theirs)| {
                order.then_with(|| {
                    let lengths = ours.values().len().cmp(&theirs.values().len());
                    let values = ours.values().iter().zip(theirs.values());
                    values.fold(lengths, |o, (a, b)| o.then_with(|| a.total_cmp(b)))
                })
            })
    }
}

/// Entries of sums of a few forces agree with their mirror images to a few roundings.
const SYMMETRIC: f64 = 1e-13;

/// A component, whether its matrices are symmetric, and how often it occurs.
#[derive(Debug, Clone)]
pub(super) struct Part {
    pub component: Component,
    pub symmetric: bool,
    pub copies: usize,
}

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
    let whole = Component {
        stiffness: scaled(&exact.position)?,
        damping: scaled(&exact.velocity)?,
        material: scaled(&material.position)?,
    };
    let mut parts: Vec<Part> = coupled(&whole, inverse_mass)
        .into_iter()
        .map(|mut component| Part {
            symmetric: component.symmetrise(),
            component,
            copies: 1,
        })
        .collect();
    parts.sort_by(|a, b| a.component.order(&b.component));
    parts.dedup_by(|next, kept| {
        let same = next.component == kept.component;
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

/// Splits by what is coupled; fixed coordinates are in no part.
fn coupled(whole: &Component, inverse_mass: &[f64]) -> Vec<Component> {
    let n = whole.n();
    let mut parent: Vec<usize> = (0..n).collect();
    fn root(parent: &mut [usize], mut i: usize) -> usize {
        while parent[i] != i {
            parent[i] = parent[parent[i]];
            i = parent[i];
        }
        i
    }
    for matrix in [&whole.stiffness, &whole.damping, &whole.material] {
        for (row, column, _) in matrix.entries() {
            let (a, b) = (root(&mut parent, row), root(&mut parent, column));
            parent[a.max(b)] = a.min(b);
        }
    }
    let mut members: Vec<Vec<usize>> = vec![Vec::new(); n];
    let mut place = vec![0; n];
    for i in (0..n).filter(|&i| inverse_mass[i] > 0.0) {
        let at = root(&mut parent, i);
        place[i] = members[at].len();
        members[at].push(i);
    }
    members.retain(|coordinates| !coordinates.is_empty());
    members
        .iter()
        .map(|coordinates| Component {
            stiffness: whole.stiffness.part(coordinates, &place),
            damping: whole.damping.part(coordinates, &place),
            material: whole.material.part(coordinates, &place),
        })
        .collect()
}
