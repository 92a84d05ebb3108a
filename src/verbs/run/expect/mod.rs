//! Whether a scene's engines did what its `expect` says.

mod keys;

pub use keys::names;

use super::plan::{Choice, Expectations, Orders};
use crate::measure::{Check, CheckStatus};
use crate::scene::{Expectation, Scene, Wanted};
use crate::solvers::{Kind, Solver, Status, catalogue};
use crate::truth::{Demand, TruthKind};
use crate::verbs::Report;
use crate::verbs::run::Outcome;
use serde_json::Value;

/// The id of these checks.
pub const ID: &str = "expect";

/// What the truth moves: errors, and what is in units of the energy scale, which takes its peak in.
const OF_THE_TRUTH: &[&str] = &[
    "position_error_m.",
    "velocity_error_m_s.",
    "energy.relative_error_max",
    "energy.drift_per_s",
    "energy.fluctuation",
];

/// One check for each key expected of an engine, on its outcome at the scene's own timestep; one
/// that is skipped for each engine that did not run there, or one in all where none did.
///
/// `scene` is the scene as its file states it: runs of another duration are not judged. Where a key has
/// no value, the expectation fails.
pub fn check(scene: &Scene, report: &Report) -> Vec<Check> {
    if scene.expect.is_empty() {
        return Vec::new();
    }
    let ran = report.header.scene.duration;
    if ran != scene.duration {
        return vec![not_judged(&format!(
            "they are about {:?} s, and {ran:?} s ran",
            scene.duration
        ))];
    }
    let timestep = scene.solver.timestep;
    let outcome = |id: &str| -> Option<&Outcome> {
        let of = |o: &&Outcome| o.engine == id && o.timestep == timestep;
        report.outcomes().iter().find(of)
    };
    let expected = |solver: &Solver| !expected_of(scene, solver).is_empty();
    let subjects: Vec<Solver> = fixed().filter(expected).collect();
    if !subjects
        .iter()
        .any(|subject| outcome(&subject.id).is_some())
    {
        return vec![not_judged(&format!(
            "none of the engines they are about ran at the scene's own timestep, {timestep:?} s; \
             --integrators all runs every integrator"
        ))];
    }
    let mut checks = Vec::new();
    for subject in subjects {
        let Some(outcome) = outcome(&subject.id) else {
            let why = "did not run at the scene's own timestep";
            checks.push(skipped(&subject.id, why.to_owned()));
            continue;
        };
        // Whatever an outcome holds has a JSON form.
        let value = serde_json::to_value(outcome).unwrap_or_default();
        let expected = expected_of(scene, &subject).into_iter();
        checks.extend(expected.map(|e| judge(e, outcome, &value, report)));
    }
    checks
}

impl Expectations {
    /// The checks that say what came of them.
    pub fn checks(&self, scene: &Scene, report: &Report) -> Vec<Check> {
        match self {
            Self::Judged => check(scene, report),
            Self::Skipped(why) if !scene.expect.is_empty() => vec![not_judged(why)],
            Self::Ignored | Self::Skipped(_) => Vec::new(),
        }
    }
}

/// The one check that says why nothing was judged.
fn not_judged(why: &str) -> Check {
    skipped("scene", format!("expectations are not judged: {why}"))
}

fn skipped(subject: &str, message: String) -> Check {
    Check {
        id: ID.to_owned(),
        subject: subject.to_owned(),
        status: CheckStatus::Skip,
        measured: None,
        bound: None,
        derivation: "the scene's `expect`".to_owned(),
        message,
    }
}

/// The solvers of fixed steps, in the catalogue's order.
fn fixed() -> impl Iterator<Item = Solver> {
    catalogue().filter(|solver| solver.as_pair().is_none())
}

/// What is expected of a solver.
fn expected_of<'a>(scene: &'a Scene, solver: &Solver) -> Vec<&'a Expectation> {
    scene.expected_of(&solver.id, solver.kind == Kind::Integrator)
}

impl Choice {
    /// Exactly what the scene expects something of, at its own timestep, and the engines those
    /// expectations name as references. What no expectation can depend on is not computed: orders, the
    /// twin proof, and, unless a key needs them, the truth and the identities.
    pub fn expected(scene: &Scene) -> Self {
        let mentions = |prefixes: &[&str]| {
            let about = |key: &str| prefixes.iter().any(|prefix| key.starts_with(prefix));
            scene.expect.iter().any(|e| about(&e.key))
        };
        let referred = |solver: &Solver| {
            let prefix = format!("deviation_m.{}.", solver.id);
            solver.kind == Kind::Rapier && mentions(&[&prefix])
        };
        Self {
            solvers: fixed()
                .filter(|solver| !expected_of(scene, solver).is_empty() || referred(solver))
                .collect(),
            timesteps: vec![scene.solver.timestep],
            truth: if mentions(OF_THE_TRUTH) {
                Demand::Auto
            } else {
                Demand::None
            },
            order: Orders::Never,
            identify: mentions(&["identified."]),
            prove: false,
            expectations: Expectations::Judged,
        }
    }
}

/// One expectation held against one outcome; `value` is the outcome as JSON.
fn judge(expectation: &Expectation, outcome: &Outcome, value: &Value, report: &Report) -> Check {
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
    if let Some(reference) = absent_reference(key, outcome, report.outcomes()) {
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
        None => format!("no value ({})", missing(key, outcome, report)),
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
fn missing(key: &str, outcome: &Outcome, report: &Report) -> String {
    let error = key.starts_with("position_error_m") || key.starts_with("velocity_error_m_s");
    match (&outcome.reason, &report.header.truth.reason) {
        (Some(reason), _) => reason.clone(),
        (None, Some(reason)) if error && report.header.truth.kind == TruthKind::None => {
            format!("there is no truth: {reason}")
        }
        _ if error => "the truth ends before its second instant".to_owned(),
        _ if key.starts_with("energy.") && report.header.scene.energy_scale_j.is_none() => {
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
