//! What the runs of a plan take, and what judging them may take: together no more than the runs. Both are counted
//! in steps of one particle under explicit forces, so that every machine judges alike.

use super::plan::{Case, Plan};
use crate::integrators::{self, Coefficients, Method, PerStep};
use crate::measure::identify::solve_effort;
use crate::measure::{Check, CheckStatus};
use crate::scene::Scene;
use crate::solvers::SolverKind;

/// Judging may take this much however short the runs: some 0.3 s, at 30 ns.
const LEAST: u64 = 10_000_000;
/// Newton's iterations of a step, about.
const ITERATIONS: u64 = 3;
/// What a step of rapier takes each body and joint, and what each substep takes again.
const WORLD: u64 = 8;
const SUBSTEP: u64 = 3;

/// What a step of a method takes one of so many particles.
fn each(method: &Method, particles: u64) -> u64 {
    match (method.coefficients, method.evaluations) {
        (Coefficients::Implicit(_), PerStep::Exactly(_)) => solve_effort(particles),
        (Coefficients::Implicit(_), PerStep::PerIteration { .. }) => {
            ITERATIONS * solve_effort(particles)
        }
        _ => 1,
    }
}

impl Case {
    /// What one of its steps takes. Other programs are not counted.
    pub fn step(&self, scene: &Scene) -> u64 {
        let (particles, springs) = (scene.particles.len() as u64, scene.springs.len() as u64);
        match self.solver.kind {
            SolverKind::External => 0,
            SolverKind::Rapier => {
                (particles + springs) * (WORLD + SUBSTEP * u64::from(self.solver.substeps))
            }
            SolverKind::Integrator => {
                let method = self.solver.as_method();
                particles * method.map_or(1, |method| each(method, particles))
            }
        }
    }

    /// What all of it takes.
    pub fn effort(&self, scene: &Scene) -> u64 {
        self.label.steps.saturating_mul(self.step(scene))
    }

    /// What a replay of one of its steps takes by the scheme that it is known to follow.
    pub fn replay(&self, scene: &Scene) -> u64 {
        let particles = scene.particles.len() as u64;
        let law = self.solver.law(scene);
        let (each, substeps) = law.map_or((1, 1), |(id, substeps)| {
            let method = integrators::find(id);
            let each = method.map_or(1, |method| each(method, particles));
            (each, u64::from(substeps))
        });
        particles.saturating_mul(each * substeps)
    }
}

impl Plan<'_> {
    /// What all of its runs take.
    pub fn effort(&self) -> u64 {
        let efforts = self.cases.iter().map(|case| case.effort(self.scene));
        efforts.fold(0, u64::saturating_add)
    }

    /// What the runs of its integrators take.
    pub fn effort_of_integrators(&self) -> u64 {
        let cases = self
            .cases
            .iter()
            .filter(|case| case.solver.kind == SolverKind::Integrator);
        let efforts = cases.map(|case| case.effort(self.scene));
        efforts.fold(0, u64::saturating_add)
    }
}

/// What the twin proof may take: half of all runs.
pub fn of_proofs(plan: &Plan) -> u64 {
    (plan.effort() / 2).max(LEAST)
}

/// What the prediction of limits may take: a quarter of all runs.
pub fn of_limits(plan: &Plan) -> u64 {
    (plan.effort() / 4).max(LEAST)
}

/// What replays of one run may take: a quarter of it.
pub fn of_replays(plan: &Plan, case: &Case) -> u64 {
    (case.effort(plan.scene) / 4).max(LEAST)
}

/// The check that says what was not judged; None where everything was.
pub fn left_out(what: Vec<String>) -> Option<Check> {
    (!what.is_empty()).then(|| Check {
        id: "judging".to_owned(),
        subject: "scene".to_owned(),
        status: CheckStatus::Skip,
        measured: None,
        bound: None,
        derivation: "judging takes no longer than the runs".to_owned(),
        message: format!(
            "left out, since it would take longer than the runs themselves: {}",
            what.join(", ")
        ),
        ..Check::default()
    })
}
