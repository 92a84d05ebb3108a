//! The times of events, as roots of functions of the method's own sub-steps, and the cuts of a step there.

use super::LOCATED;
use crate::integrators::StepError;
use crate::physics::State;

/// Halvings after which an event is not located but counts as one of the end.
const HALVES: u32 = 40;
/// The most cuts in a step.
const CUTS: usize = 2_000;
/// Cuts of no length after which no further event of a step is located.
const IDLE: u32 = 16;

/// An event due within a sub-step: none at `clear`, and due at `due`, both in seconds from the start of the sub-step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Due<E> {
    pub event: E,
    pub clear: f64,
    pub due: f64,
    /// The gap at which an impact is due, m: 0, or the rounding of one for a particle that has not risen above that.
    pub level: f64,
}

impl<E> Due<E> {
    /// The same of another event.
    pub fn of<F>(self, event: F) -> Due<F> {
        let Self {
            clear, due, level, ..
        } = self;
        Due {
            event,
            clear,
            due,
            level,
        }
    }
}

/// Advances a state by `h` seconds in sub-steps, each of what is left at most. `advance` takes one, in which no more than so
/// many particles have their events located, and tells its length.
pub(super) fn cut(
    h: f64,
    located: usize,
    state: &mut State,
    mut advance: impl FnMut(f64, usize, &mut State) -> Result<f64, StepError>,
) -> Result<(), StepError> {
    let (begin, mut located) = (state.t, located);
    let (mut done, mut idle) = (0.0, 0);
    for _ in 0..CUTS {
        let left = h - done;
        let taken = advance(left, located, state)?;
        done += taken;
        idle += u32::from(taken <= LOCATED * h);
        if idle > IDLE {
            located = 0;
        }
        state.t = begin + done;
        if taken >= left {
            return Ok(());
        }
    }
    Err(StepError::TooManyEvents { t: state.t })
}

/// The first of these events within `left` seconds of a step of `h`, its time and the state there; None where none is found.
/// `sign` is positive before an event and negative after it, `to` the state some time from the start.
pub(super) fn first<E: Copy>(
    all: &mut [Due<E>],
    [left, h]: [f64; 2],
    start: &State,
    sign: impl Fn(&Due<E>, &State) -> f64,
    mut to: impl FnMut(f64) -> Result<State, StepError>,
) -> Result<Option<(f64, State, E)>, StepError> {
    all.sort_by(|a, b| a.due.total_cmp(&b.due));
    let mut first: Option<(f64, State, E)> = None;
    for due in all {
        let mut bracket = [due.clear, due.due];
        // What is not due where another event was found comes later.
        if let Some((time, at, _)) = &first {
            if due.clear >= *time || sign(due, at) >= 0.0 {
                continue;
            }
            bracket[1] = due.due.min(*time);
        }
        let sign = |state: &State| sign(due, state);
        if let Some((time, at)) = locate(bracket, [left, h], start, sign, &mut to)?
            && first.as_ref().is_none_or(|(bound, ..)| time < *bound)
        {
            first = Some((time, at, due.event));
        }
    }
    Ok(first)
}

/// The first time at which `sign` of the state has fallen below 0, and the state there; None where it does not on sub-steps
/// of at most `left` seconds. It is about after `clear` and before `due`, and located to a part of `h`.
fn locate(
    [clear, due]: [f64; 2],
    [left, h]: [f64; 2],
    start: &State,
    sign: impl Fn(&State) -> f64,
    mut to: impl FnMut(f64) -> Result<State, StepError>,
) -> Result<Option<(f64, State)>, StepError> {
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
