//! Reversal: after a run, a flip of the velocities, another run and another flip, the state is the start.

use super::subject::distance;
use super::symplecticity::LARGE_STEP;
use super::systems::{built, swinging_triangle};
use super::{Finding, Law, SOLVED_TO};
use crate::scene::DampingModel;

/// Steps in each direction.
const STEPS: usize = 10;

/// Twenty steps, each solved to 1e-12, on values of order 1 that the way back stretches by up to ten.
const BOUND: f64 = 200.0 * SOLVED_TO;

pub(super) const LAW: Law = Law {
    id: "reversal",
    summary: "with velocities flipped the motion returns to its start, or does not, as claimed",
    derivation: "twenty steps solved to 1e-12, errors stretched by up to ten; explicit ones leave \
                 5e-15 of rounding",
    judge: |subject| {
        let (system, start) = built(&swinging_triangle(0.0, DampingModel::Axial));
        let mut state = start.clone();
        let mut moved = 0.0_f64;
        for _ in 0..2 {
            subject.advance(&system, LARGE_STEP, STEPS, &mut state)?;
            for (x, from) in state.x.iter().zip(&start.x) {
                moved = moved.max((x - from).abs());
            }
            for v in &mut state.v {
                *v = -*v;
            }
        }
        // Half a second of swinging: every method of the registry moves by 0.9 m or more.
        if moved < 0.3 {
            let message = "returns, since it has hardly moved";
            return Ok(Finding::of(false, moved, 0.3, message));
        }
        let off = distance(&state, &start);
        let claimed = subject.claims.reversible;
        Ok(Finding::of_property(claimed, off, BOUND, "reversible"))
    },
};
