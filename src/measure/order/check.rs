//! What a report says of a measured order.

use super::observed::{Point, TOLERANCE, Verdict};
use super::study::Measured;
use crate::measure::{Check, CheckStatus};

/// The check `order` of this method: passes at the stated order minus [`TOLERANCE`] or above.
pub fn check(subject: &str, measured: &Measured) -> Check {
    let seen = &measured.observed;
    let bound = f64::from(seen.stated) - TOLERANCE;
    let used: Vec<&Point> = seen
        .used
        .iter()
        .filter_map(|&i| measured.points.get(i))
        .collect();
    let range = match (used.first(), used.last()) {
        (Some(coarse), Some(fine)) => format!(
            "{} steps from {:.2e} to {:.2e} s",
            used.len(),
            coarse.h,
            fine.h
        ),
        _ => format!("{} steps", measured.points.len()),
    };
    let status = match seen.verdict {
        Verdict::Meets | Verdict::Above => CheckStatus::Pass,
        Verdict::Misses => CheckStatus::Fail,
        Verdict::Inconclusive(_) => CheckStatus::Inconclusive,
    };
    Check {
        id: "order".to_owned(),
        subject: subject.to_owned(),
        status,
        measured: seen.order,
        bound: Some(bound),
        derivation: format!(
            "the stated order {} less {TOLERANCE}; from the largest position error over {:.3} s at {range}",
            seen.stated, measured.until
        ),
        message: message(subject, measured),
    }
}

fn message(subject: &str, measured: &Measured) -> String {
    let seen = &measured.observed;
    let stated = seen.stated;
    match (seen.verdict, seen.order) {
        (Verdict::Inconclusive(reason), _) => {
            let mut message = format!("{subject}: no order to be seen, {reason}");
            if let Some((h, why)) = measured.left_out.last() {
                message.push_str(&format!("; the run at h = {h:.2e} s {why}"));
            }
            message
        }
        (Verdict::Misses, Some(order)) => {
            format!("{subject} is of order {order:.2}, not {stated} as it states")
        }
        (Verdict::Above, Some(order)) => {
            format!("{subject} shows order {order:.2} here, above the {stated} it states")
        }
        (_, Some(order)) => format!("{subject} is of order {order:.2}, as stated"),
        (_, None) => format!("{subject}: no order to be seen"),
    }
}
