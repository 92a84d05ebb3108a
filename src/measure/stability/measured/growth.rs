//! Whether a series keeps growing: judged by the largest values of successive windows.
//!
//! A bound alone (such as 1e4 times the start) does not find a limit: explicit Euler on an oscillator
//! of damping ratio ζ multiplies the energy by 1 + 4 ζ² δ a step at a relative distance δ beyond its
//! limit, which takes 20,000 steps to reach 1e4 only from δ = 1.2 % on at ζ = 0.1. Largest values, not
//! means: near a limit the energy swings by orders of magnitude, but comes back to the same height.

/// Windows a run is judged by.
pub(super) const WINDOWS: usize = 16;
/// The first half may be a transient.
const TAIL: usize = WINDOWS / 2;
/// Windows averaged at either end of the tail.
const ENDS: usize = 3;
/// Steps from the middle of one end to that of the other, in windows.
const SPAN: f64 = (TAIL - ENDS) as f64;

/// Largest values of windows of equally many steps.
#[derive(Debug, Clone)]
pub(super) struct Maxima {
    window: u64,
    values: Vec<f64>,
}

/// What the tail of a run does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Course {
    Grows,
    Falls,
    /// Neither, beyond what windows differ by.
    Level,
    /// Upwards without a break, but by too little to be sure: more steps would tell.
    Faint,
}

/// A course and by how much.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Judgement {
    pub course: Course,
    /// Of the logarithm of the energy, per step.
    pub rate: f64,
}

impl Maxima {
    /// For a run of `steps`; what is handed in are logarithms.
    pub fn new(steps: u64) -> Self {
        Self {
            window: (steps / WINDOWS as u64).max(1),
            values: Vec::with_capacity(WINDOWS),
        }
    }

    /// Steps over which the rise is taken in a run of `steps`.
    pub fn span(steps: u64) -> f64 {
        SPAN * (steps / WINDOWS as u64) as f64
    }

    /// Steps that fill all windows.
    pub fn steps(&self) -> u64 {
        self.window * WINDOWS as u64
    }

    /// The value after step `step`, from 1; others may be left out.
    pub fn push(&mut self, step: u64, value: f64) {
        let at = (step.saturating_sub(1) / self.window) as usize;
        if self.values.len() <= at {
            self.values.resize(at + 1, f64::NEG_INFINITY);
        }
        self.values[at] = self.values[at].max(value);
    }

    /// Windows four times as long, for a run four times as long.
    pub fn widen(&mut self) {
        self.window *= 4;
        let four = self.values.chunks(4);
        let largest = |v: &[f64]| v.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        self.values = four.map(largest).collect();
    }

    /// Of the last half. `clear` is the rise of the logarithm from which growth counts.
    pub fn judge(&self, clear: f64) -> Judgement {
        let tail = &self.values[self.values.len().saturating_sub(TAIL)..];
        let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len().max(1) as f64;
        let ends = tail.first_chunk::<ENDS>().zip(tail.last_chunk::<ENDS>());
        let rise = ends.map_or(0.0, |(first, last)| mean(last) - mean(first));
        if !rise.is_finite() {
            return Judgement {
                course: Course::Level,
                rate: 0.0,
            };
        }
        let course = if rise > clear && rise > SURE * largest_fall(tail) {
            Course::Grows
        } else if rise < -clear {
            Course::Falls
        } else if rise > FAINT * clear && tail.is_sorted() {
            Course::Faint
        } else {
            Course::Level
        };
        Judgement {
            course,
            rate: rise / (SPAN * self.window as f64),
        }
    }
}

/// Growth must be so many times the largest fall between two windows.
const SURE: f64 = 4.0;
/// Fraction of a clear rise below which there is none.
const FAINT: f64 = 1e-3;

/// The largest fall from one value to a later one.
fn largest_fall(values: &[f64]) -> f64 {
    let mut highest = f64::NEG_INFINITY;
    let mut fall = 0.0_f64;
    for value in values {
        highest = highest.max(*value);
        fall = fall.max(highest - value);
    }
    fall
}
