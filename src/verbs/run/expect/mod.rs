//! Checks whether a scene's engines did what its `expect` says.

mod keys;

pub use keys::names;

use super::plan::{Choice, Expectations, Orders};
use crate::measure::{Check, CheckStatus};
use crate::scene::{Expectation, Scene, Scope, Wanted};
use crate::solvers::{Solver, SolverKind, Status, catalogue};
use crate::truth::{Demand, TruthKind};
use crate::verbs::Report;
use crate::verbs::run::Outcome;
use serde_json::Value;

/// The id of the checks of expectations.
pub const ID: &str = "expect";

/// The keys that depend on the truth: errors, and values in units of the energy scale, which takes in the truth's peak
/// kinetic energy.
const TRUTH_KEYS: &[&str] = &[
    "position_error_m.",
    "velocity_error_m_s.",
    "energy.relative_error_max",
    "energy.drift_per_s",
    "energy.fluctuation",
];

/// One check for each expected key of an engine, on its outcome at the scene's own timestep. An engine that did not run
/// there gives one skipped check; where none ran, there is one skipped check in all.
///
/// `scene` is the scene as its file states it; runs of another duration are not judged. An expectation of a key
/// without a value fails.
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
    let ours = fixed().map(|solver| (solver.kind == SolverKind::Integrator, solver.id.to_string()));
    let ours: Vec<(bool, String)> = ours.collect();
    let mut subjects = ours.clone();
    for expectation in &scene.expect {
        // What is none of ours is another program.
        if let Scope::Engine(id) = &expectation.scope
            && !subjects.iter().any(|(_, known)| known == id)
        {
            subjects.push((false, id.clone()));
        }
    }
    subjects.retain(|(integrator, id)| !scene.expected_of(id, *integrator).is_empty());
    let ran = subjects.iter().any(|(_, id)| outcome(id).is_some());
    let programs = subjects.iter().any(|subject| !ours.contains(subject));
    if !ran && !programs {
        return vec![not_judged(&format!(
            "none of the engines they are about ran at the scene's own timestep, {timestep:?} s; \
             --integrators all runs every integrator"
        ))];
    }
    let mut checks = Vec::new();
    for (integrator, id) in subjects {
        let Some(outcome) = outcome(&id) else {
            let elsewhere = report.outcomes().iter().any(|o| o.engine == id);
            let why = match elsewhere {
                true => "did not run at the scene's own timestep",
                false => "did not run",
            };
            checks.push(skipped(&id, why.to_owned()));
            continue;
        };
        // Every outcome has a JSON form.
        let value = serde_json::to_value(outcome).unwrap_or_default();
        let expected = scene.expected_of(&id, integrator).into_iter();
        checks.extend(expected.map(|e| judge(e, outcome, &value, report)));
    }
    checks
}

impl Expectations {
    /// The checks for the report, or the one that says why none was judged.
    pub fn checks(&self, scene: &Scene, report: &Report) -> Vec<Check> {
        match self {
            Self::Judged => check(scene, report),
            Self::Skipped(why) if !scene.expect.is_empty() => vec![not_judged(why)],
            Self::Ignored | Self::Skipped(_) => Vec::new(),
        }
    }
}

/// The one check that says why no expectation was judged.
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
        ..Check::default()
    }
}

/// The solvers with fixed steps, in the catalogue's order.
fn fixed() -> impl Iterator<Item = Solver> {
    catalogue().filter(|solver| solver.as_pair().is_none())
}

/// The expectations of a solver.
fn expected_of<'a>(scene: &'a Scene, solver: &Solver) -> Vec<&'a Expectation> {
    scene.expected_of(&solver.id, solver.kind == SolverKind::Integrator)
}

impl Choice {
    /// The choice that judges a scene's expectations: exactly the solvers they are about, at the scene's timestep,
    /// and the engines they name as references. Nothing else is computed: no orders, no twin proof, and no truth or
    /// identities unless a key needs them.
    pub fn expected(scene: &Scene) -> Self {
        let mentions = |prefixes: &[&str]| {
            let about = |key: &str| prefixes.iter().any(|prefix| key.starts_with(prefix));
            scene.expect.iter().any(|e| about(&e.key))
        };
        let referred = |solver: &Solver| {
            let prefix = format!("deviation_m.{}.", solver.id);
            solver.kind == SolverKind::Rapier && mentions(&[&prefix])
        };
        Self {
            solvers: fixed()
                .filter(|solver| !expected_of(scene, solver).is_empty() || referred(solver))
                .collect(),
            timesteps: vec![scene.solver.timestep],
            truth: if mentions(TRUTH_KEYS) {
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

/// Judges one expectation on one outcome; `value` is the outcome as JSON.
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
        key: Some(format!("expect.{scope}.{key}")),
        message,
        ..Check::default()
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
    let value_text = match found {
        Some(found) => found_text(key, found, outcome),
        None => format!("no value ({})", missing(key, outcome, report)),
    };
    let verb = if met { "is to be" } else { "should be" };
    let at = outcome.timestep;
    let message = format!("{engine}: {key} {verb} {wanted}, found {value_text}, at h = {at:?} s");
    check(status, measured, bound, message)
}

/// The engine a deviation is measured from, if it did not run; the expectation is then skipped.
fn absent_reference<'a>(key: &'a str, outcome: &Outcome, outcomes: &[Outcome]) -> Option<&'a str> {
    let reference = key.strip_prefix("deviation_m.")?.split('.').next()?;
    let ran = |o: &Outcome| o.engine == reference && o.timestep == outcome.timestep;
    (!outcomes.iter().any(ran)).then_some(reference)
}

/// A word or a boolean as the file writes it.
fn word(value: &Value) -> String {
    match value {
        Value::String(word) => word.clone(),
        other => other.to_string(),
    }
}

/// Whether the number lies strictly within its bounds, and the bound that decides: the one it violates, else the
/// upper one.
fn within(measured: Option<f64>, above: Option<f64>, below: Option<f64>) -> (bool, Option<f64>) {
    let Some(x) = measured else {
        return (false, below.or(above));
    };
    let low = above.is_none_or(|above| x > above);
    let high = below.is_none_or(|below| x < below);
    let bound = if low { below.or(above) } else { above };
    (low && high, bound)
}

/// The value found, as text; a status has its reason.
fn found_text(key: &str, found: &Value, outcome: &Outcome) -> String {
    let text = match found.as_f64() {
        // Counts are exact; other numbers have four digits.
        Some(_) if found.is_u64() => found.to_string(),
        Some(x) => format!("{x:.3e}"),
        None => word(found),
    };
    match &outcome.reason {
        Some(reason) if key == "status" => format!("{text} ({reason})"),
        _ => text,
    }
}

/// The reason why a key has no value.
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
