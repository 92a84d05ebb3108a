//! The one sentence that says the most important thing.

use super::notes::{listed, subjects};
use super::{cost, identity, stability, words};
use crate::outcome::{Check, CheckStatus, EnergyClass, Outcome, Report, Status};

/// Engines named in one group before "and n more".
const NAMED: usize = 4;

/// A part of the sentence: the same said at length, shorter, and so on. The last may be empty.
pub(super) type Clause = Vec<String>;

/// Failed checks first, then the scene's own integrator, then who diverged, grew, dissipated,
/// then the proof that the harness is unbiased. One sentence, one line.
pub fn verdict(report: &Report) -> String {
    sentence(&clauses(report), &[])
}

/// The same in at most `columns` characters where that can be done: the least important groups are
/// counted instead of named, then left out.
pub fn within(report: &Report, columns: usize) -> String {
    let clauses = clauses(report);
    let mut forms = vec![0; clauses.len()];
    loop {
        let text = sentence(&clauses, &forms);
        let shorter = |i: &usize| forms[*i] + 1 < clauses[*i].len();
        match (0..clauses.len()).rev().find(shorter) {
            Some(i) if text.chars().count() > columns => forms[i] += 1,
            _ => return text,
        }
    }
}

/// In the order they are said, which is that of their importance but for the twin proof.
fn clauses(report: &Report) -> Vec<Clause> {
    if let Some(stability) = report
        .stability
        .as_ref()
        .filter(|_| stability::is_alone(report))
    {
        return stability::verdict::clauses(report, stability);
    }
    let mut clauses = Vec::new();
    clauses.extend(failed_checks(&report.checks).map(|text| vec![text]));
    if let Some(cost) = report.cost.as_ref().filter(|_| cost::is_alone(report)) {
        clauses.extend(cost::verdict::clauses(report, cost));
        return clauses;
    }
    clauses.extend(identity::verdict(report).map(|text| vec![text]));
    clauses.extend(own(report).map(|text| vec![text]));
    clauses.extend(groups(report));
    clauses.extend(twin_proof(&report.checks));
    clauses
}

/// The clauses, each in the form asked for (the longest if none is), and a full stop.
fn sentence(clauses: &[Clause], forms: &[usize]) -> String {
    let form = |i: usize| forms.get(i).copied().unwrap_or(0);
    let texts = clauses
        .iter()
        .enumerate()
        .filter_map(|(i, c)| c.get(form(i)));
    let texts: Vec<&str> = texts
        .map(String::as_str)
        .filter(|text| !text.is_empty())
        .collect();
    match texts.as_slice() {
        [] => "nothing ran.".into(),
        texts => texts.join("; ") + ".",
    }
}

/// The checks that prove rapier's world and the hand-written system are the same scene.
fn is_twin(check: &Check) -> bool {
    check.id.starts_with("twin")
}

fn failed_checks(checks: &[Check]) -> Option<String> {
    let failed = |twin: bool| -> Vec<String> {
        checks
            .iter()
            .filter(|c| c.status == CheckStatus::Fail && is_twin(c) == twin)
            .map(|c| {
                format!(
                    "{} ({})",
                    words::one_line(&c.id),
                    words::one_line(&c.subject)
                )
            })
            .collect()
    };
    let (twins, others) = (failed(true), failed(false));
    let mut clauses = Vec::new();
    if !twins.is_empty() {
        clauses.push(format!(
            "THE TWIN PROOF FAILS, so trust no comparison: {}",
            listed(&twins)
        ));
    }
    if !others.is_empty() {
        clauses.push(format!("failed: {}", listed(&others)));
    }
    (!clauses.is_empty()).then(|| clauses.join("; "))
}

/// What the scene's own integrator does; at several timesteps the groups say it.
fn own(report: &Report) -> Option<String> {
    let mut own = report
        .outcomes
        .iter()
        .filter(|o| o.engine == report.scene.own_method);
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
        |e| match words::truth_error(e.max, &report.truth).as_str() {
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
    let is_said = |o: &Outcome| own_said && o.engine == report.scene.own_method;
    report
        .outcomes
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
