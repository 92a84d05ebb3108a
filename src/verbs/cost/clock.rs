//! Wall times: one run after the other, when nothing else runs.

use super::sweep::{Ground, Sweep, Swept};
use crate::solvers::Status;
use crate::solvers::{Run, Setting, Solver};
use crate::trajectory::Unwatched;
use crate::verbs::clock::WallTime;
use crate::verbs::clock::spread;
use std::time::Instant;

/// A sample takes at least this, s, by repeating a short run: a thousand grains of the clock.
const SAMPLE: f64 = 1e-3;
/// Runs in a sample at most: their engines are built before the clock starts.
const MOST: usize = 1_000;
/// Samples of a short run, after its warm-up.
const SAMPLES: usize = 5;
/// A run longer than this, s, warms up within itself: it is run so often in all.
const LONG: f64 = 0.02;
const RUNS_OF_LONG: usize = 3;

/// Times every point that completed.
pub fn time(ground: &Ground, sweep: &Sweep, swept: &mut Swept) {
    for (setting, point) in swept.settings.iter().zip(&mut swept.points) {
        if point.status == Status::Completed {
            point.wall_s = wall(ground, &sweep.solver, setting);
            ground.host.progress(sweep.of_timing(setting));
        }
    }
}

fn wall(ground: &Ground, solver: &Solver, setting: &Setting) -> Option<WallTime> {
    // The first is the warm-up, and says how many there are to a sample.
    let once = sample(ground, solver, setting, 1)?;
    let batch = ((SAMPLE / once.max(1e-9)).ceil() as usize).clamp(1, MOST);
    let (mut times, count) = if once > LONG {
        (vec![once], RUNS_OF_LONG)
    } else {
        (Vec::new(), SAMPLES)
    };
    while times.len() < count {
        times.push(sample(ground, solver, setting, batch)?);
    }
    Some(spread(times))
}

/// Seconds of one run, of so many run one after the other.
fn sample(ground: &Ground, solver: &Solver, setting: &Setting, batch: usize) -> Option<f64> {
    let make = || solver.start(ground.scene, ground.system, setting).ok();
    let mut runs: Vec<Run> = (0..batch).map(|_| make()).collect::<Option<_>>()?;
    let start = Instant::now();
    for run in &mut runs {
        run.finish(ground.limits, &mut Unwatched, &|_| {});
    }
    Some(start.elapsed().as_secs_f64() / batch as f64)
}
