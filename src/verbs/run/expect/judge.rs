//! One expectation held against one outcome.

use super::{Found, ID};
use crate::measure::{Check, CheckStatus};
use crate::scene::{Expectation, Wanted};
use crate::solvers::Status;
use crate::truth::TruthKind;
use crate::verbs::run::Outcome;
use serde_json::Value;

/// `value` is the outcome as JSON.
pub fn judge(expectation: &Expectation, outcome: &Outcome, value: &Value, runs: &Found) -> Check {
    let Expectation { scope, key, wanted } = expectation;
    let engine = &outcome.engine;
    let check = |status, measured, bound, message| Check {
        id: ID.to_owned(),
        subject: format!("{engine} {key}"),
        status,
        measured,
        bound,
        derivation: format!("the scene's `expect`, under `{scope}`"),
        message,
    };
    if let Some(reference) = absent_reference(key, outcome, runs.outcomes) {
        let message = format!("{engine}: {key} has no value, since {reference} did not run");
        return check(CheckStatus::Skip, None, None, message);
    }
    let found = key.split('.').try_fold(value, |value, key| value.get(key));
    let found = found.filter(|found| !found.is_null());
    let measured = found.and_then(Value::as_f64);
    let (met, bound) = match (wanted, found) {
        (_, None) => (false, None),
        (Wanted::Words(words), Some(found)) => (words.contains(&word(found)), None),
        (Wanted::Contains(text), Some(found)) => (word(found).contains(text), None),
        (Wanted::Bounds { above, below }, Some(_)) => within(measured, *above, *below),
    };
    let status = if met {
        CheckStatus::Pass
    } else {
        CheckStatus::Fail
    };
    let said = match found {
        Some(found) => said(key, found, outcome),
        None => format!("no value ({})", missing(key, outcome, runs)),
    };
    let verb = if met { "is to be" } else { "should be" };
    let at = outcome.timestep;
    let message = format!("{engine}: {key} {verb} {wanted}, found {said}, at h = {at:?} s");
    check(status, measured, bound, message)
}

/// The engine a deviation is from, if it did not run: nobody's fault.
fn absent_reference<'a>(key: &'a str, outcome: &Outcome, outcomes: &[Outcome]) -> Option<&'a str> {
    let reference = key.strip_prefix("deviation_m.")?.split('.').next()?;
    let ran = |o: &Outcome| o.engine == reference && o.timestep == outcome.timestep;
    (!outcomes.iter().any(ran)).then_some(reference)
}

/// A word or a truth value as the file writes it.
fn word(value: &Value) -> String {
    match value {
        Value::String(word) => word.clone(),
        other => other.to_string(),
    }
}

/// Whether the number lies strictly within its bounds, and the bound that decides: the one it
/// breaks, else the upper one.
fn within(measured: Option<f64>, above: Option<f64>, below: Option<f64>) -> (bool, Option<f64>) {
    let Some(x) = measured else {
        return (false, below.or(above));
    };
    let low = above.is_none_or(|above| x > above);
    let high = below.is_none_or(|below| x < below);
    let bound = if low { below.or(above) } else { above };
    (low && high, bound)
}

/// What was found; a status with what led to it.
fn said(key: &str, found: &Value, outcome: &Outcome) -> String {
    let text = match found.as_f64() {
        // Counts as they are, anything else to four digits.
        Some(_) if found.is_u64() => found.to_string(),
        Some(x) => format!("{x:.3e}"),
        None => word(found),
    };
    match &outcome.reason {
        Some(reason) if key == "status" => format!("{text} ({reason})"),
        _ => text,
    }
}

/// Why a key has no value.
fn missing(key: &str, outcome: &Outcome, runs: &Found) -> String {
    let error = key.starts_with("position_error_m") || key.starts_with("velocity_error_m_s");
    match (&outcome.reason, &runs.truth.reason) {
        (Some(reason), _) => reason.clone(),
        (None, Some(reason)) if error && runs.truth.kind == TruthKind::None => {
            format!("there is no truth: {reason}")
        }
        _ if error => "the truth ends before its second instant".to_owned(),
        _ if key.starts_with("energy.") && runs.scene.energy_scale_j.is_none() => {
            "the scene has no energy scale".to_owned()
        }
        _ if key.starts_with("momentum.") => "the scene does not conserve it".to_owned(),
        _ if outcome.status == Status::Completed && (key == "reason" || key == "stopped_at_s") => {
            "the run completed".to_owned()
        }
        _ if key == "identified.undecided" => "it is decided".to_owned(),
        _ => "it is null here".to_owned(),
    }
}
