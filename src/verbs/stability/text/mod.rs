//! What `stability` found, for people: how limits and growth are written, and who says what.

pub mod markdown;
pub mod terminal;
pub mod verdict;

use crate::report::notes::listed;
use crate::report::table::{Mark, Table};
use crate::report::terminal::paint::Tone;
use crate::report::words::{self, NOTHING};
use crate::verbs::Report;
use crate::verbs::stability::{Stability, StabilityRow};

/// The table of limits, in the terminal and in Markdown.
fn table<'a>(report: &Report, stability: &'a Stability) -> Table<'a, StabilityRow> {
    let h = stability.timestep_s;
    let own = &report.header.scene.own_integrator;
    let any = |wanted: fn(&StabilityRow) -> bool| stability.rows.iter().any(wanted);
    let mut table = Table::new(&stability.rows);
    table.engines(|row| (row.engine.clone(), Mark::of(&row.engine, own)));
    table.right("predicted\nlimit (s)", "predicted limit (s)", 0, |row| {
        limit(row.predicted_limit_s, row.unconditional)
    });
    table.right("measured\nlimit (s)", "measured limit (s)", 0, measured);
    table.right("ratio", "ratio", 2, ratio);
    if any(|row| row.tightest.is_some()) {
        let tightest = |row: &StabilityRow| row.tightest.clone();
        table.markdown("tightest along the way (s)", |row| {
            limit(tightest(row).map(|tightest| tightest.limit_s), false)
        });
        table.markdown("at t (s)", |row| {
            tightest(row).map_or(NOTHING.into(), |tightest| words::short(tightest.t_s))
        });
    }
    // The terminal drops it by itself where nobody has one.
    let smooth = any(|row| row.smooth_below_s.or(row.measured_smooth_below_s).is_some());
    let below = if smooth { "smooth below (s)" } else { "" };
    table.right("smooth\nbelow (s)", below, 4, |row| {
        limit(row.smooth_below_s, false)
    });
    if smooth {
        table.markdown("measured (s)", |row| {
            limit(row.measured_smooth_below_s, false)
        });
    }
    table.right("growth/s\npredicted", "growth predicted (1/s)", 1, |row| {
        growth(row.growth_per_s)
    });
    table.right("growth/s\nmeasured", "growth measured (1/s)", 1, |row| {
        growth(row.measured_growth_per_s)
    });
    let step = words::short(h);
    let [terminal, markdown] = [format!("at h =\n{step} s"), format!("h = {step} s")];
    table.left(&terminal, &markdown, |row| {
        let tone = |holds| if holds { Tone::Good } else { Tone::Bad };
        (place(row, h), row.holds(h).map(tone))
    });
    table
}

/// A limit: four digits, `never` for 0, `always` where every step is stable.
fn limit(limit: Option<f64>, unconditional: bool) -> String {
    match limit {
        Some(0.0) => "never".into(),
        Some(h) => digits(h),
        None if unconditional => "always".into(),
        None => NOTHING.into(),
    }
}

/// What running found: a limit, or what it lies between.
fn measured(row: &StabilityRow) -> String {
    match row.measured_between_s {
        Some([low, high]) => format!("{}..{}", digits(low), digits(high)),
        None => limit(row.measured_limit_s, row.measured_unconditional),
    }
}

/// Four significant digits, plain where that is short: `0.2828`, `3.535e-5`, `12.00`.
fn digits(value: f64) -> String {
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
fn ratio(row: &StabilityRow) -> String {
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
fn growth(per_s: Option<f64>) -> String {
    per_s.map_or(NOTHING.into(), digits)
}

/// Where the step stands: inside the limit, or how many times beyond.
fn place(row: &StabilityRow, timestep: f64) -> String {
    match (row.holds(timestep), row.limit()) {
        (Some(true), _) => "inside".into(),
        (Some(false), Some(limit)) if limit > 0.0 && timestep / limit < 1e6 => {
            format!("{} x beyond", words::quantity(timestep / limit))
        }
        (Some(false), _) => "beyond".into(),
        (None, _) => NOTHING.into(),
    }
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
fn map_heading(stability: &Stability) -> Option<String> {
    let map = stability.map.as_ref()?;
    Some(format!(
        "{} x {} cells of {}, {} steps each at most",
        map.values.len(),
        map.timesteps_s.len(),
        words::one_line(&map.vary),
        words::count(map.steps_per_cell)
    ))
}
