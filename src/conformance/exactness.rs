//! Exactness: free fall is followed without error at any step.

use super::subject::distance;
use super::systems::ConstantForce;
use super::{Finding, Law, SOLVED_TO};

/// s; the result does not depend on it.
const STEP: f64 = 0.1;
const STEPS: usize = 10;

/// Ten steps, each solved to 1e-12, on positions and velocities of order 10.
const BOUND: f64 = 100.0 * SOLVED_TO;

pub(super) const LAW: Law = Law {
    id: "exactness",
    summary: "free fall is met exactly, or is not, as claimed",
    derivation: "ten steps solved to 1e-12 on values up to 10; explicit ones leave rounding",
    judge: |subject| {
        let mut state = ConstantForce::start();
        subject.advance(&ConstantForce, STEP, STEPS, &mut state)?;
        let off = distance(&state, &ConstantForce::exact(STEP * STEPS as f64));
        let claimed = subject.claims.exact;
        let property = "exact under a constant force";
        Ok(Finding::of_property(claimed, off, BOUND, property))
    },
};
