//! `1e2..1e8:24`: a range, and the number of values in it.

use std::str::FromStr;

/// The number of values where the text does not give one.
pub const COUNT: usize = 24;
/// The most values: a picture of more cannot be read.
const MAX_COUNT: usize = 200;

/// Why a text is not a range of one quantity of the scene.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct VaryError(pub(super) String);

/// `A..B` or `A..B:N`, A below B.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// The first value.
    pub low: f64,
    /// The last value.
    pub high: f64,
    /// The number of values, with both ends.
    pub count: usize,
}

impl FromStr for Range {
    type Err = VaryError;

    fn from_str(text: &str) -> Result<Self, VaryError> {
        let form = || VaryError(format!("expected A..B or A..B:N, found `{text}`"));
        let (low, rest) = text.split_once("..").ok_or_else(form)?;
        let (high, count) = match rest.split_once(':') {
            Some((high, count)) => (high, Some(count)),
            None => (rest, None),
        };
        let number = |text: &str| {
            let number = text.trim().parse::<f64>().ok().filter(|n| n.is_finite());
            number.ok_or_else(|| VaryError(format!("expected a finite number, found `{text}`")))
        };
        let (low, high) = (number(low)?, number(high)?);
        if low >= high {
            let message = format!("expected a range that rises, found {low} to {high}");
            return Err(VaryError(message));
        }
        let count = count.map_or(Ok(COUNT), |count| {
            let parsed = count
                .trim()
                .parse()
                .ok()
                .filter(|n| (2..=MAX_COUNT).contains(n));
            parsed.ok_or_else(|| {
                VaryError(format!("expected 2 to {MAX_COUNT} values, found `{count}`"))
            })
        })?;
        Ok(Self { low, high, count })
    }
}

impl Range {
    /// Values evenly spaced in their logarithm where both ends are positive, else evenly. The ends are exact.
    pub fn values(&self) -> Vec<f64> {
        let last = self.count.saturating_sub(1).max(1);
        let at = |i: usize| {
            let part = i as f64 / last as f64;
            match i {
                0 => self.low,
                i if i == last => self.high,
                _ if self.low > 0.0 => {
                    (self.low.ln() + part * (self.high.ln() - self.low.ln())).exp()
                }
                _ => self.low + part * (self.high - self.low),
            }
        };
        (0..self.count).map(at).collect()
    }
}
