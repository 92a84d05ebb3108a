//! Force Jacobians as triplets.

use super::System;

/// Entries (row, column, value); repeated places add up.
pub type Triplets = Vec<(usize, usize, f64)>;

/// Derivatives of the force by position and velocity.
///
/// Signs as derived: a stable spring has a *negative* definite `position` block, minus what the
/// field calls the stiffness matrix. A system emits the same places in the same order at every
/// call, so solvers may keep the pattern.
#[derive(Debug, Clone, Default)]
pub struct Jacobian {
    /// ∂f/∂x, N/m.
    pub position: Triplets,
    /// ∂f/∂v, N s/m.
    pub velocity: Triplets,
}

/// Which terms of the force's derivative are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Linearization {
    /// All of them.
    Exact,
    /// Springs as k n nᵀ and c n nᵀ only: no geometric stiffness (the turning of the spring), no
    /// derivative of the damper's direction. What rapier's spring joint solves.
    Material,
}

impl Jacobian {
    pub fn clear(&mut self) {
        self.position.clear();
        self.velocity.clear();
    }

    /// Adds the blocks of an interaction that depends on the difference of two particles only:
    /// `position` and `velocity` are ∂f_i/∂(x_j - x_i) and ∂f_i/∂(v_j - v_i), with f_j = -f_i.
    pub fn add_pair(
        &mut self,
        i: usize,
        j: usize,
        position: Option<&nalgebra::Matrix3<f64>>,
        velocity: Option<&nalgebra::Matrix3<f64>>,
    ) {
        for (block, out) in [
            (position, &mut self.position),
            (velocity, &mut self.velocity),
        ] {
            let Some(block) = block else { continue };
            for (row, column, sign) in [(i, j, 1.0), (i, i, -1.0), (j, j, -1.0), (j, i, 1.0)] {
                for r in 0..3 {
                    for c in 0..3 {
                        out.push((3 * row + r, 3 * column + c, sign * block[(r, c)]));
                    }
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
            // The cube root of eps balances truncation against rounding.
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
    if system.is_damped() {
        columns(v, false, &mut out.velocity);
    }
}
