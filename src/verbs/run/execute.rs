//! Runs the cases in parallel.

use super::plan::{Case, Plan};
use super::program;
use super::ran::{Ran, Run};
use crate::solvers::Status;
use crate::solvers::external::Program;
use crate::solvers::{Ended, Limits};
use crate::trajectory::{Recorder, SaveError, Unwatched};
use crate::verbs::clock::{WallTime, spread};
use crate::verbs::host::{Host, Label};
use rayon::prelude::*;
use std::time::Instant;

/// All engines in parallel and, beside them, the programs one after the other: they may print and
/// use as many threads as they like.
pub fn all(plan: &Plan, limits: &Limits, host: &dyn Host) -> Result<Vec<Run>, SaveError> {
    let mut engines: Vec<(usize, &Case)> = Vec::new();
    let mut programs: Vec<(usize, &Case, &dyn Program)> = Vec::new();
    for (at, case) in plan.cases.iter().enumerate() {
        match case.solver.as_program() {
            None => engines.push((at, case)),
            Some(program) => programs.push((at, case, program)),
        }
    }
    let (ours, theirs) = rayon::join(
        || -> Result<Vec<(usize, Run)>, SaveError> {
            let engines = engines.par_iter();
            engines
                .map(|(at, case)| Ok((*at, one(plan, case, limits, host)?)))
                .collect()
        },
        || -> Vec<(usize, Run)> {
            let programs = programs.iter();
            programs
                .map(|(at, case, program)| (*at, program::one(plan, case, *program, limits, host)))
                .collect()
        },
    );
    let mut runs = ours?;
    runs.extend(theirs);
    runs.sort_by_key(|(at, _)| *at);
    Ok(runs.into_iter().map(|(_, run)| run).collect())
}

/// Times short runs again, one after the other, when nothing else runs.
pub fn time_again(plan: &Plan, runs: &mut [Run], limits: &Limits) {
    for (case, run) in plan.cases.iter().zip(runs) {
        if let Run::Ran(ran) = run
            && let Some(wall) = &mut ran.wall
        {
            time(plan, case, limits, wall);
        }
    }
}

fn one(plan: &Plan, case: &Case, limits: &Limits, host: &dyn Host) -> Result<Run, SaveError> {
    let Label {
        steps, timestep, ..
    } = case.label;
    let mut run = match case.start(plan) {
        Ok(run) => run,
        Err(unsupported) => {
            host.progress(steps);
            return Ok(Run::Unsupported(unsupported));
        }
    };
    let dim = 3 * plan.scene.particles.len();
    let mut recorder = Recorder::new(steps, dim, timestep);
    let start = Instant::now();
    let coarse = limits.now_and_then();
    let mut ended = run.finish(&coarse, &mut recorder, &|taken| host.progress(taken));
    let first = start.elapsed().as_secs_f64();
    if ended != Ended::Completed
        && let Ok(again) = case.start(plan)
    {
        // It ended about here; the same bits once more, looked at in every step, say where.
        run = again;
        recorder = Recorder::new(steps, dim, timestep);
        ended = run.finish(limits, &mut recorder, &|_| {});
    }
    if let Some(mut saver) = host.saver(&case.label)? {
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
        Ended::Failed { step, error } => (
            Status::Failed,
            Some(format!("in step {step}: {error}")),
            step,
        ),
    };
    host.progress(steps.saturating_sub(taken));
    Ok(Run::Ran(Box::new(Ran {
        status,
        reason,
        steps: taken,
        trajectory: recorder.finish(),
        counts: run.counts(),
        wall: Some(WallTime {
            min: first,
            median: first,
            mad: None,
        }),
        remarks: Vec::new(),
    })))
}

/// Repeated at most this often, within this many seconds in all.
const REPEATS: usize = 5;
const PATIENCE: f64 = 0.02;

/// Times a case that takes less than the patience; the run that was recorded, beside others, was its
/// warm-up. A longer one keeps the time of that run.
fn time(plan: &Plan, case: &Case, limits: &Limits, wall: &mut WallTime) {
    let mut times = Vec::new();
    let coarse = limits.now_and_then();
    while times.len() < REPEATS && times.iter().sum::<f64>() + wall.min < PATIENCE {
        let Ok(mut run) = case.start(plan) else {
            return;
        };
        let start = Instant::now();
        run.finish(&coarse, &mut Unwatched, &|_| {});
        times.push(start.elapsed().as_secs_f64());
    }
    if times.is_empty() {
        return;
    }
    *wall = spread(times);
}
