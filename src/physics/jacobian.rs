//! Force Jacobians, as triplets or as 3 x 3 blocks of pairs.

use super::System;
use nalgebra::Matrix3;

/// Entries (row, column, value); the values of repeated places are added.
pub type Triplets = Vec<(usize, usize, f64)>;

/// Derivatives of the force by position and velocity.
///
/// Signs are those of the derivative: a stable spring has a *negative* definite `position` block, minus its
/// stiffness matrix. A system emits the same places in the same order at every
/// call, so solvers may keep the pattern; what presses by penalty has places only while it does.
#[derive(Debug, Clone, Default)]
pub struct Jacobian {
    /// ∂f/∂x, N/m.
    pub position: Triplets,
    /// ∂f/∂v, N s/m.
    pub velocity: Triplets,
    /// The blocks of pairs, if they are stored as such and not as triplets.
    pairs: Option<[Vec<PairBlock>; 2]>,
}

/// ∂f_i/∂(x_j - x_i), or the same by velocities, of an interaction of particles i and j with
/// f_j = -f_i: -block at (i, i) and (j, j), +block at (i, j) and (j, i).
#[derive(Debug, Clone, Copy)]
pub(crate) struct PairBlock {
    pub ends: [u32; 2],
    pub block: Matrix3<f64>,
}

/// The variable by which the force is differentiated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Derivative {
    Position = 0,
    Velocity = 1,
}

/// Which terms of the force's derivative are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Linearization {
    /// All of them.
    Exact,
    /// Springs as k n nᵀ and c n nᵀ only: no geometric stiffness (the turning of the spring), no
    /// derivative of the damper's direction. What rapier's spring joint solves.
    Material,
    /// The part of `Exact` that makes M - γ C - γ² K symmetric and positive definite at any state. It
    /// leaves out negative stiffness (of compressed springs across, of attraction along) and the turning of
    /// dampers. It gives search directions, not steps.
    ///
    /// A system without this part may answer as for `Exact`.
    Definite,
}

impl Jacobian {
    /// A Jacobian that stores pairs as blocks of nine numbers, where triplets take 36 entries. `position`
    /// and `velocity` then leave pairs out.
    pub(crate) fn in_blocks() -> Self {
        Self {
            pairs: Some(Default::default()),
            ..Self::default()
        }
    }

    pub fn clear(&mut self) {
        self.forget(Derivative::Position);
        self.forget(Derivative::Velocity);
    }

    /// Removes one of the two derivatives.
    pub(crate) fn forget(&mut self, by: Derivative) {
        match by {
            Derivative::Position => self.position.clear(),
            Derivative::Velocity => self.velocity.clear(),
        }
        if let Some(pairs) = &mut self.pairs {
            pairs[by as usize].clear();
        }
    }

    pub(crate) fn triplets(&self, by: Derivative) -> &Triplets {
        match by {
            Derivative::Position => &self.position,
            Derivative::Velocity => &self.velocity,
        }
    }

    pub(crate) fn pairs(&self, by: Derivative) -> &[PairBlock] {
        self.pairs.as_ref().map_or(&[], |pairs| &pairs[by as usize])
    }

    /// out += factor * ∂f w, over all coordinates, fixed ones included.
    pub(crate) fn add_product(&self, by: Derivative, factor: f64, w: &[f64], out: &mut [f64]) {
        for &(row, column, value) in self.triplets(by) {
            out[row] += factor * value * w[column];
        }
        for pair in self.pairs(by) {
            pair.for_each(|row, column, value| out[row] += factor * value * w[column]);
        }
    }

    /// out += factor * |∂f| |w|, entry by entry: a bound for the effect of relative changes of w.
    pub(crate) fn add_magnitudes(&self, by: Derivative, factor: f64, w: &[f64], out: &mut [f64]) {
        for &(row, column, value) in self.triplets(by) {
            out[row] += factor * (value * w[column]).abs();
        }
        for pair in self.pairs(by) {
            let [i, j] = pair.ends.map(|end| 3 * end as usize);
            let sum = nalgebra::Vector3::from_fn(|a, _| w[j + a].abs() + w[i + a].abs());
            let reach = pair.block.abs() * sum * factor;
            for axis in 0..3 {
                out[i + axis] += reach[axis];
                out[j + axis] += reach[axis];
            }
        }
    }

    /// Adds the block ∂f_i/∂x_j, or ∂f_i/∂v_j, of particles i and j.
    pub fn add_block(&mut self, by: Derivative, [i, j]: [usize; 2], block: &Matrix3<f64>) {
        let out = match by {
            Derivative::Position => &mut self.position,
            Derivative::Velocity => &mut self.velocity,
        };
        for row in 0..3 {
            for column in 0..3 {
                out.push((3 * i + row, 3 * j + column, block[(row, column)]));
            }
        }
    }

    /// Adds the block of an interaction that depends on the difference of two particles only:
    /// ∂f_i/∂(x_j - x_i), or ∂f_i/∂(v_j - v_i), with f_j = -f_i.
    pub fn add_pair(&mut self, by: Derivative, ends: [usize; 2], block: Matrix3<f64>) {
        let ends = ends.map(|end| end as u32);
        let pair = PairBlock { ends, block };
        if let Some(pairs) = &mut self.pairs {
            return pairs[by as usize].push(pair);
        }
        let out = match by {
            Derivative::Position => &mut self.position,
            Derivative::Velocity => &mut self.velocity,
        };
        pair.for_each(|row, column, value| out.push((row, column, value)));
    }
}

impl PairBlock {
    /// Visits every entry (row, column, value).
    #[inline]
    pub(crate) fn for_each(&self, mut entry: impl FnMut(usize, usize, f64)) {
        let [i, j] = self.ends.map(|end| 3 * end as usize);
        for (row, column, sign) in [(i, j, 1.0), (i, i, -1.0), (j, j, -1.0), (j, i, 1.0)] {
            for r in 0..3 {
                for c in 0..3 {
                    entry(row + r, column + c, sign * self.block[(r, c)]);
                }
            }
        }
    }
}

/// Dense central differences of the acceleration, times the mass; fixed rows stay empty.
pub(super) fn central_differences<S: System + ?Sized>(
    system: &S,
    t: f64,
    x: &[f64],
    v: &[f64],
    out: &mut Jacobian,
) {
    let n = system.dim();
    let inverse_mass = system.inverse_mass();
    let mut low = vec![0.0; n];
    let mut high = vec![0.0; n];
    let mut columns = |base: &[f64], of_position: bool, triplets: &mut Triplets| {
        let mut moved = base.to_vec();
        for column in 0..n {
            if inverse_mass[column] == 0.0 {
                continue;
            }
            // A step of about the cube root of eps balances truncation against rounding.
            let step = 6e-6 * base[column].abs().max(1.0);
            for (sign, a) in [(-1.0, &mut low), (1.0, &mut high)] {
                moved[column] = base[column] + sign * step;
                if of_position {
                    system.acceleration(t, &moved, v, a);
                } else {
                    system.acceleration(t, x, &moved, a);
                }
            }
            moved[column] = base[column];
            for row in 0..n {
                if inverse_mass[row] > 0.0 {
                    let slope = (high[row] - low[row]) / (2.0 * step * inverse_mass[row]);
                    triplets.push((row, column, slope));
                }
            }
        }
    };
    columns(x, true, &mut out.position);
    if system.kinds().depends_on_velocity() {
        columns(v, false, &mut out.velocity);
    }
}
