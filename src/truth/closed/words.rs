//! The name of a closed form, and the reason why it applies.

use super::group::Group;
use super::line::Line;
use super::mode::Mode;

/// Method and reason of a group whose forces are linear everywhere.
pub(super) fn in_space(group: &Group, modes: &[Mode]) -> (String, String) {
    if let ([mode], []) = (modes, &group.links[..]) {
        let (method, reason) = if mode.g > 0.0 {
            (
                "fall with linear drag",
                "a free particle under constant forces and linear drag",
            )
        } else {
            ("parabola", "a free particle under constant forces alone")
        };
        return (method.to_owned(), reason.to_owned());
    }
    let on_line = modes.len() == 1 && Line::of(group).is_some_and(|l| l.offset.is_none());
    let of = if group.links.len() == 1 {
        "whose rest length is 0"
    } else {
        "of rest length 0"
    };
    let reason = format!(
        "{} {of}: the force is linear everywhere{}",
        subject(group),
        damping(modes)
    );
    let where_ = if on_line { "in line" } else { "in space" };
    (method(group, modes, where_), reason)
}

/// Method and reason of a group that moves on one line; `shortest` is a lower bound of its springs
/// with a rest length, m.
pub(super) fn on_line(group: &Group, modes: &[Mode], shortest: Option<f64>) -> (String, String) {
    let (moving, stays) = if group.links.len() == 1 {
        (
            "moving along it",
            "force is linear while the spring's length stays",
        )
    } else {
        (
            "all on one line",
            "forces are linear while every length stays",
        )
    };
    let while_ = match shortest {
        None => ", where the force is linear".to_owned(),
        Some(length) => format!(": the {stays} above {} m", below(length)),
    };
    let reason = format!("{}, {moving}{while_}{}", subject(group), damping(modes));
    (method(group, modes, "in line"), reason)
}

/// As an adjective of a group with driven ends.
fn driven(group: &Group) -> &'static str {
    if group.is_driven() { "driven " } else { "" }
}

fn subject(group: &Group) -> String {
    let particles = match group.bodies.len() {
        1 => "one free particle".to_owned(),
        n => format!("{n} free particles"),
    };
    match group.links.len() {
        1 if group.is_driven() => format!("{particles} on one spring with a driven end"),
        1 => format!("{particles} on one spring"),
        n if group.is_driven() => format!("{particles} on {n} springs with driven ends"),
        n => format!("{particles} on {n} springs"),
    }
}

fn method(group: &Group, modes: &[Mode], where_: &str) -> String {
    match modes {
        [mode] => format!("{}oscillator {where_}, {}", driven(group), regime(*mode)),
        [mode, _] if group.links.len() == 1 => {
            format!("two bodies on one spring, {}", regime(*mode))
        }
        modes => format!(
            "eigendecomposition of {} {}modes",
            modes.len(),
            driven(group)
        ),
    }
}

fn damping(modes: &[Mode]) -> &'static str {
    if modes.len() > 1 && modes.iter().any(|m| m.g > 0.0) {
        ", and damping keeps the modes apart"
    } else {
        ""
    }
}

fn regime(mode: Mode) -> &'static str {
    let Mode { w, g } = mode;
    // The two are equal to the rounding of w and g.
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
