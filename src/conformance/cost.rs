//! Cost: the force evaluations a step takes, counted by the system.

use super::subject::advance;
use super::systems::{built, swinging_triangle};
use super::{Finding, Law};
use crate::integrators::PerStep;
use crate::physics::Counting;
use crate::scene::DampingModel;

const STEPS: u32 = 100;
/// s.
const STEP: f64 = 0.01;

pub(super) const LAW: Law = Law {
    id: "evaluations",
    summary: "the force evaluations a step costs, once running",
    derivation: "counted over 100 steps after the first one: no tolerance",
    judge: |subject| {
        let Some(claimed) = subject.claims.evaluations else {
            return Ok(Finding::skip("force evaluations"));
        };
        let (system, mut state) = built(&swinging_triangle(0.0, DampingModel::Axial));
        let (system, mut integrator) = (Counting::new(system), subject.fresh());
        let mut run = |steps: u32| {
            let n = steps as usize;
            advance(integrator.as_mut(), &system, STEP, n, &mut state)?;
            Ok((system.evaluations().forces, integrator.linear_solves()))
        };
        let (forces_before, solves_before) = run(1)?;
        let (forces, solves) = run(STEPS)?;
        let (forces, solves) = (forces - forces_before, solves.saturating_sub(solves_before));
        let steps = u64::from(STEPS);
        let (expected, what) = match claimed {
            PerStep::Exactly(n) => (steps * u64::from(n), format!("{n} a step")),
            // Every step takes at least one iteration: without one nothing would move.
            PerStep::PerIteration { plus } => (
                solves.max(steps) + steps * u64::from(plus),
                format!("one an iteration and {plus} a step"),
            ),
        };
        let message = format!("claims {what}: {forces} in {steps} steps, with {solves} solves");
        let each = |count: u64| count as f64 / f64::from(STEPS);
        let holds = forces == expected;
        Ok(Finding::of(holds, each(forces), each(expected), message))
    },
};
