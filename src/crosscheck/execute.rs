//! Runs the cases in parallel.

use super::plan::{Case, Label};
use crate::engines::{Counts, Ended, Limits, Observer, Unsupported, simulate};
use crate::outcome::WallTime;
use crate::scene::Scene;
use crate::system::State;
use crate::trajectory::{Recorder, SaveError, Trajectory};
use rayon::prelude::*;
use std::time::Instant;

/// What a run needs from the outside: files to save to, somebody to show progress.
pub trait Host: Sync {
    /// Where every step of this case goes; None if nowhere.
    ///
    /// # Errors
    /// When the file cannot be made.
    fn saver(&self, case: &Label) -> Result<Option<Box<dyn Saver>>, SaveError>;

    /// So many more steps have been taken.
    fn progress(&self, steps: u64);
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
    Ran(Box<Ran>),
}

/// A case that ran, to its end or not.
pub(super) struct Ran {
    pub ended: Ended,
    /// Steps taken.
    pub steps: u64,
    pub trajectory: Trajectory,
    pub counts: Counts,
    pub wall: WallTime,
}

pub(super) fn all(
    cases: &[Case],
    scene: &Scene,
    limits: &Limits,
    host: &dyn Host,
) -> Result<Vec<Run>, SaveError> {
    let dim = 3 * scene.particles.len();
    cases
        .par_iter()
        .map(|case| one(case, dim, limits, host))
        .collect()
}

/// Times short runs again, one after the other, when nothing else runs.
pub(super) fn time_again(cases: &[Case], runs: &mut [Run], limits: &Limits) {
    for (case, run) in cases.iter().zip(runs) {
        if let Run::Ran(ran) = run {
            time(case, limits, &mut ran.wall);
        }
    }
}

fn one(case: &Case, dim: usize, limits: &Limits, host: &dyn Host) -> Result<Run, SaveError> {
    let mut engine = match (case.build)() {
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
        && let Ok(again) = (case.build)()
    {
        // It ended about here; the same bits once more, looked at in every step, say where.
        engine = again;
        recorder = Recorder::new(steps, dim, timestep);
        ended = simulate(engine.as_mut(), steps, limits, &mut recorder, &|_| {});
    }
    if let Some(mut saver) = host.saver(&case.label)? {
        save(case, limits, saver.as_mut());
        saver.finish()?;
    }
    let taken = match &ended {
        Ended::Completed => steps,
        Ended::Diverged { step, .. } | Ended::Failed { step, .. } => *step,
    };
    host.progress(steps.saturating_sub(taken));
    Ok(Run::Ran(Box::new(Ran {
        steps: taken,
        trajectory: recorder.finish(),
        counts: engine.counts(),
        wall: WallTime {
            min: first,
            median: first,
            mad: None,
        },
        ended,
    })))
}

/// The same run once more, to the file: bits are the same, and the timed run writes nothing.
fn save(case: &Case, limits: &Limits, saver: &mut dyn Saver) {
    if let Ok(mut engine) = (case.build)() {
        simulate(engine.as_mut(), case.label.steps, limits, saver, &|_| {});
    }
}

/// Repeated at most this often, within this many seconds in all.
const REPEATS: usize = 5;
const PATIENCE: f64 = 0.02;

/// Times a case that takes less than the patience; the run that was recorded, beside others, was its
/// warm-up. A longer one keeps the time of that run.
fn time(case: &Case, limits: &Limits, wall: &mut WallTime) {
    let mut times = Vec::new();
    let coarse = limits.now_and_then();
    while times.len() < REPEATS && times.iter().sum::<f64>() + wall.min < PATIENCE {
        let Ok(mut engine) = (case.build)() else {
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

struct Nobody;

impl Observer for Nobody {
    fn next(&self, _from: u64) -> Option<u64> {
        None
    }
    fn observe(&mut self, _step: u64, _state: &State) {}
}

/// Sorts; not empty.
fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    let half = values.len() / 2;
    if values.len() % 2 == 1 {
        values[half]
    } else {
        0.5 * (values[half - 1] + values[half])
    }
}
