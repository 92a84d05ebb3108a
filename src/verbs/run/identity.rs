//! The identity of each trajectory: the scheme it follows.

use super::plan::{Case, Plan};
use super::program::begin_with;
use crate::integrators::Settings;
use crate::measure::identify::{Fault, Found, Question, first_fault, identify, moved_anchor};
use crate::physics::ParticleSystem;
use crate::trajectory::{Rows, Trajectory};
use std::borrow::Cow;

/// The number of a run's steps that are replayed: enough to identify it, few enough to be quick. A file is
/// replayed whole.
const TRANSITIONS: usize = 16;

/// Steps times particles that may be replayed whatever a run took: some hundredths of a second.
const LEAST: u64 = 1_000_000;
/// The same for a file, which is judged for its own sake: some seconds.
const OF_FILE: u64 = 20_000_000;

/// Identifies the scheme of a run by replaying some of its steps, at no more cost than the run's own.
pub fn of_run(plan: &Plan, case: &Case, run: &Trajectory) -> Found {
    let steps = run.rows().steps.last().copied().unwrap_or(0);
    let particles = plan.scene.particles.len() as u64;
    let question = Question {
        transitions: Some(TRANSITIONS),
        hint: case.solver.law(plan.scene),
        budget: steps.saturating_mul(particles).max(LEAST),
        ..question(plan, run.rows())
    };
    identify(&question)
}

/// Identifies the scheme of rows by replaying all their steps, and finds the first step that deviates from it.
pub fn of_rows(plan: &Plan, rows: &Rows) -> (Found, Option<Fault>) {
    let rows = &from_the_start(plan, rows);
    let question = question(plan, rows);
    // A fixed particle must not move under any scheme.
    let moved = moved_anchor(plan.scene, rows);
    let found = identify(&question);
    let fault = moved.or_else(|| {
        let identity = found.identity.as_ref()?;
        first_fault(&question, identity)
    });
    (found, fault)
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
