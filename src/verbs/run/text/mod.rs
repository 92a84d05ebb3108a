//! What `run` and `compare` found, for people: one row an engine and timestep, and, of a comparison, the
//! first step that leaves its scheme.

pub mod identity;
pub mod ledger;
pub mod markdown;
pub mod naming;
pub mod table;
pub mod verdict;

use crate::report::notes::{grouped, listed};
use crate::report::words;
use crate::solvers::Status;
use crate::verbs::Report;
use crate::verbs::run::Outcome;

/// The outcome's remarks, led by its reason for ending early where no remark repeats it.
pub fn sentences(outcome: &Outcome) -> Vec<String> {
    let remarks: Vec<String> = outcome.remarks.iter().map(|r| words::one_line(r)).collect();
    let mut sentences = Vec::new();
    if outcome.status != Status::Completed {
        let reason = outcome.reason.as_deref().map(words::one_line);
        let repeated = reason
            .as_ref()
            .is_some_and(|reason| remarks.iter().any(|r| r.contains(reason)));
        if !repeated {
            sentences.push(ending(outcome, reason));
        }
    }
    sentences.extend(remarks);
    sentences.extend(identity::sentence(outcome));
    sentences
}

/// `diverged at 1.23 s: ...`
fn ending(outcome: &Outcome, reason: Option<String>) -> String {
    let mut text = words::status(outcome.status).to_string();
    if let Some(t) = outcome.stopped_at_s {
        text += &format!(" at {} s", words::short(t));
    }
    if let Some(reason) = reason {
        text += &format!(": {reason}");
    }
    text
}

/// The engines of `chosen`, at most `limit` by name, each with its timesteps unless they are all
/// this report has of it: `midpoint, rk4 at h = 0.05 and 2 more`.
pub fn subjects(report: &Report, chosen: &[&Outcome], limit: usize) -> String {
    let engines = grouped(chosen.iter().map(|o| (words::short(o.timestep), &o.engine)));
    let hidden = engines.len().saturating_sub(limit);
    // "and 1 more" is no shorter than the name.
    let hidden = if hidden == 1 { 0 } else { hidden };
    let named = engines.iter().take(engines.len() - hidden);
    let mut texts: Vec<String> = named
        .map(|(engine, timesteps)| {
            let of_engine = |o: &&Outcome| o.engine == **engine;
            let all = report.outcomes().iter().filter(of_engine).count();
            let name = words::one_line(engine);
            if timesteps.len() >= all {
                name
            } else {
                format!("{name} at h = {}", timesteps.join(", "))
            }
        })
        .collect();
    if hidden > 0 {
        texts.push(format!("{hidden} more"));
    }
    listed(&texts)
}

/// Whether outcomes differ in their timestep, so that a table has to say it.
pub fn several_timesteps(report: &Report) -> bool {
    let mut timesteps = report.outcomes().iter().map(|o| o.timestep);
    let first = timesteps.next();
    timesteps.any(|h| Some(h) != first)
}

/// The engines that deviations are stated against, rapier's own first, at most two.
pub fn references(report: &Report) -> Vec<&str> {
    let mut found: Vec<&str> = Vec::new();
    let named = ["rapier", "rapier-forces"];
    let keys = || report.outcomes().iter().flat_map(|o| o.deviation_m.keys());
    for name in named.into_iter().chain(keys().map(String::as_str)) {
        if keys().any(|key| key == name) && !found.contains(&name) {
            found.push(name);
        }
    }
    found.truncate(2);
    found
}
