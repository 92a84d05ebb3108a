//! Numbers as the file writes them: `20`, `20.`, `2e1`, `0x14`; never quoted.

use super::refusal::refuse;
use super::shown::shorten;
use serde::de::{Deserialize, Deserializer, Error, Visitor};
use std::fmt;

/// Whole or not: ids must be whole, everything else takes either.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Number {
    Whole(i64),
    /// Possibly infinite or NaN: YAML has `.inf` and `.nan`.
    Real(f64),
}

impl Number {
    pub(super) fn value(self) -> f64 {
        match self {
            Number::Whole(n) => n as f64,
            Number::Real(x) => x,
        }
    }

    /// The number as an id: whole and not negative.
    pub(super) fn whole(self) -> Option<usize> {
        match self {
            Number::Whole(n) => usize::try_from(n).ok(),
            Number::Real(_) => None,
        }
    }
}

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Number::Whole(n) => write!(f, "{n}"),
            Number::Real(x) => write!(f, "{x:?}"),
        }
    }
}

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Number, D::Error> {
        from.deserialize_any(Reader)
    }
}

struct Reader;

impl Visitor<'_> for Reader {
    type Value = Number;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a number")
    }

    fn visit_i64<E: Error>(self, n: i64) -> Result<Number, E> {
        Ok(Number::Whole(n))
    }

    fn visit_u64<E: Error>(self, n: u64) -> Result<Number, E> {
        Ok(i64::try_from(n).map_or(Number::Real(n as f64), Number::Whole))
    }

    fn visit_i128<E: Error>(self, n: i128) -> Result<Number, E> {
        Ok(Number::Real(n as f64))
    }

    fn visit_u128<E: Error>(self, n: u128) -> Result<Number, E> {
        Ok(Number::Real(n as f64))
    }

    fn visit_f64<E: Error>(self, x: f64) -> Result<Number, E> {
        Ok(Number::Real(x))
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Number, E> {
        let message = format!("expected a number, found the text `{}`", shorten(text));
        Err(refuse("", &message, &remedy(text)))
    }
}

/// Why the text is none, though it may look like a number.
fn remedy(text: &str) -> String {
    let digits = text.trim_start_matches(['-', '+']);
    let all_digits = !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit());
    if all_digits && digits.len() > 1 && digits.starts_with('0') && digits.len() <= 40 {
        let plain = match digits.trim_start_matches('0') {
            "" => "0",
            plain => plain,
        };
        return format!("a leading zero can mean octal: write {plain}, or 0o{plain} for octal");
    }
    match text.parse::<f64>() {
        Ok(x) if x.is_finite() => "a quoted number is text: remove the quotes".into(),
        Ok(_) if all_digits || text.contains(['e', 'E']) => "too large for a double".into(),
        _ if text.len() <= 40 && text.replacen(',', ".", 1).parse::<f64>().is_ok() => {
            "decimals take a point, not a comma".into()
        }
        _ => "write a number such as 2, 2.5 or 1e-3".into(),
    }
}
