//! Wall times: one run after the other, when nothing else runs.

use super::entrant::Entrant;
use super::lane::Lane;
use super::runner::{Eye, Runner};
use super::setting::Setting;
use super::sweep::{Ground, Swept};
use crate::crosscheck::execute::median;
use crate::outcome::{Status, WallTime};
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
pub(super) fn time(ground: &Ground, lane: &Lane, swept: &mut Swept) {
    for (setting, point) in swept.settings.iter().zip(&mut swept.points) {
        if point.status == Status::Completed {
            point.wall_s = wall(ground, &lane.entrant, setting);
            ground.host.progress(lane.of_timing(setting));
        }
    }
}

fn wall(ground: &Ground, entrant: &Entrant, setting: &Setting) -> Option<WallTime> {
    // The first is the warm-up, and says how many there are to a sample.
    let once = sample(ground, entrant, setting, 1)?;
    let batch = ((SAMPLE / once.max(1e-9)).ceil() as usize).clamp(1, MOST);
    let (mut times, count) = if once > LONG {
        (vec![once], RUNS_OF_LONG)
    } else {
        (Vec::new(), SAMPLES)
    };
    while times.len() < count {
        times.push(sample(ground, entrant, setting, batch)?);
    }
    let median = median(&mut times);
    let mut off: Vec<f64> = times.iter().map(|t| (t - median).abs()).collect();
    Some(WallTime {
        min: *times.first()?,
        median,
        mad: Some(self::median(&mut off)),
    })
}

/// Seconds of one run, of so many run one after the other.
fn sample(ground: &Ground, entrant: &Entrant, setting: &Setting, batch: usize) -> Option<f64> {
    let make = || entrant.make(ground.scene, ground.system, setting).ok();
    let mut runners: Vec<Runner> = (0..batch).map(|_| make()).collect::<Option<_>>()?;
    let mut eye = Eye::closed();
    let start = Instant::now();
    for runner in &mut runners {
        runner.run(setting, ground.limits, &mut eye);
    }
    Some(start.elapsed().as_secs_f64() / batch as f64)
}
