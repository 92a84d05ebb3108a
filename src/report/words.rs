//! Words and numbers, as all human-readable reports write them.

use crate::measure::{Behaviour, Check, CheckStatus, Energy};
use crate::report::TruthFacts;
use crate::scene::words::acts;
use crate::truth::TruthKind;
use serde::Serialize;

/// The text of an empty cell.
pub const NOTHING: &str = "-";

/// Two significant digits, in the form people say: `3.1e-4`, `0.012`, `1.2`, `11`, `1,100`; exact zero is
/// `0`.
pub fn sci(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        v if (0.00995..0.0995).contains(&v) => format!("{value:.3}"),
        v if (0.0995..0.995).contains(&v) => format!("{value:.2}"),
        v if (0.995..9.95).contains(&v) => format!("{value:.1}"),
        v if (9.95..9.95e4).contains(&v) => {
            let unit = 10f64.powf(v.log10().floor() - 1.0).max(1.0);
            let sign = if value < 0.0 { "-" } else { "" };
            format!("{sign}{}", count(((v / unit).round() * unit) as u64))
        }
        _ => format!("{value:.1e}"),
    }
}

/// A part in percent, three digits: `10 %`, `0.25 %`.
pub fn percent(part: f64) -> String {
    format!("{} %", quantity(100.0 * part))
}

/// A part of the scene's energy S: `11 times its energy`, `0.25 % of its energy`, `2.0e-5 of its energy`.
pub fn share(error: f64) -> String {
    match error {
        e if e >= 0.995 => format!("{} times its energy", sci(e)),
        e if e >= 1e-4 => format!("{} % of its energy", sci(100.0 * e)),
        e => format!("{} of its energy", sci(e)),
    }
}

/// Two significant digits, plain where possible: `0.31`, `12`, `3.1e4`.
pub fn short_sci(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        v if (0.995..99.5).contains(&v) => format!("{value:.0}"),
        v if (0.00995..0.995).contains(&v) => format!("{value:.2}"),
        _ => sci(value),
    }
}

/// A number a check compares, three digits: `2.97` or `1.1e-16`.
pub fn quantity(value: f64) -> String {
    match value.abs() {
        v if (0.0995..999.5).contains(&v) => short((value * 1e3).round() / 1e3),
        _ => sci(value),
    }
}

/// The measured value of a check and its bound, with the sign between them; empty without numbers.
pub fn measured(check: &Check) -> String {
    let passed = check.status == CheckStatus::Pass;
    match (check.measured, check.bound) {
        (Some(m), Some(b)) => {
            let sign = match (passed, m <= b) {
                (true, true) => "<=",
                (true, false) => ">=",
                (false, _) if m == b => "=",
                (false, true) => "<",
                (false, false) => ">",
            };
            format!("{} {sign} {}", quantity(m), quantity(b))
        }
        (Some(m), None) => quantity(m),
        _ => String::new(),
    }
}

/// A number as an author would write it, with at most three digits unless it is short already:
/// `0.0005`, `5`, `3.33e-4`.
pub fn short(value: f64) -> String {
    let plain = format!("{value}");
    if plain.len() <= 7 {
        return plain;
    }
    let digits = format!("{value:.2e}");
    // The largest number rounds to infinity.
    let Some(rounded) = digits.parse::<f64>().ok().filter(|r| r.is_finite()) else {
        return digits;
    };
    let plain = format!("{rounded}");
    if plain.len() <= 7 {
        plain
    } else {
        format!("{rounded:e}")
    }
}

/// Four significant digits, plain where that is short: `0.2828`, `3.535e-5`, `12.00`.
pub fn digits(value: f64) -> String {
    if !value.is_finite() {
        return NOTHING.into();
    }
    if value == 0.0 {
        return "0".into();
    }
    let exponent = value.abs().log10().floor();
    if (-3.0..4.0).contains(&exponent) {
        let decimals = (3.0 - exponent).clamp(0.0, 6.0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.3e}")
    }
}

/// Seconds with a fitting prefix and three digits: `12.3 ms`.
pub fn seconds(value: f64) -> String {
    let (scale, unit) = match value.abs() {
        v if v >= 0.9995 => (1.0, "s"),
        v if v >= 0.9995e-3 => (1e3, "ms"),
        v if v >= 0.9995e-6 => (1e6, "µs"),
        _ => (1e9, "ns"),
    };
    let scaled = value * scale;
    let text = match scaled.abs() {
        v if v >= 1e6 => format!("{scaled:.1e}"),
        v if v >= 99.95 => format!("{scaled:.0}"),
        v if v >= 9.995 => format!("{scaled:.1}"),
        _ => format!("{scaled:.2}"),
    };
    format!("{text} {unit}")
}

/// Counts grouped by thousands up to a million, `1.23M` and `4.50G` beyond.
pub fn count(value: u64) -> String {
    match value {
        0..=999 => value.to_string(),
        1_000..=999_999 => format!("{},{:03}", value / 1_000, value % 1_000),
        1_000_000..=999_999_999 => format!("{:.2}M", value as f64 / 1e6),
        1_000_000_000..=999_999_999_999 => format!("{:.2}G", value as f64 / 1e9),
        _ => format!("{:.1e}", value as f64),
    }
}

/// `1 spring`, `3 springs`.
pub fn plural(value: u64, noun: &str) -> String {
    let ending = if value == 1 { "" } else { "s" };
    format!("{} {noun}{ending}", count(value))
}

/// A class, status or kind as the JSON spells it.
pub fn id(value: impl Serialize) -> String {
    let value = serde_json::to_value(value).unwrap_or_default();
    value.as_str().unwrap_or_default().to_owned()
}

/// `a`, `a and b`, `a, b and c`.
pub fn listed(texts: &[String]) -> String {
    match texts {
        [] => String::new(),
        [only] => only.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// The pairs grouped by equal second parts, in the order these first come.
pub fn grouped<M, T: PartialEq>(pairs: impl Iterator<Item = (M, T)>) -> Vec<(T, Vec<M>)> {
    let mut groups: Vec<(T, Vec<M>)> = Vec::new();
    for (member, of) in pairs {
        match groups.iter_mut().find(|(known, _)| *known == of) {
            Some((_, members)) => members.push(member),
            None => groups.push((of, vec![member])),
        }
    }
    groups
}

/// The largest relative energy error, with a sign for growing or falling energy.
pub fn energy_error(energy: &Energy) -> Option<String> {
    let error = energy.relative_error_max?;
    let rises = energy.drift_per_s.is_some_and(|d| d > 0.0);
    let sign = match energy.behaviour() {
        _ if error == 0.0 => "",
        Some(Behaviour::Growing) => "+",
        Some(Behaviour::Dissipating) => "-",
        Some(Behaviour::Drifting) if rises => "+",
        Some(Behaviour::Drifting) => "-",
        Some(_) => "±",
        None => "",
    };
    Some(format!("{sign}{}", sci(error)))
}

/// An error against the truth; `floor` below ten times the truth's error bar.
pub fn truth_error(error: f64, truth: &TruthFacts) -> String {
    match truth.error_bound_m {
        Some(bar) if error < 10.0 * bar => "floor".into(),
        _ => sci(error),
    }
}

/// The truth of this scene, in one line.
pub fn truth(truth: &TruthFacts) -> String {
    let kind = match truth.kind {
        TruthKind::ClosedForm => "closed form",
        TruthKind::Converged => "converged reference",
        TruthKind::None => "none",
    };
    let mut text = kind.to_owned();
    if let Some(method) = &truth.method {
        text += &format!(", {method}");
    }
    if let Some(bound) = truth.error_bound_m {
        text += &format!(", good to {} m", sci(bound));
    }
    if let Some(horizon) = truth.horizon_s {
        text += &format!(" up to {} s", short(horizon));
    }
    if let Some(reason) = &truth.reason {
        text += &format!(" ({reason})");
    }
    text
}

/// One printable line: control characters and runs of white space become single spaces; invisible
/// characters that could reorder or restyle the line go.
pub fn one_line(text: &str) -> String {
    let is_invisible = |c: &char| acts(*c) && !c.is_control();
    let visible: String = text.chars().filter(|c| !is_invisible(c)).collect();
    let separates = |c: char| c.is_control() || c.is_whitespace();
    let words = visible.split(separates).filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join(" ")
}

/// Text for XML. What XML 1.0 forbids, and what acts on the text around it instead of being shown, is replaced by
/// U+FFFD.
pub fn in_xml(text: &str) -> String {
    let wrong = |c: char| c != '\n' && (acts(c) || matches!(c, '\u{fffe}' | '\u{ffff}'));
    text.replace(wrong, "\u{fffd}")
}

/// The timesteps of the outcomes: `0.0005 s`, or `several, the file's 0.0005 s`; `own` is the file's.
pub fn timestep(own: f64, steps: &[f64]) -> String {
    match steps {
        [] => format!("{} s", short(own)),
        [first, others @ ..] if others.iter().all(|h| h == first) => format!("{} s", short(*first)),
        _ => format!("several, the file's {} s", short(own)),
    }
}

/// Text on one line, with everything escaped that Markdown or HTML would interpret.
pub fn escape(text: &str) -> String {
    let text = one_line(text);
    let mut escaped = String::with_capacity(text.len());
    let mut before = ' ';
    let mut rest = text.chars().peekable();
    while let Some(c) = rest.next() {
        let after = rest.peek().copied().unwrap_or(' ');
        match c {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '\\' | '`' | '*' | '[' | ']' | '|' | '~' | '#' | '$' => escaped.extend(['\\', c]),
            // Inside a word an underscore is itself: ids stay legible in the source.
            '_' if !(before.is_alphanumeric() && after.is_alphanumeric()) => escaped += "\\_",
            '+' | '-' if escaped.is_empty() && after == ' ' => escaped.extend(['\\', c]),
            c => escaped.push(c),
        }
        before = c;
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::{sci, share};

    #[test]
    fn numbers_are_written_as_people_say_them() {
        for (value, text) in [
            (0.0, "0"),
            (3.14e-4, "3.1e-4"),
            (0.0123, "0.012"),
            (-0.284, "-0.28"),
            (0.996, "1.0"),
            (1.24, "1.2"),
            (9.96, "10"),
            (11.2, "11"),
            (1_120.0, "1,100"),
            (-40_300.0, "-40,000"),
            (1.2e12, "1.2e12"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(sci(value), text);
        }
        assert_eq!(share(11.2), "11 times its energy");
        assert_eq!(share(0.0025), "0.25 % of its energy");
        assert_eq!(share(2.1e-12), "2.1e-12 of its energy");
    }
}
