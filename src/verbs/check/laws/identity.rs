//! Runs that step as their method says, and come out the same twice.

use super::{Ran, Row, Subject};
use crate::measure::identify::{Explained, Undecided};
use crate::measure::{Check, CheckStatus};
use crate::solvers::SolverKind;
use crate::trajectory::{Recorder, Trajectory};
use rayon::prelude::*;

pub(in crate::verbs::check) const SCHEME: Row = Row {
    id: "scheme",
    requires: "every recorded step is one that the method makes from the row before it",
    derivation: "one-step replay: what rounding of the data, the forces and the step explains, ten times at most",
    remedy: "where the message names another scheme, that is what the program does; `compare` finds the first step that \
             leaves the method, where there is one",
    judge: Some(|ran| {
        let judged = |subject: &Subject| subject.record.trajectory.is_some();
        let subjects = ran.subjects().filter(judged);
        subjects
            .filter_map(|subject| scheme(ran, &subject))
            .collect()
    }),
};

fn scheme(ran: &Ran, subject: &Subject) -> Option<Check> {
    let outcome = subject.outcome;
    let engine = &outcome.engine;
    let check = |status, message: String| SCHEME.with(engine, status, message);
    let found = outcome.identified.as_ref();
    let Some(stated) = ran.gate.scheme(subject.case).map(|scheme| scheme.label) else {
        let steps = found.map_or_else(String::new, |found| {
            format!(", and steps as {}", found.label())
        });
        let message =
            format!("claims no scheme{steps}: `--claims {engine}=SCHEME` holds it to one");
        return subject
            .is_other()
            .then(|| check(CheckStatus::Skip, message));
    };
    let Some(found) = found else {
        let Some(explained) = &outcome.explained else {
            let message = "too few rows to replay, or too many steps to afford it".to_owned();
            return Some(check(CheckStatus::Skip, message));
        };
        return Some(Check {
            cause: cause(explained),
            ..check(CheckStatus::Fail, format!("does not step as {stated}"))
        });
    };
    let near = found.undecided == Some(Undecided::Near);
    let holds = found.is(&stated);
    let steps = found.label();
    let message = match (holds, near) {
        (true, _) if steps == stated => format!("steps as {stated}"),
        (true, _) => format!("steps as {steps}, which cannot be told from {stated} here"),
        (_, true) => format!(
            "is only near {steps}: off by {:.3e} of rounding",
            found.defect
        ),
        _ => format!("steps as {steps}, not as {stated}"),
    };
    let status = if holds {
        CheckStatus::Pass
    } else {
        CheckStatus::Fail
    };
    let said = || found.says.as_ref().map(ToString::to_string);
    let cause = outcome.explained.as_ref().and_then(cause).or_else(said);
    Some(Check {
        measured: Some(found.defect),
        bound: Some(crate::measure::identify::FIT),
        cause: cause.filter(|_| !holds),
        ..check(status, message)
    })
}

/// What it deviates in, in words.
fn cause(explained: &Explained) -> Option<String> {
    let scheme = explained.scheme.as_ref()?;
    // A mistake that changes several numbers says the same of each.
    let mut sentences: Vec<&str> = Vec::new();
    for deviation in &explained.deviations {
        if !sentences.contains(&deviation.sentence.as_str()) {
            sentences.push(&deviation.sentence);
        }
    }
    (!sentences.is_empty()).then(|| format!("it is {scheme}, but {}", sentences.join(" and ")))
}

pub(super) const SAME_BITS: Row = Row {
    id: "same-bits",
    requires: "a second run, on one thread, gives the same bits",
    derivation: "no result depends on the clock, on memory or on the number of threads: equal means equal",
    remedy: "look for sums whose order changes from run to run, state that outlives a run, and the clock",
    judge: Some(|ran| {
        let Ok(one) = rayon::ThreadPoolBuilder::new().num_threads(1).build() else {
            return Vec::new();
        };
        let subjects: Vec<Subject> = ran.subjects().collect();
        let judge = |subject: &Subject| {
            let first = subject.record.trajectory.as_ref()?;
            let ours = subject.case.solver.kind != SolverKind::External;
            let again = ours.then(|| one.install(|| again(ran, subject)))??;
            let engine = &subject.outcome.engine;
            let parts = differs(first, &again);
            let message = match parts {
                None => "the same bits twice".to_owned(),
                Some(t) => format!("a second run on one thread differs from t = {t:.6} s on"),
            };
            Some(Check {
                first_s: parts,
                ..SAME_BITS.of(engine, parts.is_none(), message)
            })
        };
        subjects.par_iter().filter_map(judge).collect()
    }),
};

/// The same run once more, as far as the first one got.
fn again(ran: &Ran, subject: &Subject) -> Option<Trajectory> {
    let plan = ran.plan();
    let limits = crate::verbs::facts::limits(plan.scene, &plan.system);
    let label = &subject.case.label;
    let mut run = subject.case.start(plan).ok()?;
    let dim = 3 * plan.scene.particles.len();
    let mut recorder = Recorder::new(label.steps, dim, label.timestep);
    run.finish(&limits, &mut recorder, &|_| {});
    Some(recorder.finish())
}

/// The first time at which two runs differ in a bit, s.
fn differs(a: &Trajectory, b: &Trajectory) -> Option<f64> {
    if a.len() != b.len() {
        return Some(a.time(a.len().min(b.len()).saturating_sub(1)));
    }
    let same = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits());
    let at = (0..a.len()).find(|&k| !same(a.x(k), b.x(k)) || !same(a.v(k), b.v(k)));
    at.map(|k| a.time(k))
}
