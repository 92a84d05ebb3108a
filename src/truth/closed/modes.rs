//! Modes of particles on springs that act along one axis.

use super::jacobi::singular;
use super::mode::Mode;
use super::problem::{Group, Link, Problem};
use nalgebra::{DMatrix, SymmetricEigen};

/// The most free particles one decomposition takes; the time grows with the cube.
pub(super) const MOST: usize = 300;

/// M u'' + C u' + K u = f, decoupled: u_i = sum over j of shape_ij q_j.
#[derive(Debug, Clone)]
pub(super) struct Modes {
    pub modes: Vec<Mode>,
    /// Mode after mode: its entry for each particle, 1/√kg; orthonormal in the metric of M.
    shapes: Vec<f64>,
    masses: Vec<f64>,
    /// What of the damping matrix is left between different modes by rounding, 1/s: the largest sum
    /// of a row.
    pub leak: f64,
    /// Modes of (nearly) one frequency that the damping told apart: how far their frequencies lay
    /// from each other at most, 1/s.
    pub spread: f64,
}

impl Modes {
    /// None if damping and stiffness have no modes in common (C M⁻¹ K is not symmetric), or if there
    /// are more than [`MOST`] particles.
    pub fn new(problem: &Problem, group: &Group) -> Option<Self> {
        let particles = || group.free.iter().map(|&i| &problem.scene.particles[i]);
        let masses: Vec<f64> = particles().map(|p| p.mass).collect();
        let drag: Vec<f64> = particles().map(|p| p.drag).collect();
        let links = &group.links;
        let n = masses.len();
        if n > MOST {
            return None;
        }
        let roots: Vec<f64> = masses.iter().map(|m| m.sqrt()).collect();
        // K = Bᵀ B: frequencies are the singular values of B M^-1/2.
        let mut b = DMatrix::zeros(links.len(), n);
        for (row, link) in links.iter().enumerate() {
            for (end, sign) in link.ends.iter().zip([-1.0, 1.0]) {
                if let Some(i) = *end {
                    b[(row, i)] += sign * link.spring.stiffness.sqrt() / roots[i];
                }
            }
        }
        let (vectors, mut w) = singular(&b)?;
        // Below the rounding of the fastest a frequency cannot be told from none.
        let noise = 2.0 * (n as f64) * f64::EPSILON * w.first().copied().unwrap_or(0.0);
        for w in &mut w {
            if *w <= noise {
                *w = 0.0;
            }
        }
        let mut found = Self {
            modes: w.into_iter().map(|w| Mode { w, g: 0.0 }).collect(),
            shapes: shapes(&vectors, &roots),
            masses,
            leak: 0.0,
            spread: 0.0,
        };
        if n == 1 {
            // The root of a sum of k / m has fewer roundings than the norm of a column.
            let mass = found.masses[0];
            let all: f64 = links.iter().map(|l| l.spring.stiffness).sum();
            let damping = links.iter().map(|l| l.spring.damping).chain(drag);
            found.modes[0] = Mode {
                w: (all / mass).sqrt(),
                g: damping.sum::<f64>() / (2.0 * mass),
            };
            return Some(found);
        }
        let damped = links.iter().any(|l| l.spring.damping > 0.0) || drag.iter().any(|&b| b > 0.0);
        (!damped || found.damp(&vectors, &roots, links, &drag)).then_some(found)
    }

    /// Decay rates, and shapes that suit the damping too where a frequency repeats. False if damping
    /// couples the modes by more than rounding.
    fn damp(
        &mut self,
        vectors: &DMatrix<f64>,
        roots: &[f64],
        links: &[Link],
        drag: &[f64],
    ) -> bool {
        let n = roots.len();
        let mut c = self.damping_matrix(links, drag);
        let size = (0..n).map(|j| c[(j, j)]).fold(0.0, f64::max);
        let rounding = 16.0 * (n as f64) * f64::EPSILON;
        let fastest = self.modes[0].w;
        let mut vectors = vectors.clone();
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
        c = self.damping_matrix(links, drag);
        for j in 0..n {
            self.modes[j].g = 0.5 * c[(j, j)];
            let row: f64 = (0..n).filter(|&i| i != j).map(|i| c[(i, j)].abs()).sum();
            self.leak = self.leak.max(row);
        }
        self.leak <= rounding * size
    }

    /// The damping matrix over the modes, 1/s.
    fn damping_matrix(&self, links: &[Link], drag: &[f64]) -> DMatrix<f64> {
        let n = self.masses.len();
        let mut c = DMatrix::zeros(n, n);
        let mut add = |row: &[f64], by: f64| {
            for j in 0..n {
                let scaled = by * row[j];
                for i in 0..n {
                    c[(i, j)] += row[i] * scaled;
                }
            }
        };
        for link in links.iter().filter(|l| l.spring.damping > 0.0) {
            let row: Vec<f64> = (0..n).map(|j| self.stretch(j, link.ends)).collect();
            add(&row, link.spring.damping);
        }
        for (i, &b) in drag.iter().enumerate().filter(|(_, b)| **b > 0.0) {
            let row: Vec<f64> = (0..n).map(|j| self.shape(j)[i]).collect();
            add(&row, b);
        }
        c
    }

    /// Entries of mode `j`.
    pub fn shape(&self, j: usize) -> &[f64] {
        let n = self.masses.len();
        &self.shapes[j * n..(j + 1) * n]
    }

    /// How much farther apart two ends get per unit of mode `j`, along its axis; None is a fixed end.
    pub fn stretch(&self, j: usize, ends: [Option<usize>; 2]) -> f64 {
        let [a, b] = ends.map(|end| end.map_or(0.0, |i| self.shape(j)[i]));
        b - a
    }

    /// What forces on the particles, N, are to each mode.
    pub fn of_forces(&self, forces: &[f64]) -> Vec<f64> {
        let dot = |j: usize| self.shape(j).iter().zip(forces).map(|(s, f)| s * f).sum();
        (0..self.modes.len()).map(dot).collect()
    }

    /// What velocities of the particles are to each mode.
    pub fn of_velocities(&self, velocities: &[f64]) -> Vec<f64> {
        let momenta: Vec<f64> = self
            .masses
            .iter()
            .zip(velocities)
            .map(|(m, v)| m * v)
            .collect();
        self.of_forces(&momenta)
    }

    pub fn masses(&self) -> &[f64] {
        &self.masses
    }
}

/// Columns v to v_i / √m_i, one after the other.
fn shapes(vectors: &DMatrix<f64>, roots: &[f64]) -> Vec<f64> {
    let columns = vectors.column_iter();
    columns
        .flat_map(|v| v.iter().zip(roots).map(|(v, r)| v / r).collect::<Vec<_>>())
        .collect()
}
