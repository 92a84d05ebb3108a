//! Symplecticity: the one-step map's Jacobian S preserves the symplectic form, Sᵀ J S = J.

use super::subject::{Broken, Subject};
use super::systems::{built, swinging_triangle};
use super::{Finding, Law, SOLVED_TO};
use crate::physics::{ParticleSystem, State, System};
use crate::scene::DampingModel;
use nalgebra::DMatrix;

/// The step, s. For the stiffest mode of the network w h is 0.57: large enough that a defect of high order
/// is visible.
pub(super) const LARGE_STEP: f64 = 0.05;

/// Half the width of a central difference, m and m/s. Truncation and rounding are then of equal size, both
/// about 5e-11.
const DELTA: f64 = 1e-5;

/// Steps solved to 1e-12 at both ends of a difference of width 2e-5.
const BOUND: f64 = 2.0 * SOLVED_TO / (2.0 * DELTA);

pub(super) const LAW: Law = Law {
    id: "symplecticity",
    summary: "the one-step map keeps the symplectic form of a non-linear network of unequal masses, \
              or does not, as claimed",
    derivation: "central differences over 2e-5 of steps solved to 1e-12 are good to 1e-7; explicit \
                 ones to 1e-10",
    judge: |subject| {
        let (claimed, defect) = (subject.claims.symplectic, defect(subject)?);
        Ok(Finding::of_property(claimed, defect, BOUND, "symplectic"))
    },
};

/// Largest entry of Sᵀ J S - J over the free coordinates, with J = [[0, M], [-M, 0]] in (x, v).
fn defect(subject: &Subject) -> Result<f64, Broken> {
    let (system, start) = built(&swinging_triangle(0.0, DampingModel::Axial));
    let free_ones = system.inverse_mass().iter().filter(|w| **w > 0.0);
    let masses: Vec<f64> = free_ones.map(|w| 1.0 / w).collect();
    let n = masses.len();
    let mut columns = Vec::new();
    for at in 0..2 * n {
        let moved = |by: f64| -> Result<Vec<f64>, Broken> {
            let mut state = start.clone();
            if let Some(value) = free(&system, &mut state).nth(at) {
                *value += by;
            }
            subject.advance(&system, LARGE_STEP, 1, &mut state)?;
            Ok(free(&system, &mut state).map(|value| *value).collect())
        };
        let (low, high) = (moved(-DELTA)?, moved(DELTA)?);
        columns.extend(low.iter().zip(&high).map(|(l, h)| (h - l) / (2.0 * DELTA)));
    }
    let step = DMatrix::from_vec(2 * n, 2 * n, columns);
    let mut form = DMatrix::zeros(2 * n, 2 * n);
    for (i, mass) in masses.into_iter().enumerate() {
        form[(i, n + i)] = mass;
        form[(n + i, i)] = -mass;
    }
    Ok((step.transpose() * &form * &step - form).amax())
}

/// Positions, then velocities, of the free coordinates.
fn free<'a>(system: &'a ParticleSystem, state: &'a mut State) -> impl Iterator<Item = &'a mut f64> {
    let fixed = system.inverse_mass().iter().map(|w| *w == 0.0);
    let x = state.x.iter_mut().zip(fixed.clone());
    let v = state.v.iter_mut().zip(fixed);
    x.chain(v)
        .filter_map(|(value, fixed)| (!fixed).then_some(value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::{Jacobian, Linearization};

    #[test]
    fn the_step_is_large_for_the_stiffest_mode() {
        let (system, start) = built(&swinging_triangle(0.0, DampingModel::Axial));
        let mut jacobian = Jacobian::default();
        system.jacobian(0.0, &start.x, &start.v, Linearization::Exact, &mut jacobian);
        let w = system.inverse_mass();
        let mut stiffness = DMatrix::<f64>::zeros(w.len(), w.len());
        for (row, column, value) in jacobian.position {
            stiffness[(row, column)] -= value * (w[row] * w[column]).sqrt();
        }
        let fastest = stiffness.symmetric_eigenvalues().max().sqrt();
        // Measured 11.4 rad/s.
        let z = LARGE_STEP * fastest;
        assert!((0.5..1.0).contains(&z), "{z}");
        // Some mass is not 1, so a form without the masses would differ.
        assert!(w.iter().filter(|w| **w > 0.0).any(|w| *w != 1.0));
    }
}
