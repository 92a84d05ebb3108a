//! How outcomes are called and timed in words.

use crate::report::words::{NOTHING, seconds};
use crate::solvers::Status;
use crate::verbs::run::Outcome;

/// Median time, with its spread where that exceeds a tenth: `12.3 ms ±14%`. A run that did not
/// finish has no speed.
pub fn wall_time(outcome: &Outcome) -> String {
    let wall = match &outcome.work.wall_s {
        Some(wall) if outcome.status == Status::Completed => wall,
        _ => return NOTHING.into(),
    };
    let mut text = seconds(wall.median);
    if let Some(mad) = wall.mad
        && mad > 0.1 * wall.median
    {
        text += &format!(" ±{:.0}%", (100.0 * mad / wall.median).min(999.0));
    }
    text
}

/// The engine, with rapier's substeps where it takes any: `rapier, dt/4`.
pub fn engine(outcome: &Outcome) -> String {
    let ratio = outcome.timestep / outcome.substep;
    if ratio.is_finite() && ratio > 1.5 && ratio < 1e6 {
        return format!("{}, dt/{ratio:.0}", outcome.engine);
    }
    outcome.engine.clone()
}
