//! Numbers as people say them.

/// A number with this many digits, without trailing zeros.
pub(super) fn digits(value: f64, count: usize) -> String {
    let rounded = format!("{value:.*e}", count.saturating_sub(1));
    // No minus before a zero.
    let rounded = rounded.parse().unwrap_or(value) + 0.0;
    if rounded == 0.0 || (1e-4..1e6).contains(&rounded.abs()) {
        format!("{rounded}")
    } else {
        format!("{rounded:e}")
    }
}

/// "half", "twice", "0.999 of".
pub(super) fn times(factor: f64) -> String {
    let said = digits(factor, 6);
    match said.parse().unwrap_or(factor) {
        0.5 => "half".to_owned(),
        2.0 => "twice".to_owned(),
        0.0..=2.0 => format!("{said} of"),
        _ => format!("{said} times"),
    }
}

/// A step as people choose it: `1/60` where it is one over a whole number.
pub(super) fn seconds(h: f64) -> String {
    let short = digits(h, 6);
    let whole = h.recip().round();
    let exactly = (h.recip() - whole).abs() <= 1e-9 * whole;
    if exactly && whole > 1.0 && short.parse() != Ok(h) {
        format!("1/{whole}")
    } else {
        short
    }
}
