//! The number of digits data is given to, told from the numbers and the way they are written.

use super::super::Precision;
use std::fmt::{LowerExp, Write};

/// Watches the numbers of a text column until two of them are not written alike.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Form {
    /// Digits after the point, and whether an exponent follows.
    first: Option<(u32, bool)>,
    mixed: bool,
}

/// With fewer decimals, numbers that happen to be short look the same.
const FEWEST: u32 = 3;

impl Form {
    pub fn see(&mut self, number: &[u8]) {
        if self.mixed {
            return;
        }
        let exponent = number.iter().position(|b| matches!(b, b'e' | b'E'));
        let mantissa = &number[..exponent.unwrap_or(number.len())];
        let point = mantissa.iter().rposition(|b| *b == b'.');
        let decimals = point.map_or(0, |point| mantissa.len() - 1 - point);
        let own = (decimals as u32, exponent.is_some());
        self.mixed = *self.first.get_or_insert(own) != own;
    }

    /// The digits, where each number has as many, zeros included; doubles where that tells nothing.
    pub fn written(self) -> Precision {
        match self.first.filter(|_| !self.mixed) {
            Some((decimals, false)) if decimals >= FEWEST => Precision::Decimals(decimals),
            Some((decimals, true)) if decimals >= FEWEST => Precision::Digits(decimals + 1),
            _ => Precision::Double,
        }
    }
}

/// The precision of states of `width` numbers, one after the other, and of singles the precision they
/// were written to. `written` is the precision that their form alone tells.
///
/// Only numbers that differ from the same one in the state before count, since starts and fixed
/// particles are often exact. Floats in full need 17 digits (singles 9). Rounded numbers have a
/// largest number of decimals, or digits, and most of them need just that many.
pub(super) fn detect(
    values: &[f64],
    width: usize,
    written: Precision,
) -> (Precision, Option<Precision>) {
    let sample = Sample::new(values, width, written);
    let singles = sample.singles(written);
    let precision = match (written, singles) {
        (Precision::Decimals(decimals), Some(_)) => Precision::SingleDecimals(decimals),
        (Precision::Digits(digits), Some(_)) if digits < FULL => Precision::Single,
        (Precision::Decimals(_), None) => written,
        (Precision::Digits(digits), None) if digits < FULL => written,
        _ => sample.precision(),
    };
    (precision, singles)
}

/// Significant digits that give back any double.
pub(super) const FULL: u32 = 17;

/// A number's shortest decimal form that gives back the same float, d.ddd * 10^exponent.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shortest {
    pub digits: u32,
    exponent: i32,
}

impl Shortest {
    fn new(value: impl LowerExp, scratch: &mut String) -> Self {
        scratch.clear();
        // Writing into a string cannot fail.
        let _ = write!(scratch, "{value:e}");
        let (mantissa, exponent) = scratch.split_once('e').unwrap_or((scratch, "0"));
        let digits = mantissa.bytes().filter(u8::is_ascii_digit).count();
        Self {
            digits: digits as u32,
            exponent: exponent.parse().unwrap_or(0),
        }
    }

    /// Digits after the point.
    pub fn decimals(self) -> u32 {
        u32::try_from(self.digits as i32 - 1 - self.exponent).unwrap_or(0)
    }
}

/// The numbers that show how data is rounded.
pub(super) struct Sample {
    values: Vec<f64>,
    /// None where nothing is rounded: all numbers are short binary fractions, or nothing ever changes.
    pub shortest: Vec<Shortest>,
    /// The precision they were written to, if they are in single precision.
    single: Option<Precision>,
}

/// A sample of this many numbers is enough.
const ENOUGH: usize = 8192;

impl Sample {
    pub fn new(values: &[f64], width: usize, written: Precision) -> Self {
        let mut sample = Self {
            values: pick(values, width),
            shortest: Vec::new(),
            single: Some(Precision::Single).filter(|single| written == *single),
        };
        if sample.single.is_none() && sample.values.iter().all(|v| is_short_fraction(*v)) {
            return sample;
        }
        let mut scratch = String::new();
        if sample.values.iter().all(|v| f64::from(*v as f32) == *v) {
            sample.single = Some(Precision::Single);
        }
        let exact = sample.single.is_some();
        let shortest = sample.values.iter().map(|v| match exact {
            true => Shortest::new(*v as f32, &mut scratch),
            false => Shortest::new(*v, &mut scratch),
        });
        sample.shortest = shortest.collect();
        if exact {
            return sample;
        }
        // Singles in text, once read as doubles, are singles no more. They were printed with the
        // fewest digits that give them back, or all with the same number.
        let digits = sample.longest();
        let all = |text: Precision| sample.printed_from_singles(text).then_some(text);
        let shortest = matches!(digits, 8 | 9)
            && (sample.values.iter()).all(|v| is_printed_single(*v, &mut scratch));
        sample.single = match shortest {
            true => Some(Precision::Single),
            false => all(Precision::Digits(digits)),
        };
        sample
    }

    /// The precision that singles were written to; None if the numbers are not in single precision.
    /// Where their form tells how far they are written, it decides alone.
    pub fn singles(&self, written: Precision) -> Option<Precision> {
        match written {
            Precision::Digits(digits) if digits >= FULL => self.single,
            Precision::Decimals(_) | Precision::Digits(_) => {
                self.printed_from_singles(written).then_some(written)
            }
            _ => self.single,
        }
    }

    /// Whether each number is the text of a single, written to this precision, and not by chance.
    fn printed_from_singles(&self, written: Precision) -> bool {
        // The logarithm of the chance that other numbers written so look like singles.
        let mut chance = 0.0;
        for &value in &self.values {
            let single = value as f32;
            let unit = 2.0 * written.half_unit(value);
            // Reading rounds once more.
            let slack = 0.5 * unit + Precision::Double.half_unit(value);
            if (value - f64::from(single)).abs() > slack {
                return false;
            }
            let spacing = f64::from(single.abs().next_up()) - f64::from(single.abs());
            chance += (unit / spacing).min(1.0).ln();
        }
        chance < CHANCE.ln()
    }

    pub fn longest(&self) -> u32 {
        self.shortest.iter().map(|s| s.digits).max().unwrap_or(0)
    }

    pub fn decimals(&self) -> u32 {
        let decimals = self.shortest.iter().map(|s| s.decimals());
        decimals.max().unwrap_or(0)
    }

    /// Decimals or digits if the numbers are rounded to them, else the float's own precision.
    fn precision(&self) -> Precision {
        let (full, own) = match self.single {
            Some(_) => (SINGLE, Precision::Single),
            None => (DOUBLE, Precision::Double),
        };
        if self.shortest.is_empty() {
            return own;
        }
        let (longest, decimals) = (self.longest(), self.decimals());
        let fraction = |same: &dyn Fn(&Shortest) -> bool| {
            let count = self.shortest.iter().filter(|s| same(s)).count();
            count as f64 / self.shortest.len() as f64
        };
        // A last digit is 0, and not written, one time in ten.
        let to_decimals = fraction(&|s| s.decimals() == decimals);
        let to_digits = fraction(&|s| s.digits == longest);
        let by_decimals = Precision::Decimals(decimals);
        if longest < full {
            return match to_decimals >= to_digits {
                true => by_decimals,
                false => Precision::Digits(longest),
            };
        }
        // Floats of one magnitude have much the same decimals, but no coarser than their spacing.
        let median = self.median();
        if to_decimals >= MOST && by_decimals.half_unit(median) >= 4.0 * own.half_unit(median) {
            return by_decimals;
        }
        // At most 44 % of the doubles that begin with 1, 2 or 3 get by with 16 digits, since their
        // spacing is 2^-51 or less against a unit of 1e-15. Twenty of them never all do.
        let open = |v: &&f64| {
            let magnitude = v.abs();
            magnitude / 10f64.powf(magnitude.log10().floor()) < 4.0
        };
        if self.single.is_none()
            && longest == DOUBLE
            && to_digits >= MOST
            && self.values.iter().filter(open).count() >= 20
        {
            return Precision::Digits(longest);
        }
        own
    }

    /// The median of the magnitudes.
    fn median(&self) -> f64 {
        let mut magnitudes: Vec<f64> = self.values.iter().map(|v| v.abs()).collect();
        magnitudes.sort_unstable_by(f64::total_cmp);
        magnitudes.get(magnitudes.len() / 2).copied().unwrap_or(0.0)
    }
}

/// Numbers that all need fewer digits than this were rounded: doubles, and singles.
const DOUBLE: u32 = 16;
const SINGLE: u32 = 7;

/// Numbers were rounded to a number of decimals, or digits, if at least this fraction needs them all.
const MOST: f64 = 0.7;

/// Numbers are taken for singles where others would look so less often than this.
const CHANCE: f64 = 1e-6;

/// Numbers other than 0 that changed since the state before, evenly spread in a fixed irregular
/// rhythm, so that no coordinate is left out.
fn pick(values: &[f64], width: usize) -> Vec<f64> {
    let width = width.max(1);
    let changed = || {
        let pairs = values.iter().zip(values.iter().skip(width));
        pairs.filter(|(a, b)| a != b && **b != 0.0).map(|(_, b)| *b)
    };
    let stride = changed().count().div_ceil(ENOUGH).max(1) as u64;
    // Knuth's multiplicative generator: any rhythm without a period will do.
    let mut random = 1u64;
    let mut due = 0;
    let mut sample = Vec::new();
    for (at, value) in (0u64..).zip(changed()) {
        if at == due {
            sample.push(value);
            random = random
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            due += 1 + (random >> 33) % (2 * stride - 1);
        }
    }
    sample
}

/// Whether this is the shortest text of a single, or as near to it: programs break ties differently.
fn is_printed_single(value: f64, scratch: &mut String) -> bool {
    let single = value as f32;
    let digits = Shortest::new(value, scratch).digits;
    // The double that was read is off the text by up to 1e-7 of nine digits' half unit.
    let half_unit = Precision::Digits(digits).half_unit(value) * (1.0 + 1e-6);
    digits == Shortest::new(single, scratch).digits
        && (value - f64::from(single)).abs() <= half_unit
}

/// At most 16 significant bits: 0.375, 2 or 1000, which are exact however they were written.
fn is_short_fraction(value: f64) -> bool {
    value.to_bits().trailing_zeros() >= 53 - 16
}
