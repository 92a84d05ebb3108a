//! What `stability` found, for people: how limits and growth are written, and who says what.

pub mod markdown;
pub mod terminal;
pub mod verdict;

use super::notes::listed;
use super::words::{self, NOTHING};
use crate::outcome::{Report, Stability, StabilityRow};

/// Whether limits are all a report has.
pub fn is_alone(report: &Report) -> bool {
    report.stability.is_some() && report.outcomes.is_empty()
}

/// A limit: four digits, `never` for 0, `always` where every step is stable.
pub fn limit(limit: Option<f64>, unconditional: bool) -> String {
    match limit {
        Some(0.0) => "never".into(),
        Some(h) => digits(h),
        None if unconditional => "always".into(),
        None => NOTHING.into(),
    }
}

/// What running found: a limit, or what it lies between.
pub fn measured(row: &StabilityRow) -> String {
    match row.measured_between_s {
        Some([low, high]) => format!("{}..{}", digits(low), digits(high)),
        None => limit(row.measured_limit_s, row.measured_unconditional),
    }
}

/// Four significant digits, plain where that is short: `0.2828`, `3.535e-5`, `12.00`.
pub fn digits(value: f64) -> String {
    if !value.is_finite() {
        return NOTHING.into();
    }
    let exponent = value.abs().log10().floor();
    if (-3.0..4.0).contains(&exponent) {
        let decimals = (3.0 - exponent).clamp(0.0, 6.0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.3e}")
    }
}

/// Measured over predicted, where both are numbers above 0.
pub fn ratio(row: &StabilityRow) -> String {
    match (row.predicted_limit_s, row.measured_limit_s) {
        (Some(p), Some(m)) if p > 0.0 && m > 0.0 => match m / p {
            // As many decimals above 1 as below.
            ratio if (0.1..10.0).contains(&ratio) => format!("{ratio:.4}"),
            ratio => digits(ratio),
        },
        _ => NOTHING.into(),
    }
}

/// Growth of the amplitude, 1/s.
pub fn growth(per_s: Option<f64>) -> String {
    per_s.map_or(NOTHING.into(), digits)
}

/// Where the step stands: inside the limit, or how many times beyond.
pub fn place(row: &StabilityRow, timestep: f64) -> String {
    match (row.holds(timestep), row.limit()) {
        (Some(true), _) => "inside".into(),
        (Some(false), Some(limit)) if limit > 0.0 && timestep / limit < 1e6 => {
            format!("{} x beyond", words::quantity(timestep / limit))
        }
        (Some(false), _) => "beyond".into(),
        (None, _) => NOTHING.into(),
    }
}

/// Who says what; equal sentences are said once.
pub fn notes(stability: &Stability) -> Vec<(String, String)> {
    let mut said: Vec<(String, Vec<String>)> = Vec::new();
    for row in &stability.rows {
        for remark in &row.remarks {
            let (remark, engine) = (words::one_line(remark), words::one_line(&row.engine));
            match said.iter_mut().find(|(known, _)| *known == remark) {
                Some((_, engines)) => engines.push(engine),
                None => said.push((remark, vec![engine])),
            }
        }
    }
    let all = stability.rows.len();
    said.into_iter()
        .map(|(remark, engines)| {
            let subject = if engines.len() == all && all > 2 {
                "all".to_owned()
            } else {
                listed(&engines)
            };
            (subject, remark)
        })
        .collect()
}

/// What holds of the whole scene, line by line: label and text.
pub fn facts(stability: &Stability) -> Vec<(&'static str, String)> {
    let mut facts = Vec::new();
    let fastest = match stability.omega_max_rad_s {
        Some(omega) => format!("fastest mode {} rad/s", digits(omega)),
        None if stability.unsure => "fastest mode not known (damping couples too many)".to_owned(),
        None => "nothing oscillates".to_owned(),
    };
    let forces = if stability.linear {
        "every force is linear: limits are the same wherever the state is".to_owned()
    } else {
        format!(
            "forces are not linear: predicted about the start, and along the trajectory up to {} s",
            words::short(stability.horizon_s)
        )
    };
    facts.push(("linear", format!("{fastest}; {forces}")));
    if !stability.excluded.is_empty() {
        facts.push(("left out", listed(&stability.excluded)));
    }
    facts
}

/// What the map shows and how long each cell ran.
pub fn map_heading(stability: &Stability) -> Option<String> {
    let map = stability.map.as_ref()?;
    Some(format!(
        "{} x {} cells of {}, {} steps each at most",
        map.values.len(),
        map.timesteps_s.len(),
        words::one_line(&map.vary),
        words::count(map.steps_per_cell)
    ))
}
