//! The verdict of `stability`: the most important facts about limits.

use super::limit;
use crate::report::verdict::Clause;
use crate::report::words::{self, digits, listed};
use crate::verbs::Report;
use crate::verbs::stability::{Largest, LargestFound, Stability, StabilityRow};

/// The scene's own integrator comes first, then the engines that are beyond their limit at the timestep,
/// never stable, always stable, and without an answer.
pub fn clauses(report: &Report, stability: &Stability) -> Vec<Clause> {
    let h = stability.timestep_s;
    let rows = stability.rows.iter();
    let (own, others): (Vec<_>, Vec<_>) = rows.partition(|row| report.header.is_own(&row.engine));
    let beyond = |row: &StabilityRow| {
        row.holds(h) == Some(false) && row.limit().is_some_and(|limit| limit > 0.0)
    };
    type Belongs<'a> = &'a dyn Fn(&StabilityRow) -> bool;
    let groups: [(&str, Belongs); 4] = [
        ("beyond their limit", &beyond),
        ("never stable", &|row| row.limit() == Some(0.0)),
        ("always stable", &|row| row.limit() == Some(f64::INFINITY)),
        ("without an answer", &|row| {
            row.limit().is_none() && !row.unsupported
        }),
    ];
    let mut clauses: Vec<Clause> = Vec::new();
    clauses.extend(own.first().and_then(|row| first(row, h)));
    let asked = stability.largest.as_ref();
    clauses.extend(asked.and_then(|largest| largest_value(report, largest)));
    for (label, belongs) in groups {
        let names = others.iter().filter(|row| belongs(row));
        clauses.extend(group(
            label,
            names.map(|row| words::one_line(&row.engine)).collect(),
        ));
    }
    if clauses.is_empty() {
        return vec![vec![
            "every step asked about is inside its limit".to_owned(),
        ]];
    }
    let inside = others.into_iter().filter(|row| !beyond(row));
    clauses.extend(least(inside).map(|least| vec![least, String::new()]));
    clauses
}

fn first(row: &StabilityRow, h: f64) -> Option<Clause> {
    let name = words::one_line(&row.engine);
    let step = words::short(h);
    let text = match row.limit() {
        None => format!("the limit of {name} is not known"),
        Some(0.0) => format!("{name} is never stable here"),
        Some(f64::INFINITY) => format!("{name} is stable at every step"),
        Some(found) => {
            let limit = limit(Some(found), false);
            if row.holds(h)? {
                format!("{name} is stable up to h = {limit} s, and {step} s is inside")
            } else {
                format!("{name} IS UNSTABLE at h = {step} s: its limit is {limit} s")
            }
        }
    };
    Some(vec![text])
}

/// The answer to the question for the largest value, for the scene's own integrator or else the first.
fn largest_value(report: &Report, largest: &Largest) -> Option<Clause> {
    let own = largest
        .rows
        .iter()
        .find(|row| report.header.is_own(&row.engine));
    let row = own.or(largest.rows.first())?;
    let (name, key) = (words::one_line(&row.engine), words::one_line(&largest.vary));
    let step = words::short(largest.timestep_s);
    let [low, high] = largest.tried.map(words::short);
    let unit = &largest.unit;
    let stable = format!("at h = {step} s {name} is stable");
    Some(vec![match row.found {
        LargestFound::Value => format!("{stable} up to {key} = {} {unit}", digits(row.value?)),
        LargestFound::EveryValue => format!("{stable} at every {key} tried, up to {high} {unit}"),
        LargestFound::NoValue => format!("{stable} at no {key} tried, down to {low} {unit}"),
        LargestFound::NotKnown => {
            format!("the largest {key} of {name} at h = {step} s is not known")
        }
    }])
}

/// The engines of one group: by name, by number, or left out.
fn group(label: &str, names: Vec<String>) -> Option<Clause> {
    let mut forms = vec![format!("{} {label}", names.len()), String::new()];
    if names.len() <= 4 {
        forms.insert(0, format!("{label}: {}", listed(&names)));
    }
    (!names.is_empty()).then_some(forms)
}

/// The engine with the smallest limit of those that are inside.
fn least<'a>(rows: impl Iterator<Item = &'a StabilityRow>) -> Option<String> {
    let limits = rows.filter_map(|row| Some((row, row.limit()?)));
    let finite = limits.filter(|(_, h)| *h > 0.0 && h.is_finite());
    let (row, h) = finite.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let (name, limit) = (words::one_line(&row.engine), limit(Some(h), false));
    Some(format!("next to give way: {name} at {limit} s"))
}
