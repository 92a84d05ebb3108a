//! Times as step numbers.

use super::super::Precision;
use super::Numbers;
use super::digits::{FULL, Sample};
use super::error::{ErrorPlace, ReadError, Wrong, of_field};
use crate::scene::limits::STEPS;

/// The times of all instants, s.
pub(super) struct Times {
    pub numbers: Numbers,
    /// In text: byte offsets of each instant's first record, and the field of its time.
    pub fields: Option<(Vec<u64>, usize)>,
}

/// A time may be this far from a whole number of steps, in steps, besides its own rounding.
const NEAR: f64 = 1e-6;

/// Errors of a running sum may reach this part of a step: beyond, the next step is as near.
const FARTHEST: f64 = 0.25;

/// Text may be rounded to this part of a step at most: 0.3 is no rounded 0.25.
const COARSEST: f64 = 0.05;

const OTHER: &str = "--timestep tells the step the rows were computed with";

/// Whether a time may come after this one.
pub(super) fn follows(last: Option<f64>, t: f64) -> Result<(), Wrong> {
    match last {
        None if t < 0.0 => Err(Wrong::new(
            format!("expected a time of at least 0 s, found {t:?}"),
            "the scene starts at t = 0",
        )),
        Some(last) if t == last => Err(Wrong::new(format!("the time {t:?} a second time"), "")),
        Some(last) if t < last => Err(Wrong::new(
            format!("expected a time after {last:?}, found {t:?}"),
            "sort the rows by time",
        )),
        _ => Ok(()),
    }
}

/// How far a time may be off for having been rounded.
#[derive(Debug, Clone, Copy)]
enum Rounding {
    /// The times are a running sum, rounded to a float of this epsilon after every step.
    Sum(f64),
    /// The text is rounded to this many decimals or digits, whichever is coarser.
    Text { decimals: u32, digits: u32 },
}

impl Rounding {
    fn of(times: &Numbers) -> Self {
        let sample = Sample::new(&times.values, 1, times.written);
        let (decimals, digits) = match times.written {
            _ if sample.singles(times.written).is_some() => {
                return Self::Sum(f64::from(f32::EPSILON));
            }
            Precision::Decimals(decimals) | Precision::SingleDecimals(decimals) => (decimals, FULL),
            Precision::Digits(digits) => (FULL, digits),
            Precision::Double | Precision::Single => match (sample.longest(), sample.decimals()) {
                (0, _) => return Self::Sum(f64::EPSILON),
                (digits, _) if digits >= FULL - 1 => return Self::Sum(f64::EPSILON),
                (digits, decimals) => (decimals, digits),
            },
        };
        Self::Text { decimals, digits }
    }

    /// Half a unit of the last place of a time that is text, s.
    fn given(self, t: f64) -> f64 {
        let Self::Text { decimals, digits } = self else {
            return 0.0;
        };
        let by_decimals = Precision::Decimals(decimals).half_unit(t);
        by_decimals.max(Precision::Digits(digits).half_unit(t))
    }

    /// How far a time may be from a whole number of steps, in steps.
    fn allowance(self, t: f64, timestep: f64) -> f64 {
        let n = (t / timestep).max(1.0);
        let sum = |epsilon: f64| (0.5 * epsilon * n * n).min(FARTHEST);
        match self {
            Self::Sum(epsilon) => sum(epsilon),
            Self::Text { .. } => {
                let given = self.given(t) / timestep;
                // Coarser text tells nothing of the step: a time is then exact, or wrong.
                let given = if given <= COARSEST { given } else { 0.0 };
                given + sum(f64::EPSILON)
            }
        }
    }

    /// How far, relative, a step of `digits` digits may be from what a row at this time says.
    /// Running sums drift, but only a round step counts for more than what they say.
    fn relative(self, t: f64, digits: usize) -> f64 {
        match self {
            Self::Sum(epsilon) if digits < 6 => (1e6 * epsilon).min(1e-4),
            Self::Sum(epsilon) => epsilon,
            Self::Text { .. } => self.given(t) / t,
        }
    }

    /// The step number at this time, if it is one.
    fn step(self, t: f64, timestep: f64) -> Option<u64> {
        let steps = t / timestep;
        let n = steps.round();
        let off = (steps - n).abs();
        (n <= STEPS && off <= NEAR + self.allowance(t, timestep)).then_some(n as u64)
    }
}

impl Times {
    /// The step number of each instant; strictly increasing.
    ///
    /// # Errors
    /// A time that is negative, not after the last, or no whole number of steps.
    pub fn steps(&self, timestep: f64, bytes: &[u8]) -> Result<Vec<u64>, ReadError> {
        let rounding = Rounding::of(&self.numbers);
        let times = &self.numbers.values;
        let mut steps: Vec<u64> = Vec::with_capacity(times.len());
        let mut last = None;
        for (k, &t) in times.iter().enumerate() {
            let fail = |wrong: Wrong| wrong.at(self.place(k, bytes));
            follows(last, t).map_err(fail)?;
            let Some(n) = rounding.step(t, timestep) else {
                return Err(fail(self.misfit(t, timestep, rounding)));
            };
            if steps.last().is_some_and(|last| *last >= n) {
                let message = format!(
                    "expected another step than the time before, found {n} for both at t = {t:?}"
                );
                return Err(fail(Wrong::new(message, OTHER)));
            }
            steps.push(n);
            last = Some(t);
        }
        Ok(steps)
    }

    /// The error of a time that belongs to no step.
    fn misfit(&self, t: f64, timestep: f64, rounding: Rounding) -> Wrong {
        let steps = t / timestep;
        if steps > STEPS {
            let message =
                format!("expected at most {STEPS:e} steps of {timestep:?} s, found t = {t:?}");
            return Wrong::new(message, OTHER);
        }
        // Nine decimals show a thousandth of what is allowed.
        let found = format!("{steps:.9}");
        let found = found.trim_end_matches('0').trim_end_matches('.');
        let message = format!(
            "expected a whole number of steps of {timestep:?} s, found {found} at t = {t:?}"
        );
        let help = match fitting(&self.numbers.values, rounding) {
            Some(other) => format!("times are multiples of {other:?}: --timestep {other:?}"),
            None if (steps - steps.round()).abs() < 0.01 => {
                "write t as n * timestep, not as a running sum".to_owned()
            }
            None => OTHER.to_owned(),
        };
        Wrong::new(message, help)
    }

    fn place(&self, k: usize, bytes: &[u8]) -> ErrorPlace {
        match &self.fields {
            Some((starts, field)) => {
                let start = starts.get(k).copied().unwrap_or_default();
                of_field(bytes, start, *field)
            }
            None => ErrorPlace::Array {
                name: "t".to_owned(),
                index: vec![k],
            },
        }
    }
}

/// More steps than this from one row to the next would explain any times.
const SPARSEST: f64 = 1000.0;

/// The roundest step that all times are multiples of, if there is one worth naming.
fn fitting(times: &[f64], rounding: Rounding) -> Option<f64> {
    let gaps = || {
        let first = times.iter().copied().take(1);
        let others = times.windows(2).map(|pair| pair[1] - pair[0]);
        first.chain(others).filter(|gap| *gap > 0.0)
    };
    let smallest = gaps().reduce(f64::min)?;
    let mut common = smallest;
    for gap in gaps() {
        common = common_divisor(gap, common, 1e-4 * smallest);
        if common * SPARSEST < smallest {
            return None;
        }
    }
    let last = times.last()?;
    let exact = last / (last / common).round();
    (0..16)
        .filter_map(|digits| {
            let step: f64 = format!("{exact:.digits$e}").parse().ok()?;
            let off = (step - exact).abs() / exact;
            (off <= rounding.relative(*last, digits)).then_some(step)
        })
        .find(|step| times.iter().all(|t| rounding.step(*t, *step).is_some()))
}

/// Euclid's algorithm on numbers that are off by `nothing` at most.
fn common_divisor(mut a: f64, mut b: f64, nothing: f64) -> f64 {
    while b > nothing {
        let rest = a % b;
        (a, b) = (b, if b - rest > nothing { rest } else { 0.0 });
    }
    a
}
