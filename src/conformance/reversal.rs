//! Reversal: forward, flip the velocities, forward, flip, and back at the start.

use super::finding::Verdict;
use super::subject::{advance, distance};
use super::symplecticity::LARGE_STEP;
use super::systems::swinging_triangle;
use super::{Law, SOLVED_TO};
use crate::physics::ParticleSystem;
use crate::scene::DampingModel;

/// Steps each way.
const STEPS: usize = 10;

/// Twenty steps, each solved to 1e-12, on values of order 1 that the way back stretches by up to ten.
const BOUND: f64 = 200.0 * SOLVED_TO;

pub(super) const LAW: Law = Law {
    id: "reversal",
    summary: "with velocities flipped the motion returns to its start, or does not, as claimed",
    derivation: "twenty steps solved to 1e-12, errors stretched by up to ten; explicit ones leave \
                 5e-15 of rounding",
    judge: |subject| {
        let scene = swinging_triangle(0.0, DampingModel::Axial);
        let (system, start) = (
            ParticleSystem::new(&scene),
            ParticleSystem::initial_state(&scene),
        );
        let mut state = start.clone();
        let mut moved = 0.0_f64;
        for _ in 0..2 {
            advance(
                subject.fresh().as_mut(),
                &system,
                LARGE_STEP,
                STEPS,
                &mut state,
            )?;
            for (x, from) in state.x.iter().zip(&start.x) {
                moved = moved.max((x - from).abs());
            }
            for v in &mut state.v {
                *v = -*v;
            }
        }
        // Half a second of swinging: every method of the registry moves by 0.9 m or more.
        if moved < 0.3 {
            return Ok(Verdict::fail(
                moved,
                0.3,
                "returns, since it has hardly moved",
            ));
        }
        let off = distance(&state, &start);
        Ok(Verdict::of_property(
            subject.claims.reversible,
            off,
            BOUND,
            "reversible",
        ))
    },
};
