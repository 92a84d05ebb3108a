//! What a closed form is called, and why it applies.

use super::line::Line;
use super::mode::Mode;
use super::modes::Modes;
use super::problem::{Group, Problem};

/// Method and reason of a group whose forces are linear everywhere.
pub(super) fn in_space(problem: &Problem, group: &Group, modes: &Modes) -> (String, String) {
    let one = modes
        .modes
        .first()
        .copied()
        .filter(|_| modes.modes.len() == 1);
    if let (Some(mode), true) = (one, group.links.is_empty()) {
        return alone(mode);
    }
    let line = one.and_then(|_| Line::of(problem, group));
    let on_line = line.is_some_and(|l| l.off.is_none());
    let where_ = if on_line { "in line" } else { "in space" };
    let subject = subject(group);
    let of = if group.links.len() == 1 {
        "whose rest length is 0"
    } else {
        "of rest length 0"
    };
    let reason = format!(
        "{subject} {of}: the force is linear everywhere{}",
        damping(group, modes)
    );
    (method(group, modes, where_), reason)
}

/// Method and reason of a group that moves on one line; `shortest` is what its springs with a rest
/// length do not fall below.
pub(super) fn on_line(group: &Group, modes: &Modes, shortest: Option<f64>) -> (String, String) {
    let while_ = match (shortest, group.links.len()) {
        (None, _) => ", where the force is linear".to_owned(),
        (Some(l), 1) => format!(
            ": the force is linear while the spring's length stays above {} m",
            below(l)
        ),
        (Some(l), _) => format!(
            ": the forces are linear while every length stays above {} m",
            below(l)
        ),
    };
    let moving = if group.links.len() == 1 {
        "moving along it"
    } else {
        "all on one line"
    };
    let reason = format!(
        "{}, {moving}{while_}{}",
        subject(group),
        damping(group, modes)
    );
    (method(group, modes, "in line"), reason)
}

/// A particle without springs.
fn alone(mode: Mode) -> (String, String) {
    let (method, reason) = if mode.g > 0.0 {
        (
            "fall with linear drag",
            "a free particle under constant forces and linear drag",
        )
    } else {
        ("parabola", "a free particle under constant forces alone")
    };
    (method.to_owned(), reason.to_owned())
}

fn subject(group: &Group) -> String {
    let particles = match group.free.len() {
        1 => "one free particle".to_owned(),
        n => format!("{n} free particles"),
    };
    match group.links.len() {
        1 => format!("{particles} on one spring"),
        n => format!("{particles} on {n} springs"),
    }
}

fn method(group: &Group, modes: &Modes, where_: &str) -> String {
    match modes.modes.as_slice() {
        [mode] => format!("oscillator {where_}, {}", regime(*mode)),
        [mode, _] if group.links.len() == 1 => {
            format!("two bodies on one spring, {}", regime(*mode))
        }
        modes => format!("eigendecomposition of {} modes", modes.len()),
    }
}

fn damping(group: &Group, modes: &Modes) -> &'static str {
    let damped = modes.modes.iter().any(|m| m.g > 0.0);
    if damped && group.free.len() > 1 {
        ", and damping keeps the modes apart"
    } else {
        ""
    }
}

fn regime(mode: Mode) -> &'static str {
    let Mode { w, g } = mode;
    // To the rounding of w and g.
    if (g - w).abs() <= 4.0 * f64::EPSILON * w {
        "critically damped"
    } else if g > w {
        "overdamped"
    } else if g > 0.0 {
        "underdamped"
    } else {
        "undamped"
    }
}

/// Two digits of a positive length, rounded down.
fn below(length: f64) -> String {
    let exponent = length.log10().floor();
    let unit = 10f64.powf(exponent - 1.0);
    // A length that is 0.8 but for its last bits is 0.8.
    let digits = (length / unit * (1.0 + 1e-12)).floor();
    if (-4.0..6.0).contains(&exponent) {
        let decimals = (1.0 - exponent).max(0.0) as usize;
        format!("{:.decimals$}", digits * unit)
    } else {
        format!("{:.1e}", digits * unit)
    }
}
