//! The sentences of an explanation.

use crate::scene::Spring;

/// Four digits.
pub(super) fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    let size = rounded.abs();
    if rounded == 0.0 {
        "0".to_owned()
    } else if (1e-4..1e6).contains(&size) {
        format!("{rounded}")
    } else {
        format!("{rounded:e}")
    }
}

pub(super) fn spring_name(id: usize, spring: &Spring) -> String {
    let [a, b] = spring.ends;
    format!("spring {id} (particles {a} and {b})")
}

/// The row is the state after `steps` steps, not `span`.
pub(super) fn rows_lost(steps: u64, span: u64) -> String {
    if steps == 0 {
        return "the row repeats the one before it: a step was skipped, or a row written twice"
            .to_owned();
    }
    let lost = steps.abs_diff(span);
    let rows = if lost == 1 { "a row" } else { "rows" };
    if steps > span {
        format!("{rows} lost before this one, which lies {steps} steps on, not {span}")
    } else {
        format!("{rows} written too often: this one lies {steps} steps on, not {span}")
    }
}

pub(super) fn from_here_on(span: u64) -> String {
    if span > 1 {
        format!("from these {span} steps on")
    } else {
        "from this step on".to_owned()
    }
}

/// `again` of the `after` transitions after it depart too.
pub(super) fn how_often(span: u64, again: usize, after: usize) -> String {
    let here = if span > 1 {
        format!("within these {span} steps")
    } else {
        "in this step".to_owned()
    };
    match again {
        0 if after == 0 => here,
        0 => format!("{here} only"),
        _ => {
            format!("{here}, and {again} of the {after} transitions after it leave the scheme too")
        }
    }
}

pub(super) fn with_count(says: String, off: usize, particles: usize) -> String {
    match off {
        0 | 1 => says,
        _ if off == particles => format!("{says}; all {particles} particles leave the scheme"),
        _ => format!("{says}; {off} of {particles} particles leave the scheme"),
    }
}
