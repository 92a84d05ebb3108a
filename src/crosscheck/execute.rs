//! Runs the cases in parallel.

use super::plan::{Build, Case, Label, Plan, Source};
use super::program;
use crate::engines::external::Program;
use crate::engines::{Counts, Ended, Limits, Observer, Unsupported, simulate};
use crate::outcome::{Status, WallTime};
use crate::system::State;
use crate::trajectory::{Recorder, SaveError, Trajectory};
use crate::truth::{NoStore, Store};
use rayon::prelude::*;
use std::time::Instant;

/// What a run needs from the outside: files to save to, somebody to show progress.
pub trait Host: Sync {
    /// Where every step of this case goes; None if nowhere.
    ///
    /// # Errors
    /// When the file cannot be made.
    fn saver(&self, case: &Label) -> Result<Option<Box<dyn Saver>>, SaveError>;

    /// So much more is done, in the units of the plan: steps, or nominal microseconds.
    fn progress(&self, steps: u64);

    /// Where truths are kept from one run to the next.
    fn store(&self) -> &dyn Store {
        &NoStore
    }
}

/// Saves a run as it goes.
pub trait Saver: Observer {
    /// Completes the file.
    ///
    /// # Errors
    /// The first failure, whenever it happened.
    fn finish(self: Box<Self>) -> Result<(), SaveError>;
}

/// A host that saves nothing and shows nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct Quiet;

impl Host for Quiet {
    fn saver(&self, _case: &Label) -> Result<Option<Box<dyn Saver>>, SaveError> {
        Ok(None)
    }

    fn progress(&self, _steps: u64) {}
}

/// What one case left.
pub(super) enum Run {
    Unsupported(Unsupported),
    /// Nothing is known of it but why.
    Failed(String),
    Ran(Box<Ran>),
}

/// A case that ran, to its end or not.
pub(super) struct Ran {
    pub status: Status,
    /// Why it did not run to its end.
    pub reason: Option<String>,
    /// Steps taken.
    pub steps: u64,
    pub trajectory: Trajectory,
    pub counts: Counts,
    /// None of a file.
    pub wall: Option<WallTime>,
    /// What else is to be said of it.
    pub remarks: Vec<String>,
}

/// All engines in parallel and, beside them, the programs one after the other: they may print and
/// use as many threads as they like.
pub(super) fn all(plan: &Plan, limits: &Limits, host: &dyn Host) -> Result<Vec<Run>, SaveError> {
    let dim = 3 * plan.scene.particles.len();
    let mut engines: Vec<(usize, &Case, &Build)> = Vec::new();
    let mut programs: Vec<(usize, &Case, &dyn Program)> = Vec::new();
    for (at, case) in plan.cases.iter().enumerate() {
        match &case.source {
            Source::Engine(build) => engines.push((at, case, build)),
            Source::Program(program) => programs.push((at, case, program.as_ref())),
        }
    }
    let (ours, theirs) = rayon::join(
        || -> Result<Vec<(usize, Run)>, SaveError> {
            let engines = engines.par_iter();
            engines
                .map(|(at, case, build)| Ok((*at, one(case, build, dim, limits, host)?)))
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
pub(super) fn time_again(cases: &[Case], runs: &mut [Run], limits: &Limits) {
    for (case, run) in cases.iter().zip(runs) {
        if let (Some(build), Run::Ran(ran)) = (case.source.engine(), run)
            && let Some(wall) = &mut ran.wall
        {
            time(case, build, limits, wall);
        }
    }
}

fn one(
    case: &Case,
    build: &Build,
    dim: usize,
    limits: &Limits,
    host: &dyn Host,
) -> Result<Run, SaveError> {
    let mut engine = match build() {
        Ok(engine) => engine,
        Err(unsupported) => {
            host.progress(case.label.steps);
            return Ok(Run::Unsupported(unsupported));
        }
    };
    let Label {
        steps, timestep, ..
    } = case.label;
    let tick = |taken| host.progress(taken);
    let mut recorder = Recorder::new(steps, dim, timestep);
    let start = Instant::now();
    let coarse = limits.now_and_then();
    let mut ended = simulate(engine.as_mut(), steps, &coarse, &mut recorder, &tick);
    let first = start.elapsed().as_secs_f64();
    if ended != Ended::Completed
        && let Ok(again) = build()
    {
        // It ended about here; the same bits once more, looked at in every step, say where.
        engine = again;
        recorder = Recorder::new(steps, dim, timestep);
        ended = simulate(engine.as_mut(), steps, limits, &mut recorder, &|_| {});
    }
    if let Some(mut saver) = host.saver(&case.label)? {
        save(case, build, limits, saver.as_mut());
        saver.finish()?;
    }
    let (status, reason, taken) = match ended {
        Ended::Completed => (Status::Completed, None, steps),
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
        counts: engine.counts(),
        wall: Some(WallTime {
            min: first,
            median: first,
            mad: None,
        }),
        remarks: Vec::new(),
    })))
}

/// The same run once more, to the file: bits are the same, and the timed run writes nothing.
fn save(case: &Case, build: &Build, limits: &Limits, saver: &mut dyn Saver) {
    if let Ok(mut engine) = build() {
        simulate(engine.as_mut(), case.label.steps, limits, saver, &|_| {});
    }
}

/// Repeated at most this often, within this many seconds in all.
const REPEATS: usize = 5;
const PATIENCE: f64 = 0.02;

/// Times a case that takes less than the patience; the run that was recorded, beside others, was its
/// warm-up. A longer one keeps the time of that run.
fn time(case: &Case, build: &Build, limits: &Limits, wall: &mut WallTime) {
    let mut times = Vec::new();
    let coarse = limits.now_and_then();
    while times.len() < REPEATS && times.iter().sum::<f64>() + wall.min < PATIENCE {
        let Ok(mut engine) = build() else {
            return;
        };
        let start = Instant::now();
        simulate(
            engine.as_mut(),
            case.label.steps,
            &coarse,
            &mut Nobody,
            &|_| {},
        );
        times.push(start.elapsed().as_secs_f64());
    }
    if times.is_empty() {
        return;
    }
    let median = median(&mut times);
    let mut off: Vec<f64> = times.iter().map(|t| (t - median).abs()).collect();
    *wall = WallTime {
        min: times[0],
        median,
        mad: (off.len() > 1).then(|| self::median(&mut off)),
    };
}

/// Looks at nothing.
struct Nobody;

impl Observer for Nobody {
    fn next(&self, _from: u64) -> Option<u64> {
        None
    }
    fn observe(&mut self, _step: u64, _state: &State) {}
}

/// Sorts; not empty.
pub(super) fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    let half = values.len() / 2;
    if values.len() % 2 == 1 {
        values[half]
    } else {
        0.5 * (values[half - 1] + values[half])
    }
}
