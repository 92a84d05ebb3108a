//! Facts about a rest, line by line: label and text.

use crate::report::words::{self, digits, one_line};
use crate::scene::object::{Body, called};
use crate::verbs::rest::{Balance, Pull};

/// Reactions that a text names.
const HELD: usize = 4;
/// Parts of the largest number beside it that are its rounding.
const ROUNDING: f64 = 1e-12;

pub fn facts(found: &Balance, bodies: &[Body]) -> Vec<(&'static str, String)> {
    let left = format!(
        "a force of {} N, after {}",
        words::sci(found.force_left_n),
        words::plural(found.newton_iterations, "Newton iteration")
    );
    let facts = [
        ("moved", moved(found)),
        ("energy", energies(found)),
        ("tension", tensions(found, bodies)),
        ("held", held(found, bodies)),
        ("left", left),
    ];
    facts
        .into_iter()
        .filter(|(_, text)| !text.is_empty())
        .collect()
}

/// The vector, where the verdict has its length alone.
fn moved(found: &Balance) -> String {
    let skewed = found.farthest.filter(|moved| moved.along().is_none());
    skewed.map_or_else(String::new, |moved| format!("by {} m", vector(moved.by_m)))
}

fn energies(found: &Balance) -> String {
    let all = found.potential_j.values().flatten();
    let largest = all.fold(0.0, |most: f64, joules| most.max(joules.abs()));
    let told = found
        .potential_j
        .iter()
        .map(|(id, energies)| (id, energies.map(|joules| told(joules, largest))));
    let texts = told
        .filter(|(_, energies)| *energies != [0.0; 2])
        .map(|(id, energies)| {
            let [start, end] = energies.map(digits);
            format!("{} {start} to {end} J", one_line(id))
        });
    texts.collect::<Vec<_>>().join(", ")
}

fn tensions(found: &Balance, bodies: &[Body]) -> String {
    let (Some(most), Some(least)) = (&found.tension_max, &found.tension_min) else {
        return String::new();
    };
    let of = |pull: &Pull| {
        let [a, b] = pull.particles.map(|id| called(bodies, id));
        format!("between particles {a} and {b}")
    };
    let newtons = |pull: &Pull| format!("{} N", digits(pull.tension_n));
    if newtons(most) == newtons(least) {
        let what = if most.rod.is_some() || least.rod.is_some() {
            "rod"
        } else {
            "spring"
        };
        return format!("{} in every {what}", newtons(most));
    }
    format!(
        "at most {} {}, at least {} {}",
        newtons(most),
        of(most),
        newtons(least),
        of(least)
    )
}

fn held(found: &Balance, bodies: &[Body]) -> String {
    let reactions = found.reactions.iter();
    let all: Vec<String> = reactions
        .filter(|reaction| reaction.force_n != [0.0; 3])
        .map(|reaction| {
            let by = vector(reaction.force_n);
            format!("particle {} by {by} N", called(bodies, reaction.particle))
        })
        .collect();
    let hidden = all.len().saturating_sub(HELD);
    let more = (hidden > 0).then(|| format!("{hidden} more"));
    let shown = all.into_iter().take(HELD).chain(more);
    shown.collect::<Vec<_>>().join("; ")
}

/// `(0, 0, 9.32)`
fn vector(of: [f64; 3]) -> String {
    let largest = of.iter().fold(0.0, |most: f64, c| most.max(c.abs()));
    let parts = of.map(|c| words::short(told(c, largest)));
    format!("({})", parts.join(", "))
}

/// The number, or 0 where it is a rounding of the largest beside it.
fn told(value: f64, largest: f64) -> f64 {
    if value.abs() <= ROUNDING * largest {
        0.0
    } else {
        value
    }
}
