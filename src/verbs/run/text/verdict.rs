//! The verdict of `run` and `compare`: how each engine behaved.

use super::{identity, subjects};
use crate::measure::{Behaviour, Check, CheckStatus, Energy};
use crate::report::verdict::{Clause, is_twin};
use crate::report::words;
use crate::solvers::Status;
use crate::verbs::Report;
use crate::verbs::run::Outcome;

/// The number of engines named in one group before "and n more".
const MAX_NAMED: usize = 4;

/// The clauses in order: the comparison, the scene's own integrator, the engines that diverged, grew or dissipated,
/// and the proof that the harness is unbiased.
pub fn clauses(report: &Report) -> Vec<Clause> {
    let whole = [identity::verdict(report), own(report)];
    let mut clauses: Vec<Clause> = whole.into_iter().flatten().map(|text| vec![text]).collect();
    clauses.extend(groups(report));
    clauses.extend(twin_proof(&report.header.checks));
    clauses
}

/// The clause on the scene's own integrator; None at several timesteps, where the groups name it.
fn own(report: &Report) -> Option<String> {
    let header = &report.header;
    let mut own = report
        .outcomes()
        .iter()
        .filter(|o| header.is_own(&o.engine));
    let (first, None) = (own.next()?, own.next()) else {
        return None;
    };
    if first.status != Status::Completed {
        return None;
    }
    let energy = first.energy.as_ref()?;
    let behaviour = energy.behaviour()?;
    let does = match (behaviour, energy.relative_error_max) {
        (Behaviour::Growing | Behaviour::Dissipating | Behaviour::Drifting, Some(error))
            if energy.limited_j.is_some() =>
        {
            limited(energy, behaviour, error, header.scene.energy_scale_j)
        }
        (Behaviour::Steady | Behaviour::Bounded, Some(error)) => {
            format!("is off by at most {}", words::share(error))
        }
        (Behaviour::Unsteady, Some(error)) => {
            format!("is off by up to {}", words::share(error))
        }
        (Behaviour::FewSamples, Some(error)) => format!(
            "takes too few steps to show a trend, and is off by at most {}",
            words::share(error)
        ),
        (Behaviour::Drifting, Some(error)) => format!("drifts by {}", words::share(error)),
        (Behaviour::Dissipating, Some(error)) => format!("dissipates {}", words::share(error)),
        (Behaviour::Growing, Some(error)) if energy.lost() => {
            format!("has a balance that grows by {}", words::share(error))
        }
        (Behaviour::Growing, Some(error)) => format!("gains {}", words::share(error)),
        (Behaviour::FewSamples, None) => "takes too few steps to show a trend of energy".to_owned(),
        // The scene has no S.
        (_, None) => format!("has a {} energy", behaviour.word()),
    };
    let distance = first.position_error_m.as_ref();
    let distance = distance.map(|e| words::truth_error(e.max, &header.truth));
    let distance = match distance.as_deref() {
        None => String::new(),
        Some("floor") => format!(", on the truth{}", until(report)),
        Some(error) => format!(", {error} m from the truth{}", until(report)),
    };
    let name = words::one_line(&first.engine);
    Some(format!("{name} {does}{distance}"))
}

/// ` up to 0.06 s` where the truth ends before the scene; else empty.
fn until(report: &Report) -> String {
    let header = &report.header;
    let ends = |horizon: &f64| *horizon < header.scene.duration * (1.0 - ROUNDING);
    let horizon = header.truth.horizon_s.filter(ends);
    horizon.map_or(String::new(), |horizon| {
        format!(" up to {} s", words::short(horizon))
    })
}

/// Steps may end this much before the duration, relative.
const ROUNDING: f64 = 1e-9;

/// What the balance with a strain limit does: not what the energy does, which the limit changes in every step.
fn limited(energy: &Energy, behaviour: Behaviour, error: f64, scale: Option<f64>) -> String {
    let does = match behaviour {
        Behaviour::Growing => "grows",
        Behaviour::Dissipating => "falls",
        _ => "drifts",
    };
    let joules = scale.map(|scale| error * scale);
    let change = energy.final_j.zip(energy.initial_j);
    let change = change.map(|(end, start)| (end - start).abs());
    match joules.zip(change) {
        Some((joules, change)) if change < KEPT * joules => format!(
            "ends with the energy that it began with, though its balance with the strain limit {does} by {} J",
            words::short(joules)
        ),
        _ => format!(
            "has a balance with the strain limit that {does} by {}",
            words::share(error)
        ),
    }
}

/// A change of the energy below this part of the balance's error is none to speak of.
const KEPT: f64 = 0.01;

fn groups(report: &Report) -> Vec<Clause> {
    let ended = |s: Status| move |o: &Outcome| o.status == s;
    let does = |these: &'static [Behaviour]| {
        move |o: &Outcome| {
            let behaviour = o.energy.as_ref().and_then(Energy::behaviour);
            o.status == Status::Completed && behaviour.is_some_and(|b| these.contains(&b))
        }
    };
    [
        group(report, "diverged", ended(Status::Diverged)),
        group(report, "failed", ended(Status::Failed)),
        group(report, "growing", does(&[Behaviour::Growing])),
        group(report, "unsteady", does(&[Behaviour::Unsteady])),
        group(report, "dissipating", does(&[Behaviour::Dissipating])),
        group(report, "drifting", does(&[Behaviour::Drifting])),
        group(report, "unsupported", ended(Status::Unsupported)),
        bounded(report, does(&[Behaviour::Steady, Behaviour::Bounded])),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// The clause of a group, in its forms from long to short: up to four names, two names, a count, nothing.
fn group(report: &Report, label: &str, belongs: impl Fn(&Outcome) -> bool) -> Option<Clause> {
    let chosen = remaining(report, belongs);
    let named = |names| format!("{label}: {}", subjects(report, &chosen, names));
    let counted = format!("{} {label}", chosen.len());
    (!chosen.is_empty()).then(|| vec![named(MAX_NAMED), named(2), counted, String::new()])
}

/// The bounded runs, which are counted and not named.
fn bounded(report: &Report, belongs: impl Fn(&Outcome) -> bool) -> Option<Clause> {
    let noun = match own(report) {
        Some(_) => "other",
        None => "run",
    };
    let bounded = remaining(report, belongs).len() as u64;
    let text = format!("{} bounded", words::plural(bounded, noun));
    (bounded > 0).then(|| vec![text, String::new()])
}

/// The outcomes of a group, without the scene's own integrator where that has a clause.
fn remaining(report: &Report, belongs: impl Fn(&Outcome) -> bool) -> Vec<&Outcome> {
    let own_has_clause = own(report).is_some();
    let has_clause = |o: &Outcome| own_has_clause && report.header.is_own(&o.engine);
    let outcomes = report.outcomes().iter();
    outcomes.filter(|o| belongs(o) && !has_clause(o)).collect()
}

/// `twin proof holds (2 of 2)`; None where it failed, since the verdict begins with that.
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
            let mut forms = vec![format!("{holds} ({passed} of {})", passed + open)];
            forms.extend((open == 0).then(|| holds.into()));
            Some(forms)
        }
    }
}
