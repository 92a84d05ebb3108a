//! Runs that step as their method says, and come out the same twice.

use super::{Ran, Row, Subject};
use crate::measure::identify::{Explained, Identity, Undecided};
use crate::measure::{Check, CheckStatus};
use crate::solvers::SolverKind;
use crate::trajectory::{Recorder, Trajectory};
use rayon::prelude::*;

pub(super) const SCHEME: Row = Row {
    id: "scheme",
    requires: "every recorded step is one that the method makes from the row before it",
    derivation: "one-step replay: what rounding of the data, the forces and the step explains, ten times at most",
    remedy: "the message names what it steps like instead; `compare` finds the first step that leaves the method",
    judge: Some(|ran| {
        let judged = |subject: &Subject| subject.record.trajectory.is_some();
        let subjects = ran.subjects().filter(judged);
        subjects.filter_map(|subject| scheme(&subject)).collect()
    }),
};

fn scheme(subject: &Subject) -> Option<Check> {
    let (method, outcome) = (subject.method?, subject.outcome);
    let engine = &outcome.engine;
    let check = |status, message: String| SCHEME.with(engine, status, message);
    let Some(found) = &outcome.identified else {
        let Some(explained) = &outcome.explained else {
            let message = "too few rows to replay, or too many steps to afford it".to_owned();
            return Some(check(CheckStatus::Skip, message));
        };
        let message = format!("does not step as {}", method.id);
        return Some(Check {
            cause: cause(explained),
            ..check(CheckStatus::Fail, message)
        });
    };
    let near = found.undecided == Some(Undecided::Near);
    let named = found.method == method.id && found.substeps == 1;
    let holds = found.is(method.id);
    let steps = scheme_label(found);
    let message = match (holds, near) {
        (true, _) if named => format!("steps as {}", method.id),
        (true, _) => format!(
            "steps as {steps}, which cannot be told from {} here",
            method.id
        ),
        (_, true) => format!(
            "is only near {steps}: off by {:.3e} of rounding",
            found.defect
        ),
        _ => format!("steps as {steps}, not as {}", method.id),
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

fn scheme_label(found: &Identity) -> String {
    match found.substeps {
        1 => found.method.clone(),
        n => format!("{} in {n} substeps", found.method),
    }
}

/// What it deviates in, in words.
fn cause(explained: &Explained) -> Option<String> {
    let scheme = explained.scheme.as_ref()?;
    let sentences: Vec<&str> = explained
        .deviations
        .iter()
        .map(|d| d.sentence.as_str())
        .collect();
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
