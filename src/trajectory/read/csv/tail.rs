//! Is the last number of a file whole that ends without a line end?
//!
//! Many programs leave the last line end out, and a program that was stopped leaves half a number. How
//! the numbers above it are written tells the two apart, mostly.

/// The way a number is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Form {
    /// Digits after the point.
    decimals: usize,
    /// Digits from the first that is not 0.
    digits: usize,
    /// Digits before the point.
    whole: usize,
    /// Digits of the exponent, 0 without one.
    exponent: usize,
}

impl Form {
    fn new(number: &[u8]) -> Self {
        let digits = |text: &[u8]| text.iter().filter(|b| b.is_ascii_digit()).count();
        let mut parts = number.splitn(2, |b| matches!(b, b'e' | b'E'));
        let mantissa = parts.next().unwrap_or_default();
        let exponent = parts.next().map_or(0, digits);
        let point = mantissa.iter().position(|b| *b == b'.');
        let leading = mantissa.iter().take_while(|b| !matches!(b, b'1'..=b'9'));
        let leading = leading.filter(|b| b.is_ascii_digit()).count();
        Self {
            decimals: point.map_or(0, |point| mantissa.len() - 1 - point),
            digits: digits(mantissa) - leading,
            whole: digits(&mantissa[..point.unwrap_or(mantissa.len())]),
            exponent,
        }
    }
}

/// The widest form of the numbers above.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Tail {
    widest: Option<Form>,
    /// Not all have the same number of decimals and the same width of exponent.
    mixed: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Verdict {
    Whole,
    Cut,
    Undecided,
}

/// With fewer decimals, numbers that happen to be short look the same.
const FEWEST: usize = 3;

/// Numbers of so many digits were rounded to them, or are floats in full.
const MANY: usize = 6;

/// A double that is cut behind so many digits is off by no more than its rounding.
const FULL: usize = 16;

impl Tail {
    /// Notes how a number is written that is whole for certain.
    pub fn see(&mut self, number: &[u8]) {
        let form = Form::new(number);
        let widest = self.widest.get_or_insert(form);
        self.mixed |= (widest.decimals, widest.exponent) != (form.decimals, form.exponent);
        widest.decimals = widest.decimals.max(form.decimals);
        widest.digits = widest.digits.max(form.digits);
        widest.exponent = widest.exponent.max(form.exponent);
    }

    /// Judges the last number.
    pub fn judge(&self, number: &[u8]) -> Verdict {
        let form = Form::new(number);
        let Some(widest) = self.widest else {
            return Verdict::Undecided;
        };
        if !self.mixed && widest.decimals >= FEWEST {
            // All numbers have as many decimals, and the same width of exponent.
            return match (form.decimals, form.exponent) == (widest.decimals, widest.exponent) {
                true => Verdict::Whole,
                false if form.decimals <= widest.decimals => Verdict::Cut,
                false => Verdict::Undecided,
            };
        }
        // One digit before the point: an exponent may be missing.
        let exponent = match (widest.exponent, form.exponent) {
            (0, 0) => true,
            (_, 0) => form.whole != 1 || number.iter().find(|b| b.is_ascii_digit()) == Some(&b'0'),
            (_, own) => own >= widest.exponent.max(2),
        };
        // Few digits that are wider than all above tell nothing.
        let digits = form.digits >= widest.digits.min(FULL)
            && (form.decimals <= widest.decimals || widest.digits >= MANY);
        let decimals = form.decimals == widest.decimals && widest.decimals >= FEWEST;
        let wide = digits || decimals;
        match exponent && wide {
            true => Verdict::Whole,
            false => Verdict::Undecided,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(above: &[&str], last: &str) -> Verdict {
        let mut tail = Tail::default();
        above.iter().for_each(|number| tail.see(number.as_bytes()));
        tail.judge(last.as_bytes())
    }

    /// The right answers follow from what the formats can write.
    #[test]
    fn the_numbers_above_tell_whether_the_last_is_whole() {
        let fixed = ["0.000000", "-1.250000", "12.345678"];
        let scientific = ["0.00000e+00", "-1.25000e-01", "9.99999e+01"];
        let python = [
            "-0.09808613487255556",
            "0.1",
            "1.5e-05",
            "0.19597303217645348",
        ];
        let nine = ["0.0999451354", "0.550000012", "5.22562841e-05", "0.1"];
        let trimmed = ["0.5", "12.125", "0.0625"];
        for (above, last, verdict) in [
            (&fixed[..], "-0.250000", Verdict::Whole),
            (&fixed, "-0.25000", Verdict::Cut),
            (&fixed, "-0", Verdict::Cut),
            (&fixed, "-0.2500001", Verdict::Undecided),
            (&scientific, "1.00000e-01", Verdict::Whole),
            (&scientific, "1.00000e-0", Verdict::Cut),
            (&scientific, "1.00000", Verdict::Cut),
            (&python, "-0.29346274812395346", Verdict::Whole),
            (&python, "-0.2934627481239534", Verdict::Whole),
            (&python, "-0.293462748", Verdict::Undecided),
            (&python, "-0", Verdict::Undecided),
            (&python, "1.2345678901234567e-05", Verdict::Whole),
            (&python, "1.2345678901234567e-0", Verdict::Undecided),
            (&python, "1.2345678901234567", Verdict::Undecided),
            (&nine, "0.199989945", Verdict::Whole),
            (&nine, "0.19998994", Verdict::Undecided),
            (&trimmed, "0.1875", Verdict::Whole),
            (&trimmed, "0.1", Verdict::Undecided),
            (&["1", "2"], "3", Verdict::Whole),
            (&["1", "2"], "0.5", Verdict::Undecided),
            (&[], "0.1", Verdict::Undecided),
        ] {
            assert_eq!(judged(above, last), verdict, "{last} below {above:?}");
        }
    }
}
