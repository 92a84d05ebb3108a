//! The verdict of `run` and `compare`: who does what.

use super::{identity, subjects};
use crate::measure::{Check, CheckStatus, EnergyClass};
use crate::report::verdict::{Clause, is_twin};
use crate::report::words;
use crate::solvers::Status;
use crate::verbs::Report;
use crate::verbs::run::Outcome;

/// Engines named in one group before "and n more".
const NAMED: usize = 4;

/// The comparison, then the scene's own integrator, then who diverged, grew, dissipated, then the proof
/// that the harness is unbiased.
pub fn clauses(report: &Report) -> Vec<Clause> {
    let mut clauses = Vec::new();
    clauses.extend(identity::verdict(report).map(|text| vec![text]));
    clauses.extend(own(report).map(|text| vec![text]));
    clauses.extend(groups(report));
    clauses.extend(twin_proof(&report.header.checks));
    clauses
}

/// What the scene's own integrator does; at several timesteps the groups say it.
fn own(report: &Report) -> Option<String> {
    let mut own = report
        .outcomes()
        .iter()
        .filter(|o| o.engine == report.header.scene.own_integrator);
    let (first, None) = (own.next()?, own.next()) else {
        return None;
    };
    let name = words::one_line(&first.engine);
    if first.status != Status::Completed {
        return None;
    }
    let energy = first.energy.as_ref()?;
    let error = energy
        .relative_error_max
        .map(|e| format!(" ({})", words::sci(e)))
        .unwrap_or_default();
    let does = match energy.class? {
        EnergyClass::Bounded => format!("stays bounded{error}"),
        EnergyClass::Drifting => format!("drifts in energy{error}"),
        EnergyClass::Dissipating => format!("dissipates energy{error}"),
        EnergyClass::Growing if energy.lost() => format!("has a growing energy balance{error}"),
        EnergyClass::Growing => format!("gains energy{error}"),
    };
    let error = first.position_error_m.as_ref();
    let error = error.map(
        |e| match words::truth_error(e.max, &report.header.truth).as_str() {
            "floor" => ", on the truth".to_owned(),
            error => format!(", {error} m from the truth"),
        },
    );
    Some(format!("{name} {does}{}", error.unwrap_or_default()))
}

fn groups(report: &Report) -> Vec<Clause> {
    let ended = |s: Status| move |o: &Outcome| o.status == s;
    let classed = |c: EnergyClass| {
        move |o: &Outcome| {
            o.status == Status::Completed && o.energy.as_ref().and_then(|e| e.class) == Some(c)
        }
    };
    [
        group(report, "diverged", ended(Status::Diverged)),
        group(report, "failed", ended(Status::Failed)),
        group(report, "growing", classed(EnergyClass::Growing)),
        group(report, "dissipating", classed(EnergyClass::Dissipating)),
        group(report, "drifting", classed(EnergyClass::Drifting)),
        group(report, "unsupported", ended(Status::Unsupported)),
        bounded(report, classed(EnergyClass::Bounded)),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// The group by up to four names, by two, by number, not at all.
fn group(report: &Report, label: &str, belongs: impl Fn(&Outcome) -> bool) -> Option<Clause> {
    let chosen = unsaid(report, belongs);
    let named = |names| format!("{label}: {}", subjects(report, &chosen, names));
    let counted = format!("{} {label}", chosen.len());
    (!chosen.is_empty()).then(|| vec![named(NAMED), named(2), counted, String::new()])
}

/// The quiet ones are counted, not named.
fn bounded(report: &Report, belongs: impl Fn(&Outcome) -> bool) -> Option<Clause> {
    let noun = if own(report).is_some() {
        "other"
    } else {
        "run"
    };
    let text = match unsaid(report, belongs).len() {
        0 => return None,
        1 => format!("1 {noun} bounded"),
        n => format!("{n} {noun}s bounded"),
    };
    Some(vec![text, String::new()])
}

/// The outcomes that belong, but for the scene's own integrator where it has its clause.
fn unsaid(report: &Report, belongs: impl Fn(&Outcome) -> bool) -> Vec<&Outcome> {
    let own_said = own(report).is_some();
    let is_said = |o: &Outcome| own_said && o.engine == report.header.scene.own_integrator;
    report
        .outcomes()
        .iter()
        .filter(|o| belongs(o) && !is_said(o))
        .collect()
}

/// `twin proof holds (2 of 2)`; silent where it failed, for that is said first.
fn twin_proof(checks: &[Check]) -> Option<Clause> {
    let count = |status| {
        let twins = checks.iter().filter(|c| is_twin(c));
        twins.filter(|c| c.status == status).count()
    };
    let (passed, failed) = (count(CheckStatus::Pass), count(CheckStatus::Fail));
    let open = count(CheckStatus::Inconclusive) + count(CheckStatus::Skip);
    let holds = "twin proof holds";
    match (passed, failed, open) {
        (_, 1.., _) | (0, 0, 0) => None,
        (0, 0, _) => Some(vec!["twin proof not made".into()]),
        _ => {
            let counted = format!("{holds} ({passed} of {})", passed + open);
            let short = if open == 0 {
                holds.into()
            } else {
                counted.clone()
            };
            Some(vec![counted, short])
        }
    }
}
