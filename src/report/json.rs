//! The machine-readable report: the contract's keys, indented, floats that round-trip.

use crate::outcome::Report;
use serde::Serialize;

/// One report as one object.
pub fn render(report: &Report) -> String {
    debug_assert!(
        is_finite(report),
        "a report holds NaN or infinity, which JSON would turn into null without a reason"
    );
    pretty(report)
}

/// One report as an object, any other number as an array.
pub fn render_all(reports: &[Report]) -> String {
    debug_assert!(
        reports.iter().all(is_finite),
        "a report holds NaN or infinity"
    );
    match reports {
        [report] => pretty(report),
        _ => pretty(reports),
    }
}

fn pretty<T: Serialize + ?Sized>(value: &T) -> String {
    // Fails only for a `Serialize` that refuses or a map with keys that are no strings: not here.
    let mut text = serde_json::to_string_pretty(value).unwrap_or_default();
    text.push('\n');
    text
}

/// No NaN and no infinity in anything the JSON carries. `Debug` reaches every field, also those a
/// later version adds, and prints such numbers as bare words.
fn is_finite(report: &Report) -> bool {
    let numbers = format!(
        "{:?}",
        (
            &report.scene,
            &report.truth,
            &report.outcomes,
            &report.checks,
            &report.fault,
            &report.stability,
            &report.cost
        )
    );
    let mut text = String::with_capacity(numbers.len());
    let (mut quoted, mut escaped) = (false, false);
    for c in numbers.chars() {
        match c {
            _ if escaped => escaped = false,
            '\\' if quoted => escaped = true,
            '"' => quoted = !quoted,
            _ if !quoted => text.push(c),
            _ => {}
        }
    }
    !text
        .split(|c: char| !c.is_alphanumeric() && c != '_')
        .any(|word| word == "NaN" || word == "inf")
}
