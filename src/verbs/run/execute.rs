//! Runs the cases in parallel.

use super::plan::{Case, Plan};
use super::program;
use super::record::Record;
use crate::solvers::{Ended, Limits, Status};
use crate::trajectory::{Recorder, SaveError, Unwatched};
use crate::verbs::clock::spread;
use crate::verbs::session::{Label, Session};
use rayon::prelude::*;
use std::time::Instant;

/// All engines in parallel and, beside them, the programs one after the other: they may print and
/// use as many threads as they like.
pub fn all(plan: &Plan, limits: &Limits, session: &dyn Session) -> Result<Vec<Record>, SaveError> {
    let engine = |case: &Case| match case.solver.as_program() {
        None => one(plan, case, limits, session).map(Some),
        Some(_) => Ok(None),
    };
    let program = |case: &Case| {
        let program = case.solver.as_program()?;
        Some(program::one(plan, case, program, limits, session))
    };
    let (ours, theirs) = rayon::join(
        || plan.cases.par_iter().map(engine).collect::<Result<_, _>>(),
        || plan.cases.iter().map(program).collect::<Vec<_>>(),
    );
    let ours: Vec<Option<Record>> = ours?;
    let either = ours.into_iter().zip(theirs).filter_map(|(a, b)| a.or(b));
    Ok(either.collect())
}

fn one(
    plan: &Plan,
    case: &Case,
    limits: &Limits,
    session: &dyn Session,
) -> Result<Record, SaveError> {
    let Label {
        steps, timestep, ..
    } = case.label;
    let mut run = match case.start(plan) {
        Ok(run) => run,
        Err(unsupported) => {
            session.progress(steps);
            return Ok(Record::none(Status::Unsupported, unsupported.reason));
        }
    };
    let dim = 3 * plan.scene.particles.len();
    let mut recorder = Recorder::new(steps, dim, timestep);
    let start = Instant::now();
    let coarse = limits.now_and_then();
    let mut ended = run.finish(&coarse, &mut recorder, &|taken| session.progress(taken));
    let wall = spread(vec![start.elapsed().as_secs_f64()]);
    if ended != Ended::Completed
        && let Ok(again) = case.start(plan)
    {
        // It ended about here; the same bits once more, looked at in every step, say where.
        run = again;
        recorder = Recorder::new(steps, dim, timestep);
        ended = run.finish(limits, &mut recorder, &|_| {});
    }
    if let Some(mut saver) = session.saver(&case.label)? {
        // The same run once more, to the file: bits are the same, and the timed run writes nothing.
        if let Ok(mut again) = case.start(plan) {
            again.finish(limits, saver.as_mut(), &|_| {});
        }
        saver.finish()?;
    }
    let (status, reason, taken) = match ended {
        // No pair runs here, so none is exhausted.
        Ended::Completed | Ended::Exhausted => (Status::Completed, None, steps),
        Ended::Diverged { step, reason } => {
            let reason = format!("in step {}: {reason}", step - 1);
            (Status::Diverged, Some(reason), step)
        }
        Ended::Failed { step, error } => {
            let reason = format!("in step {step}: {error}");
            (Status::Failed, Some(reason), step)
        }
    };
    session.progress(steps.saturating_sub(taken));
    Ok(Record {
        status,
        reason,
        steps: taken,
        trajectory: Some(recorder.finish()),
        counts: run.counts(),
        wall: Some(wall),
        remarks: Vec::new(),
    })
}

/// Repeated at most this often, within this many seconds in all.
const REPEATS: usize = 5;
const PATIENCE: f64 = 0.02;

/// Times the cases again that take less than the patience, one after the other, when nothing else runs;
/// the run that was recorded, beside others, was their warm-up. A longer one keeps the time of that run.
pub fn time_again(plan: &Plan, records: &mut [Record], limits: &Limits) {
    let coarse = limits.now_and_then();
    for (case, record) in plan.cases.iter().zip(records) {
        let Some(wall) = &mut record.wall else {
            continue;
        };
        let mut times = Vec::new();
        while times.len() < REPEATS && times.iter().sum::<f64>() + wall.min < PATIENCE {
            let Ok(mut run) = case.start(plan) else {
                break;
            };
            let start = Instant::now();
            run.finish(&coarse, &mut Unwatched, &|_| {});
            times.push(start.elapsed().as_secs_f64());
        }
        if !times.is_empty() {
            *wall = spread(times);
        }
    }
}
