//! One engine's limits.

use super::{Shared, explain};
use crate::integrators::Method;
use crate::measure::stability::{Limit, Linearised, Prediction, TightestLimit, measure};
use crate::physics::ParticleSystem;
use crate::scene::Scene;
use crate::solvers::{Kind, Run, Setting, Solver, Tally, Unsupported};
use crate::verbs::session::Session;
use crate::verbs::stability::StabilityRow;
use std::sync::Arc;

/// Work the search for one limit may take, in particles passed over: some ten seconds. A probe takes
/// 20,000 steps and a search some twenty probes, so small scenes never meet it; large ones get shorter
/// probes, and in the end a bracket.
const PATIENCE: u64 = 350_000_000;
/// But never fewer steps than this.
const LEAST: u64 = 2_000;
/// What a search mostly takes.
const USUAL: u64 = 300_000;
/// Steps a price is taken from.
const SAMPLE: u64 = 4;
/// What a step costs beside its forces, and what a pass over damping alone (a vector of a Krylov
/// space, to be kept orthogonal to all others), a linear solve (of a small scene its particles), and a
/// step of an engine that does not count, in passes over all particles.
const BESIDE: u64 = 10;
const DAMPING: u64 = 5;
const SOLVE: u64 = 100;
const UNCOUNTED: u64 = 150;

/// Passes over all particles a step takes, from a few steps of the scene: counted, not timed, so that
/// every machine searches alike.
fn price(scene: &Scene, solver: &Solver, timestep: f64, tally: &Arc<Tally>) -> u64 {
    let Ok(mut run) = start(solver, scene, timestep, tally) else {
        return BESIDE;
    };
    // A step that fails ends the sample.
    let _ = run.advance(SAMPLE);
    let counts = run.counts();
    let solve = SOLVE.min(scene.particles.len() as u64);
    let Some(forces) = counts.force_evaluations else {
        return BESIDE + UNCOUNTED.min(10 * scene.particles.len() as u64);
    };
    let work = forces
        + DAMPING * counts.damping_evaluations.unwrap_or(0)
        + solve * counts.linear_solves.unwrap_or(0);
    BESIDE + work / run.taken().max(1)
}

/// Steps the search for one limit may take.
fn patience(scene: &Scene, solver: &Solver, timestep: f64, tally: &Arc<Tally>) -> u64 {
    let each = scene.particles.len().max(1) as u64 * price(scene, solver, timestep, tally);
    (PATIENCE / each).max(LEAST)
}

/// Steps it mostly takes.
pub fn usual(scene: &Scene, solver: &Solver, timestep: f64) -> u64 {
    patience(scene, solver, timestep, &Arc::default()).min(USUAL)
}

/// A fresh run of a scene at a step, s, counted with the others where it is an integrator's.
pub fn start(
    solver: &Solver,
    scene: &Scene,
    timestep: f64,
    tally: &Arc<Tally>,
) -> Result<Run, Unsupported> {
    let system = ParticleSystem::new(scene);
    let run = solver.start(scene, &system, &Setting::step(timestep))?;
    Ok(match solver.kind {
        Kind::Integrator => run.tallied(tally),
        Kind::Rapier | Kind::External => run,
    })
}

/// The method whose step a solver takes, as often as this in one timestep.
fn follows(solver: &Solver) -> Option<(&'static Method, f64)> {
    Some((solver.follows?, f64::from(solver.substeps)))
}

pub fn row(shared: &Shared, solver: &Solver, session: &dyn Session) -> StabilityRow {
    let (scene, timestep) = (shared.plan.scene, shared.plan.timestep);
    let start = |scene: &Scene, h| start(solver, scene, h, &shared.tally);
    let predicted = predicted(&shared.linearised, solver, timestep);
    let keys = predicted
        .as_ref()
        .map(|predicted| as_keys(&predicted.limit));
    let (predicted_limit_s, unconditional) = keys.unwrap_or_default();
    let tightest = tightest(shared, solver);
    let mut row = StabilityRow {
        engine: solver.id.to_string(),
        kind: solver.kind,
        unsupported: false,
        predicted_limit_s,
        measured_limit_s: None,
        measured_between_s: None,
        unconditional,
        measured_unconditional: false,
        growth_per_s: predicted.as_ref().and_then(|p| growth(p.growth_per_s)),
        measured_growth_per_s: None,
        smooth_below_s: predicted.as_ref().and_then(|p| finite(p.smooth_below_s)),
        measured_smooth_below_s: None,
        tightest,
        reason: None,
        remarks: Vec::new(),
    };
    // Asked before anything is searched: what cannot run has no limit to be found.
    if let Err(unsupported) = start(scene, timestep) {
        row.unsupported = true;
        let why = format!("unsupported: {}", unsupported.reason);
        row.remarks.push(why);
    } else {
        let along = row.tightest.as_ref().map(|tightest| tightest.limit_s);
        let near = [predicted_limit_s, along].into_iter().flatten();
        let near = near.filter(|h| *h > 0.0).reduce(f64::min);
        let patience = patience(scene, solver, timestep, &shared.tally);
        let tick = |steps| session.progress(steps);
        let measured = measure(
            scene,
            &shared.system,
            &start,
            timestep,
            near,
            patience,
            &tick,
        );
        (row.measured_limit_s, row.measured_unconditional) = as_keys(&measured.limit);
        if let Limit::Between(low, high) = measured.limit {
            row.measured_between_s = Some([low, high]);
        }
        row.measured_growth_per_s = growth(measured.growth_per_s);
        row.measured_smooth_below_s = finite(measured.smooth_below_s);
        row.remarks = explain::remarks(shared, solver, &row, predicted.as_ref(), &measured);
    }
    row.reason = (!row.remarks.is_empty()).then(|| row.remarks.join("; "));
    row
}

/// What the method it follows does to the linearised scene, at its own substep.
pub fn predicted(linearised: &Linearised, solver: &Solver, timestep: f64) -> Option<Prediction> {
    let (method, substeps) = follows(solver)?;
    let mut prediction = linearised.predict(method, timestep / substeps);
    if let Limit::At(limit) = &mut prediction.limit {
        *limit *= substeps;
    }
    if substeps > 1.0 {
        // Signs that change twice within a step are not seen.
        prediction.smooth_below_s = None;
    }
    Some(prediction)
}

fn tightest(shared: &Shared, solver: &Solver) -> Option<TightestLimit> {
    let (method, substeps) = follows(solver)?;
    let TightestLimit { limit_s, t_s } = shared.path.along.as_ref()?.tightest(method)?;
    let limit_s = limit_s * substeps;
    (limit_s.is_finite() && t_s.is_finite()).then_some(TightestLimit { limit_s, t_s })
}

/// Limit and whether there is none, as the report's keys have it.
pub fn as_keys(limit: &Limit) -> (Option<f64>, bool) {
    match limit {
        Limit::Never => (Some(0.0), false),
        Limit::At(h) => (Some(*h).filter(|h| h.is_finite()), false),
        Limit::Unconditional => (None, true),
        Limit::Between(..) | Limit::Unknown(_) => (None, false),
    }
}

/// Growth is stated where there is some.
fn growth(per_s: Option<f64>) -> Option<f64> {
    finite(per_s).filter(|rate| *rate > 0.0)
}

fn finite(value: Option<f64>) -> Option<f64> {
    value.filter(|value| value.is_finite())
}
