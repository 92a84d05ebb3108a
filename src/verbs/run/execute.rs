//! Runs the cases in parallel.

use super::plan::{Case, Plan};
use super::program;
use super::record::Record;
use crate::solvers::{Ended, Limits, Status};
use crate::trajectory::{Recorder, SaveError, Unwatched};
use crate::verbs::clock::spread;
use crate::verbs::session::{Label, Session};
use rayon::prelude::*;
use std::cell::Cell;
use std::time::Instant;

/// Runs all engines in parallel and, at the same time, the external programs one after the other: these may
/// print and use as many threads as they like.
pub fn all(plan: &Plan, limits: &Limits, session: &dyn Session) -> Result<Vec<Record>, SaveError> {
    let engine = |case: &Case| match case.solver.as_program() {
        None => one(plan, case, limits, session).map(Some),
        Some(_) => Ok(None),
    };
    let program = |case: &Case| {
        let program = case.solver.as_program()?;
        Some(program::one(plan, case, program, limits))
    };
    let (engines, programs) = rayon::join(
        || plan.cases.par_iter().map(engine).collect::<Result<_, _>>(),
        || plan.cases.iter().map(program).collect::<Vec<_>>(),
    );
    let engines: Vec<Option<Record>> = engines?;
    let records = engines.into_iter().zip(programs);
    Ok(records.filter_map(|(a, b)| a.or(b)).collect())
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
    let each = case.step(plan.scene);
    let progress = |taken: u64| session.progress(taken.saturating_mul(each));
    // A run that ends early has not reported all of its steps.
    let reported = Cell::new(0);
    let tick = |taken: u64| {
        reported.set(reported.get() + taken);
        progress(taken);
    };
    let rest = || progress(steps.saturating_sub(reported.replace(0)));
    let mut run = match case.start(plan) {
        Ok(run) => run,
        Err(unsupported) => {
            progress(steps);
            return Ok(Record::none(Status::Unsupported, unsupported.reason));
        }
    };
    let dim = 3 * plan.scene.particles.len();
    let mut recorder = Recorder::new(steps, dim, timestep);
    let start = Instant::now();
    let coarse = limits.coarse();
    let mut ended = run.finish(&coarse, &mut recorder, &tick);
    rest();
    let wall = spread(vec![start.elapsed().as_secs_f64()]);
    if ended != Ended::Completed
        && let Ok(again) = case.start(plan)
    {
        // The coarse limits saw only about where it ended. The same run again, checked in every step, finds the step.
        run = again;
        recorder = Recorder::new(steps, dim, timestep);
        ended = run.finish(limits, &mut recorder, &|_| {});
    }
    if let Some(mut saver) = session.saver(&case.label)? {
        // The same run again writes the file: the bits are the same, and the timed run writes nothing.
        if let Ok(mut again) = case.start(plan) {
            again.finish(limits, saver.as_mut(), &tick);
        }
        rest();
        saver.finish()?;
    }
    let (status, reason, taken) = match ended {
        // Only adaptive pairs exhaust their budget, and none runs here.
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

/// The number of repeated runs of one case, at most, and the time budget for them, s.
const MAX_REPEATS: usize = 5;
const TIME_BUDGET: f64 = 0.02;

/// Times the cases that fit the budget again, one after the other, while nothing else runs. Their recorded run,
/// which ran beside others, was the warm-up. A longer case keeps the time of its recorded run.
pub fn time_again(plan: &Plan, records: &mut [Record], limits: &Limits) {
    let coarse = limits.coarse();
    for (case, record) in plan.cases.iter().zip(records) {
        let Some(wall) = &mut record.wall else {
            continue;
        };
        let mut times = Vec::new();
        while times.len() < MAX_REPEATS && times.iter().sum::<f64>() + wall.min < TIME_BUDGET {
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
