//! Cost: force evaluations a step, counted from outside.

use super::Law;
use super::finding::Verdict;
use super::subject::advance;
use super::systems::swinging_triangle;
use crate::integrators::PerStep;
use crate::outcome::CheckStatus;
use crate::physics::{Counting, ParticleSystem};
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
            return Ok(Verdict::skip("force evaluations"));
        };
        let scene = swinging_triangle(0.0, DampingModel::Axial);
        let system = Counting::new(ParticleSystem::new(&scene));
        let mut state = ParticleSystem::initial_state(&scene);
        let mut integrator = subject.fresh();
        let mut run = |steps: u32| {
            advance(
                integrator.as_mut(),
                &system,
                STEP,
                steps as usize,
                &mut state,
            )?;
            Ok((system.evaluations().forces, integrator.linear_solves()))
        };
        let (forces_before, solves_before) = run(1)?;
        let (forces, solves) = run(STEPS)?;
        let (forces, solves) = (forces - forces_before, solves.saturating_sub(solves_before));
        let steps = u64::from(STEPS);
        let (expected, what) = match claimed {
            PerStep::Exactly(n) => (steps * u64::from(n), format!("{n} a step")),
            // A step without an iteration would be a step without motion.
            PerStep::PerIteration { plus } => (
                solves.max(steps) + steps * u64::from(plus),
                format!("one an iteration and {plus} a step"),
            ),
        };
        let status = if forces == expected {
            CheckStatus::Pass
        } else {
            CheckStatus::Fail
        };
        let message = format!("claims {what}: {forces} in {steps} steps, with {solves} solves");
        let each = |count: u64| count as f64 / f64::from(STEPS);
        Ok(Verdict::new(status, each(forces), each(expected), message))
    },
};
