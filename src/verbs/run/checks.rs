//! The checks of a plan beside its runs: the twin proof, and the order each integrator shows on the scene.

use super::budget;
use super::plan::{Case, Orders, Plan};
use crate::integrators::Method;
use crate::measure::order::{Study, check};
use crate::measure::twin;
use crate::measure::{Check, CheckStatus};
use crate::physics::System;
use crate::solvers::SolverKind;
use crate::truth::Truth;
use rayon::prelude::*;

/// The twin proof: rapier's world and the hand-written one are the same scene, by a few steps of it. Empty where
/// the choice does not want it, and where rapier does not run.
pub fn proofs(plan: &Plan) -> Vec<Check> {
    if !proves(plan) {
        return Vec::new();
    }
    let timestep = plan.scene.solver.timestep;
    let mut proofs = twin::prove_within(plan.scene, timestep, budget::of_proofs(plan));
    if (plan.cases.iter()).any(|case| case.solver.id == "rapier-user-forces") {
        proofs.push(twin::prove_user_forces(plan.scene, plan.scene, timestep));
    }
    proofs
}

/// Whether a plan calls for the twin proof.
pub fn proves(plan: &Plan) -> bool {
    let is_rapier = |case: &Case| case.solver.kind == SolverKind::Rapier;
    plan.choice.prove && plan.cases.iter().any(is_rapier)
}

/// Steps times coordinates of the scene's own run up to which orders are measured by default. Measuring
/// costs about two such runs.
const MAX_DEFAULT_COST: u64 = 500_000;
/// The budget of one method, in runs of the scene.
const BUDGET_RUNS: u64 = 4;
/// The least budget of one method, in steps times coordinates.
const MIN_BUDGET: u64 = 1_000_000;

/// The cost of the scene's own run, in steps times coordinates.
fn cost(plan: &Plan) -> u64 {
    let steps = plan.scene.steps(plan.scene.solver.timestep);
    steps.saturating_mul(plan.system.dim() as u64)
}

/// Whether a plan calls for orders, if there is a truth.
pub fn measures_orders(plan: &Plan) -> bool {
    match plan.choice.order {
        Orders::Never => false,
        // There is no truth, however long one looks.
        _ if plan.system.strain_limiter().is_some() => false,
        Orders::Always => true,
        Orders::WhereCheap => cost(plan) <= MAX_DEFAULT_COST,
    }
}

/// A check of the observed order for each integrator, or one check that says why none was made. Empty without a truth.
pub fn orders(plan: &Plan, truth: &Truth) -> Vec<Check> {
    let (Some(motion), scene) = (truth.motion(), plan.scene) else {
        return Vec::new();
    };
    let mut methods: Vec<&Method> = Vec::new();
    // A method that refuses the scene's forces has no order here.
    let takes = |method: &&Method| plan.system.admits(method.id, method.takes()).is_ok();
    let all = plan.cases.iter().filter_map(|case| case.solver.as_method());
    for method in all.filter(takes) {
        if !methods.iter().any(|known| known.id == method.id) {
            methods.push(method);
        }
    }
    let cost = cost(plan);
    if methods.is_empty() || plan.choice.order == Orders::Never {
        return Vec::new();
    }
    if !measures_orders(plan) {
        return vec![skipped()];
    }
    let until = truth.horizon.min(scene.duration);
    let budget = BUDGET_RUNS.saturating_mul(cost).max(MIN_BUDGET);
    let study = Study::of_scene(scene, &plan.system, motion, until).budget(budget);
    let measure = |method: &&Method| check(method.id, &study.method(method));
    methods.par_iter().map(measure).collect()
}

fn skipped() -> Check {
    Check {
        id: "order".to_owned(),
        subject: "integrators".to_owned(),
        status: CheckStatus::Skip,
        measured: None,
        bound: None,
        derivation: "slopes of the error over the step".to_owned(),
        message:
            "not measured on a run this long, which it would make three times as long: --order \
                  asks for it"
                .to_owned(),
        ..Check::default()
    }
}
