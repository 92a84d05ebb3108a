//! One or two more settings where a target lies between two that were tried, so that which solver is the
//! cheapest does not hang on where its settings happen to lie.

use super::sweep::{Ground, Sweep, Swept};
use crate::solvers::Setting;
use crate::verbs::cost::rank::reach;

/// Attempts for each target.
const ATTEMPTS: usize = 2;
/// Settings closer than this are near enough.
const CLOSE: f64 = 1.06;
/// Aimed at, as a share of the target: the line between two points is not quite straight.
const AIM: f64 = 0.93;
/// Not worth another run: an error so close to the target.
const NEAR: f64 = 0.85;

/// Adds settings to what was swept.
pub fn toward(ground: &Ground, sweep: &Sweep, swept: &mut Swept, targets: &[f64]) {
    for &target in targets {
        for _ in 0..ATTEMPTS {
            let Some(setting) = between(swept, target) else {
                break;
            };
            swept.insert(setting, ground.run(&sweep.solver, &setting));
        }
    }
}

/// The setting at which the error should be just below the target; None where the target is reached
/// nowhere, or at the coarsest setting, or to within a few percent.
fn between(swept: &Swept, target: f64) -> Option<Setting> {
    let reached = reach(&swept.points, target).ok()?;
    let before = reached.checked_sub(1)?;
    let (fine, coarse) = (&swept.points[reached], &swept.points[before]);
    let ratio = fine.steps as f64 / coarse.steps as f64;
    let near = fine.error_m.is_some_and(|error| error > NEAR * target);
    if ratio < CLOSE || near || (fine.at_floor && coarse.at_floor) {
        return None;
    }
    let part = match (coarse.error_m, fine.error_m) {
        // Within the ends, so that every attempt narrows.
        (Some(from), Some(to)) if from > target && to > 0.0 => {
            ((from / (AIM * target)).ln() / (from / to).ln()).clamp(0.1, 0.9)
        }
        // Unstable there: halfway.
        (None, _) => 0.5,
        _ => return None,
    };
    along(&swept.settings[before], &swept.settings[reached], part)
}

/// So far from one setting to a finer one, both logarithmic.
fn along(coarse: &Setting, fine: &Setting, part: f64) -> Option<Setting> {
    let mean = |from: f64, to: f64| from * (to / from).powf(part);
    let steps = mean(coarse.steps() as f64, fine.steps() as f64).round() as u64;
    match (coarse, fine) {
        (
            Setting::Tolerance {
                tolerance: from,
                duration,
                most,
                ..
            },
            Setting::Tolerance { tolerance: to, .. },
        ) => Some(Setting::Tolerance {
            tolerance: mean(*from, *to),
            duration: *duration,
            steps,
            most: *most,
        }),
        _ => {
            let duration = coarse.timestep() * coarse.steps() as f64;
            let inside = steps > coarse.steps() && steps < fine.steps();
            inside.then(|| Setting::divided(duration, steps))
        }
    }
}
