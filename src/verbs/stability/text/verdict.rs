//! The sentence that says the most important thing about limits.

use super::limit;
use crate::report::verdict::Clause;
use crate::report::words::{self, listed};
use crate::verbs::Report;
use crate::verbs::stability::{Stability, StabilityRow};

/// The scene's own integrator first, then who is beyond its limit at the step asked about, who is
/// never stable, who always, and who has no answer.
pub fn clauses(report: &Report, stability: &Stability) -> Vec<Clause> {
    let h = stability.timestep_s;
    let own = |row: &&StabilityRow| row.engine == report.header.scene.own_integrator;
    let mut clauses: Vec<Clause> = Vec::new();
    clauses.extend(
        stability
            .rows
            .iter()
            .find(own)
            .and_then(|row| first(row, h)),
    );
    let others = || stability.rows.iter().filter(|row| !own(row));
    let beyond = |row: &&StabilityRow| {
        row.holds(h) == Some(false) && row.limit().is_some_and(|limit| limit > 0.0)
    };
    clauses.extend(group("beyond their limit", others().filter(beyond)));
    let never = |row: &&StabilityRow| row.limit() == Some(0.0);
    clauses.extend(group("never stable", others().filter(never)));
    let always = |row: &&StabilityRow| row.limit() == Some(f64::INFINITY);
    clauses.extend(group("always stable", others().filter(always)));
    let open = |row: &&StabilityRow| row.limit().is_none() && !row.unsupported;
    clauses.extend(group("without an answer", others().filter(open)));
    if let (Some(least), false) = (
        least(others().filter(|row| !beyond(row))),
        clauses.is_empty(),
    ) {
        clauses.push(vec![least, String::new()]);
    }
    if clauses.is_empty() {
        clauses.push(vec![
            "every step asked about is inside its limit".to_owned(),
        ]);
    }
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

/// By name, by number, not at all.
fn group<'a>(label: &str, rows: impl Iterator<Item = &'a StabilityRow>) -> Option<Clause> {
    let names: Vec<String> = rows.map(|row| words::one_line(&row.engine)).collect();
    (!names.is_empty()).then(|| {
        let counted = format!("{} {label}", names.len());
        if names.len() > 4 {
            vec![counted, String::new()]
        } else {
            vec![
                format!("{label}: {}", listed(&names)),
                counted,
                String::new(),
            ]
        }
    })
}

/// The smallest limit of those that are inside.
fn least<'a>(rows: impl Iterator<Item = &'a StabilityRow>) -> Option<String> {
    let finite = |row: &'a StabilityRow| Some((row, row.limit()?));
    let rows = rows
        .filter_map(finite)
        .filter(|(_, h)| *h > 0.0 && h.is_finite());
    let (row, h) = rows.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let name = words::one_line(&row.engine);
    Some(format!(
        "next to give way: {name} at {} s",
        limit(Some(h), false)
    ))
}
