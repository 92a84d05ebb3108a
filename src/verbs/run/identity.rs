//! The identity of each trajectory: the scheme it follows.

use super::plan::{Case, Plan};
use super::program::begin_with;
use crate::integrators::Settings;
use crate::measure::identify::{Fault, Identified, Question, first_fault, identify, moved_anchor};
use crate::physics::ParticleSystem;
use crate::solvers::SolverKind;
use crate::trajectory::{Rows, Trajectory};
use std::borrow::Cow;

/// The number of a run's steps that are replayed: enough to identify it, few enough to be quick. A file is
/// replayed whole.
const TRANSITIONS: usize = 16;

/// Identifies the scheme of a run by replaying some of its steps.
pub fn of_run(plan: &Plan, case: &Case, run: &Trajectory) -> Option<Identified> {
    let question = Question {
        transitions: Some(TRANSITIONS),
        hint: expected(plan, case),
        ..question(plan, run.rows())
    };
    identify(&question)?.report()
}

/// The scheme and number of substeps that a run is expected to follow.
fn expected(plan: &Plan, case: &Case) -> Option<(&'static str, u32)> {
    let joints = case.solver.kind == SolverKind::Rapier && plan.scene.springs.len() > 1;
    let rapier = joints.then_some(("linearized_implicit_material", case.solver.substeps));
    case.solver
        .as_method()
        .map(|method| (method.id, 1))
        .or(rapier)
}

/// Identifies the scheme of rows by replaying all their steps, and finds the first step that deviates from it.
pub fn of_rows(plan: &Plan, rows: &Rows) -> (Option<Identified>, Option<Fault>) {
    let rows = &from_the_start(plan, rows);
    let question = question(plan, rows);
    // A fixed particle must not move under any scheme.
    let moved = moved_anchor(plan.scene, rows);
    let Some(identity) = identify(&question) else {
        return (None, moved);
    };
    let fault = moved.or_else(|| first_fault(&question, &identity));
    (identity.report(), fault)
}

/// The rows, preceded by the scene's start where they begin a few steps later: those steps are replayed, too.
fn from_the_start<'a>(plan: &Plan, rows: &'a Rows) -> Cow<'a, Rows> {
    let longest = rows.steps.windows(2).map(|pair| pair[1] - pair[0]).max();
    let first = rows.steps.first().copied().unwrap_or(0);
    if first == 0 || first > longest.unwrap_or(0) {
        return Cow::Borrowed(rows);
    }
    let mut rows = rows.clone();
    begin_with(&mut rows, &ParticleSystem::initial_state(plan.scene));
    Cow::Owned(rows)
}

fn question<'a>(plan: &'a Plan, rows: &'a Rows) -> Question<'a> {
    Question {
        scene: plan.scene,
        system: &plan.system,
        rows,
        settings: Settings::stated(plan.scene.solver.tolerance),
        transitions: None,
        hint: None,
    }
}
