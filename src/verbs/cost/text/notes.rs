//! The notes on single engines: why a reference engine's curve lies where it does, and which settings
//! have no error.

use crate::report::Note;
use crate::report::words::{self, listed};
use crate::solvers::Status;
use crate::verbs::cost::{Cost, CostCurve, CostPoint};

/// The most settings that are listed one by one; more are given by their first and last.
const NAMED: usize = 4;

/// The notes on each engine, in the order of the curves.
pub fn notes(cost: &Cost) -> Vec<Note> {
    let said = cost.curves.iter().flat_map(|curve| {
        let name = words::one_line(&curve.engine);
        let sentences = sentences(curve).into_iter();
        sentences.map(move |sentence| (name.clone(), sentence))
    });
    Note::of(said, listed)
}

fn sentences(curve: &CostCurve) -> Vec<String> {
    // An engine that takes the scene at no setting has no curve to explain.
    let mut points = curve.points.iter();
    let runs = points.any(|point| point.status != Status::Unsupported);
    let explanation = curve.explanation.as_deref().filter(|_| runs);
    let explanation = explanation.map(words::one_line);
    let endings = [Status::Diverged, Status::Failed, Status::Unsupported];
    let endings = endings.into_iter().filter_map(|s| ending(curve, s));
    explanation.into_iter().chain(endings).collect()
}

/// `diverged at h = 0.2 and 0.1 s`, with the reason. A divergence goes without one: it says the same of each
/// step in other numbers.
fn ending(curve: &CostCurve, status: Status) -> Option<String> {
    let ended = curve.points.iter().filter(|point| point.status == status);
    let ended: Vec<&CostPoint> = ended.collect();
    let first = ended.first()?;
    let mut text = words::id(status);
    if ended.len() < curve.points.len() {
        text += &format!(" at {}", settings(&ended));
    } else if ended.len() > 1 {
        text += " at every setting";
    }
    if let (true, Some(reason)) = (status != Status::Diverged, &first.reason) {
        text += &format!(": {}", words::one_line(reason));
        if ended.iter().any(|point| point.reason != first.reason) {
            text += " (the first; others differ)";
        }
    }
    Some(text)
}

/// `h = 0.2 and 0.1 s`, `h = 0.2 to 0.01 s (7 settings)`, or tolerances.
fn settings(points: &[&CostPoint]) -> String {
    let adaptive = points.iter().all(|point| point.tolerance.is_some());
    let value = |point: &&CostPoint| match point.tolerance {
        Some(tolerance) if adaptive => super::metres(tolerance),
        _ => words::short(point.timestep),
    };
    let values: Vec<String> = points.iter().map(value).collect();
    let (name, unit) = if adaptive {
        ("tolerance ", "")
    } else {
        ("h = ", " s")
    };
    match values.as_slice() {
        [first, .., last] if values.len() > NAMED => {
            format!("{name}{first} to {last}{unit} ({} settings)", values.len())
        }
        values => format!("{name}{}{unit}", listed(values)),
    }
}
