//! Modes of particles on springs that act along one axis.

use super::group::{Group, Link};
use super::mode::Mode;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// The most free particles one decomposition takes; the time grows with the cube.
const MOST: usize = 300;

/// M u'' + C u' + K u = f, decoupled: u_i = sum over j of shape_ij q_j.
#[derive(Debug, Clone)]
pub(super) struct Modes {
    pub modes: Vec<Mode>,
    /// A column for each mode, a row for each particle, 1/√kg; orthonormal in the metric of M.
    shapes: DMatrix<f64>,
    /// Smallest mass, kg.
    pub lightest: f64,
    /// The coupling between different modes that rounding leaves in the damping matrix, 1/s: the
    /// largest sum of a row.
    pub leak: f64,
    /// Largest distance, 1/s, between the frequencies of modes of (nearly) one frequency that the
    /// damping told apart.
    pub spread: f64,
}

impl Modes {
    /// The modes of a group; None if damping and stiffness have no modes in common (C M⁻¹ K is not
    /// symmetric), or if there are more than [`MOST`] particles.
    pub fn new(group: &Group) -> Option<Self> {
        let Group { bodies, links, .. } = group;
        let n = bodies.len();
        if n > MOST {
            return None;
        }
        let masses = || bodies.iter().map(|b| b.mass);
        let roots: Vec<f64> = masses().map(f64::sqrt).collect();
        // K = Bᵀ B: frequencies are the singular values of B M^-1/2.
        let mut b = DMatrix::zeros(links.len(), n);
        for (row, link) in links.iter().enumerate() {
            for (end, sign) in link.ends.iter().zip([-1.0, 1.0]) {
                if let Some(i) = *end {
                    b[(row, i)] += sign * link.spring.stiffness.sqrt() / roots[i];
                }
            }
        }
        let (vectors, w) = singular(&b)?;
        // A frequency below the rounding of the fastest cannot be told from 0.
        let noise = 2.0 * (n as f64) * f64::EPSILON * w.first().copied().unwrap_or(0.0);
        let modes = w.into_iter().map(|w| Mode {
            w: if w <= noise { 0.0 } else { w },
            g: 0.0,
        });
        let mut found = Self {
            modes: modes.collect(),
            shapes: shapes(&vectors, &roots),
            lightest: masses().fold(f64::INFINITY, f64::min),
            leak: 0.0,
            spread: 0.0,
        };
        if n == 1 {
            // The root of a sum of k / m has fewer roundings than the norm of a column.
            let all: f64 = links.iter().map(|l| l.spring.stiffness).sum();
            let damping = links.iter().map(|l| l.spring.damping);
            let damping: f64 = damping.chain([bodies[0].drag]).sum();
            found.modes[0] = Mode {
                w: (all / bodies[0].mass).sqrt(),
                g: damping / (2.0 * bodies[0].mass),
            };
            return Some(found);
        }
        let damped =
            links.iter().any(|l| l.spring.damping > 0.0) || bodies.iter().any(|b| b.drag > 0.0);
        (!damped || found.damp(vectors, &roots, group)).then_some(found)
    }

    /// Sets the decay rates and, where a frequency repeats, shapes that suit the damping too. False
    /// if damping couples the modes by more than rounding.
    fn damp(&mut self, mut vectors: DMatrix<f64>, roots: &[f64], group: &Group) -> bool {
        let n = roots.len();
        let mut c = self.damping_matrix(group);
        let size = (0..n).map(|j| c[(j, j)]).fold(0.0, f64::max);
        let rounding = 16.0 * (n as f64) * f64::EPSILON;
        let fastest = self.modes[0].w;
        let mut first = 0;
        while first < n {
            let start = self.modes[first].w;
            let same = |m: &&Mode| start - m.w <= rounding * fastest;
            let many = self.modes[first..].iter().take_while(same).count();
            let block = c.view((first, first), (many, many)).into_owned();
            let across = (&block - DMatrix::from_diagonal(&block.diagonal())).amax();
            if across > f64::EPSILON * size {
                let Some(turn) = SymmetricEigen::try_new(block, f64::EPSILON, 1000 * n) else {
                    return false;
                };
                let turned = vectors.columns(first, many) * turn.eigenvectors;
                vectors.columns_mut(first, many).copy_from(&turned);
                self.spread = self.spread.max(start - self.modes[first + many - 1].w);
            }
            first += many;
        }
        self.shapes = shapes(&vectors, roots);
        c = self.damping_matrix(group);
        for j in 0..n {
            self.modes[j].g = 0.5 * c[(j, j)];
            let row: f64 = (0..n).filter(|&i| i != j).map(|i| c[(i, j)].abs()).sum();
            self.leak = self.leak.max(row);
        }
        self.leak <= rounding * size
    }

    /// The damping matrix over the modes, 1/s.
    fn damping_matrix(&self, group: &Group) -> DMatrix<f64> {
        let n = self.modes.len();
        let mut c = DMatrix::zeros(n, n);
        for link in group.links.iter().filter(|l| l.spring.damping > 0.0) {
            let row = DVector::from_vec(self.stretches(link));
            c.ger(link.spring.damping, &row, &row, 1.0);
        }
        let bodies = group.bodies.iter().enumerate();
        for (i, body) in bodies.filter(|(_, body)| body.drag > 0.0) {
            let row = self.shapes.row(i).transpose();
            c.ger(body.drag, &row, &row, 1.0);
        }
        c
    }

    /// Entries of mode `j`.
    pub fn shape(&self, j: usize) -> &[f64] {
        let n = self.shapes.nrows();
        &self.shapes.as_slice()[j * n..(j + 1) * n]
    }

    /// How much farther along the axis the link's second end gets from its first per unit of each
    /// mode.
    pub fn stretches(&self, link: &Link) -> Vec<f64> {
        let stretch = |j| {
            let [a, b] = link.ends.map(|end| end.map_or(0.0, |i| self.shape(j)[i]));
            b - a
        };
        (0..self.modes.len()).map(stretch).collect()
    }

    /// The acceleration of each mode under these forces on the particles, N; or its velocity, from momenta.
    pub fn of_forces(&self, forces: &[f64]) -> Vec<f64> {
        let dot = |j: usize| self.shape(j).iter().zip(forces).map(|(s, f)| s * f).sum();
        (0..self.modes.len()).map(dot).collect()
    }
}

/// The columns v scaled to v_i / √m_i.
fn shapes(vectors: &DMatrix<f64>, roots: &[f64]) -> DMatrix<f64> {
    DMatrix::from_fn(vectors.nrows(), vectors.ncols(), |i, j| {
        vectors[(i, j)] / roots[i]
    })
}

/// Sweeps over all pairs before giving up; from an eigenbasis two or three are enough.
const SWEEPS: usize = 40;

/// Right singular vectors V (columns) and singular values of `b`, largest first.
///
/// The eigenbasis of bᵀb starts it off and Jacobi's one-sided rotations (Hestenes 1958) finish it. A
/// singular value is then off by a few eps of the *largest one*, where the root of an eigenvalue of
/// bᵀb is off by a few eps of the largest times largest / own. None if it does not converge.
fn singular(b: &DMatrix<f64>) -> Option<(DMatrix<f64>, Vec<f64>)> {
    let n = b.ncols();
    let mut v = if n > 1 {
        SymmetricEigen::try_new(b.tr_mul(b), f64::EPSILON, 1000 * n)?.eigenvectors
    } else {
        DMatrix::identity(n, n)
    };
    let mut bv = b * &v;
    let mut settled = n < 2;
    for _ in 0..SWEEPS {
        if settled {
            break;
        }
        settled = true;
        let noise = f64::EPSILON * bv.norm();
        for p in 0..n {
            for q in p + 1..n {
                let (alpha, beta) = (bv.column(p).norm(), bv.column(q).norm());
                let gamma = bv.column(p).dot(&bv.column(q));
                // Columns that are rounding themselves have no direction to be orthogonal in.
                let limit = f64::EPSILON * alpha.max(noise) * beta.max(noise);
                if gamma.abs() > (n as f64).sqrt() * limit {
                    settled = false;
                    let turn = rotation(alpha, beta, gamma);
                    rotate(&mut bv, p, q, turn);
                    rotate(&mut v, p, q, turn);
                }
            }
        }
    }
    if !settled {
        return None;
    }
    let values: Vec<f64> = bv.column_iter().map(|c| c.norm()).collect();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&i, &j| values[j].total_cmp(&values[i]));
    let sorted = DMatrix::from_fn(n, n, |i, j| v[(i, order[j])]);
    Some((sorted, order.iter().map(|&j| values[j]).collect()))
}

/// Cosine and sine that make two columns of these lengths and this product orthogonal.
fn rotation(alpha: f64, beta: f64, gamma: f64) -> (f64, f64) {
    let zeta = (beta - alpha) * (beta + alpha) / (2.0 * gamma);
    let tan = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
    let cos = 1.0 / tan.hypot(1.0);
    (cos, cos * tan)
}

fn rotate(m: &mut DMatrix<f64>, p: usize, q: usize, (cos, sin): (f64, f64)) {
    for i in 0..m.nrows() {
        let (a, b) = (m[(i, p)], m[(i, q)]);
        m[(i, p)] = cos * a - sin * b;
        m[(i, q)] = sin * a + cos * b;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// [[1, 1], [0, 1e-8]] has singular values with the sum of squares 2 and the product 1e-8; its
    /// bᵀb is singular in doubles.
    #[test]
    fn small_values_keep_their_digits() {
        let b = DMatrix::from_row_slice(2, 2, &[1.0, 1.0, 0.0, 1e-8]);
        let (v, values) = singular(&b).expect("converges");
        let root = 2f64.sqrt();
        // A few eps of the largest.
        assert!((values[0] - root).abs() < 4.0 * f64::EPSILON);
        assert!((values[1] - 1e-8 / root).abs() < 4.0 * f64::EPSILON);
        let found = (&b * &v).column(1).norm();
        assert!((found - values[1]).abs() < 4.0 * f64::EPSILON);
        assert!((v.tr_mul(&v) - DMatrix::identity(2, 2)).amax() < 4.0 * f64::EPSILON);
        // What the eigenvalues of bᵀb alone would give.
        let least = SymmetricEigen::new(b.tr_mul(&b)).eigenvalues.min();
        assert!((least.max(0.0).sqrt() - 1e-8 / root).abs() > 1e6 * f64::EPSILON);
    }
}
