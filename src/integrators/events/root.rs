//! The time of an event, as the root of a function of the method's own sub-steps.

use super::LOCATED;
use crate::integrators::StepError;
use crate::physics::State;

/// Halvings after which an event is not located but counts as one of the end.
const HALVES: u32 = 40;

/// Where an event is looked for, in seconds from the start of a sub-step.
pub(super) struct Bracket {
    /// About where it is not due yet, and where it is.
    pub clear: f64,
    pub due: f64,
    /// It is no later.
    pub left: f64,
    /// The whole step, which it is located to a part of.
    pub h: f64,
}

/// The first time at which `sign` of the state has fallen below 0, and the state there; None where it does not on sub-steps
/// `to` some time from the start.
pub(super) fn locate(
    bracket: &Bracket,
    start: &State,
    sign: impl Fn(&State) -> f64,
    mut to: impl FnMut(f64) -> Result<State, StepError>,
) -> Result<Option<(f64, State)>, StepError> {
    let Bracket {
        clear,
        due,
        left,
        h,
    } = *bracket;
    let mut high = due;
    let mut below = sign(&to(high)?);
    // The cubic and the method's own path differ, if only by rounding: a little beyond, lest it is through.
    let mut beyond = (1e-6 * (due - clear)).max(LOCATED * h);
    while below >= 0.0 && high < left {
        high = (due + beyond).min(left);
        beyond *= 8.0;
        below = sign(&to(high)?);
    }
    if below >= 0.0 {
        return Ok(None);
    }
    let mut low = clear;
    let mut above = if low > 0.0 {
        sign(&to(low)?)
    } else {
        sign(start)
    };
    // Just after a bounce the gap is 0, and grows; so does the speed of what begins to slide.
    for halves in 0.. {
        if above > 0.0 {
            break;
        }
        if halves > HALVES {
            return Ok(None);
        }
        low = if halves == 0 { 0.5 * high } else { 0.5 * low };
        above = sign(&to(low)?);
        if above < 0.0 {
            (high, below) = (low, above);
        }
    }
    let tolerance = LOCATED * h;
    let mut found = None;
    let mut side = 0;
    for _ in 0..200 {
        if high - low <= tolerance {
            break;
        }
        // Regula falsi, which halves the value of an end that stays (Dowell, Jarratt 1971); else bisection.
        let mut next = (low * below - high * above) / (below - above);
        let inside = next > low && next < high;
        if !inside || !next.is_finite() {
            next = 0.5 * (low + high);
        }
        let at = to(next)?;
        let value = sign(&at);
        if value == 0.0 {
            return Ok(Some((next, at)));
        }
        if value < 0.0 {
            if side == -1 {
                above *= 0.5;
            }
            (high, below, side) = (next, value, -1);
            found = Some(at);
        } else {
            if side == 1 {
                below *= 0.5;
            }
            (low, above, side) = (next, value, 1);
        }
    }
    let at = match found {
        Some(at) if at.t == start.t + high => at,
        _ => to(high)?,
    };
    Ok(Some((high, at)))
}
