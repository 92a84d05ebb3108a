//! The identity of each trajectory: the scheme it follows.

use super::budget;
use super::plan::{Case, Plan};
use super::program::begin_with;
use crate::integrators::Settings;
use crate::measure::identify::{
    Deviation, Fault, Found, Question, first_fault, identify, moved_anchor,
};
use crate::physics::ParticleSystem;
use crate::solvers::SolverKind;
use crate::trajectory::{Rows, Trajectory};
use std::borrow::Cow;

/// The number of a run's steps that are replayed: enough to identify it, few enough to be quick. A file is
/// replayed whole.
const TRANSITIONS: usize = 16;
/// The fewest steps that identify it.
const FEWEST: usize = 3;

/// Steps times particles that may be replayed of a file, which is judged for its own sake: some seconds.
const OF_FILE: u64 = 20_000_000;

/// Identifies the scheme of a run by replaying some of its steps; None where the scheme that it should follow takes
/// more than the budget to replay.
pub fn of_run(plan: &Plan, case: &Case, run: &Trajectory) -> Option<Found> {
    // That is no scheme of ours, and to search for one takes longer than the run.
    if own_law(plan, case).is_some() {
        return Some(Found::default());
    }
    let budget = budget::of_replays(plan, case);
    // A step is replayed twice, once with every number off by its rounding, and half of the budget is for others.
    let each = 4 * case.replay(plan.scene).max(1);
    let question = Question {
        transitions: Some(((budget / each) as usize).clamp(FEWEST, TRANSITIONS)),
        hint: case.solver.law(plan.scene),
        budget,
        ..question(plan, run.rows())
    };
    (FEWEST as u64 * each <= budget).then(|| identify(&question))
}

/// What a rapier world does by a law of its own, for its row: rods are joints there, and its contact is soft.
pub fn own_law(plan: &Plan, case: &Case) -> Option<&'static str> {
    match (case.solver.kind, plan.scene) {
        (SolverKind::Rapier, scene) if !scene.rods.is_empty() => Some(
            "its rods are spring joints of 1e9 N/m, which rapier's sweeps solve in part: distance from it is no error of yours",
        ),
        (SolverKind::Rapier, scene) if scene.collides() => Some(
            "its contact acts once a step, from the velocity at its start, and rests a little inside: distance from it is no \
             error of yours",
        ),
        _ => None,
    }
}

/// Identifies the scheme of rows by replaying all their steps, and finds the first step that deviates from it.
pub fn of_rows(plan: &Plan, rows: &Rows) -> (Found, Option<Fault>) {
    let rows = &from_the_start(plan, rows);
    let question = question(plan, rows);
    // A fixed particle must not move under any scheme.
    let moved = moved_anchor(plan.scene, rows);
    let found = identify(&question);
    let moved = moved.map(|fault| driven_as(fault, &found));
    let fault = moved.or_else(|| {
        let identity = found.identity.as_ref()?;
        first_fault(&question, identity)
    });
    (found, fault)
}

/// The fault of a driven particle, with the number of its motion that is wrong, where forces tell it.
fn driven_as(fault: Fault, found: &Found) -> Fault {
    let deviations = found.explained.iter().flat_map(|e| &e.deviations);
    let drives = |d: &&Deviation| d.what.starts_with("driven.");
    match deviations.into_iter().find(drives) {
        Some(deviation) => Fault {
            explanation: format!("particle {}: {}", fault.particle, deviation.sentence),
            ..fault
        },
        None => fault,
    }
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
        budget: OF_FILE,
        hint: None,
    }
}
