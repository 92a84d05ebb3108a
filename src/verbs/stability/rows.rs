//! One engine's limits.

use super::{Shared, explain};
use crate::integrators::Method;
use crate::measure::stability::{Limit, Linearised, Prediction, TightestLimit, measure};
use crate::physics::ParticleSystem;
use crate::scene::Scene;
use crate::solvers::{Run, Setting, Solver, SolverKind, Tally, Unsupported};
use crate::verbs::session::Session;
use crate::verbs::stability::StabilityRow;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Budget of the search for one limit, in particles passed over: some ten seconds. A probe takes 20,000
/// steps and a search some twenty probes, so small scenes never reach it. Large ones get shorter probes,
/// and in the end a bracket.
const SEARCH_BUDGET: u64 = 350_000_000;
/// The smallest budget of a search, steps.
const MIN_STEPS: u64 = 2_000;
/// Steps a search usually takes.
const USUAL_STEPS: u64 = 300_000;
/// Steps that are run to take the counts.
const SAMPLE_STEPS: u64 = 4;
/// Costs in passes over all particles: a step without its forces; a pass over damping alone (a vector of a
/// Krylov space, which is kept orthogonal to all others); a linear solve (at most one pass per particle);
/// a step of an engine that does not count.
const STEP: u64 = 10;
const DAMPING: u64 = 5;
const SOLVE: u64 = 100;
const UNCOUNTED: u64 = 150;
/// What a rod costs in a step and in each evaluation, in passes over a particle.
const ROD: u64 = 12;
/// What looking for contact costs in a step and in each evaluation, in passes over a particle.
const CONTACT: u64 = 60;

/// The cost of a step, in passes over all particles, from a few steps of the scene. It is counted, not
/// timed, so that every machine searches alike.
fn passes_per_step(scene: &Scene, solver: &Solver, timestep: f64, tally: &Arc<Tally>) -> u64 {
    let Ok(mut run) = start(solver, scene, timestep, tally) else {
        return STEP;
    };
    // A step that fails ends the sample.
    let _ = run.advance(SAMPLE_STEPS);
    let counts = run.counts();
    let solve = SOLVE.min(scene.particles.len() as u64);
    let Some(forces) = counts.force_evaluations else {
        return STEP + UNCOUNTED.min(10 * scene.particles.len() as u64);
    };
    let rods = ROD * scene.rods.len() as u64 / scene.particles.len().max(1) as u64;
    let contact = if scene.collides() { CONTACT } else { 0 };
    let work = (1 + rods + contact) * forces
        + DAMPING * counts.damping_evaluations.unwrap_or(0)
        + solve * counts.linear_solves.unwrap_or(0);
    STEP + rods + contact + work / run.taken().max(1)
}

/// Steps the search for one limit may take.
fn budget(scene: &Scene, solver: &Solver, timestep: f64, tally: &Arc<Tally>) -> u64 {
    let each =
        scene.particles.len().max(1) as u64 * passes_per_step(scene, solver, timestep, tally);
    (SEARCH_BUDGET / each).max(MIN_STEPS)
}

/// Steps the search for one limit usually takes.
pub fn usual_steps(scene: &Scene, solver: &Solver, timestep: f64) -> u64 {
    budget(scene, solver, timestep, &Arc::default()).min(USUAL_STEPS)
}

/// A new run of a scene at a timestep, s. An integrator's evaluations are added to the tally.
pub fn start(
    solver: &Solver,
    scene: &Scene,
    timestep: f64,
    tally: &Arc<Tally>,
) -> Result<Run, Unsupported> {
    let system = ParticleSystem::new(scene);
    let run = solver.start(scene, &system, &Setting::step(timestep))?;
    Ok(match solver.kind {
        SolverKind::Integrator => run.tallied(tally),
        SolverKind::Rapier | SolverKind::External => run,
    })
}

/// The method whose step a solver takes, and how often in one timestep.
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
    // An engine that cannot run the scene has no limit to search for.
    if let Err(unsupported) = start(scene, timestep) {
        row.unsupported = true;
        let why = format!("unsupported: {}", unsupported.reason);
        row.remarks.push(why);
    } else {
        let along = row.tightest.as_ref().map(|tightest| tightest.limit_s);
        let near = [predicted_limit_s, along].into_iter().flatten();
        let near = near.filter(|h| *h > 0.0).reduce(f64::min);
        let budget = budget(scene, solver, timestep, &shared.tally);
        // A row counts as what it usually takes, neither more nor less, so that what is left only falls.
        let usual = budget.min(USUAL_STEPS);
        let left = AtomicU64::new(usual);
        let tick = |steps: u64| {
            let less = |left: u64| Some(left.saturating_sub(steps));
            let before = left.fetch_update(Relaxed, Relaxed, less).unwrap_or(0);
            session.progress(steps.min(before));
        };
        let measured = measure(scene, &shared.system, &start, timestep, near, budget, &tick);
        session.progress(left.into_inner());
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

/// The prediction for the method a solver follows, at the solver's substep; limits are of a whole step.
pub fn predicted(linearised: &Linearised, solver: &Solver, timestep: f64) -> Option<Prediction> {
    let (method, substeps) = follows(solver)?;
    let mut prediction = linearised.predict(method, timestep / substeps);
    if let Limit::At(limit) = &mut prediction.limit {
        *limit *= substeps;
    }
    if substeps > 1.0 {
        // A sign that changes twice within a step is not seen.
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

/// A limit as two keys of the report: the number, s, and whether every step is stable.
pub fn as_keys(limit: &Limit) -> (Option<f64>, bool) {
    match limit {
        Limit::Never => (Some(0.0), false),
        Limit::At(h) => (Some(*h).filter(|h| h.is_finite()), false),
        Limit::Unconditional => (None, true),
        Limit::Between(..) | Limit::Unknown(_) => (None, false),
    }
}

/// A growth rate, where it is finite and positive.
fn growth(per_s: Option<f64>) -> Option<f64> {
    finite(per_s).filter(|rate| *rate > 0.0)
}

fn finite(value: Option<f64>) -> Option<f64> {
    value.filter(|value| value.is_finite())
}
