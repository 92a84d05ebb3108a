//! What is near a scheme: off by little beside the scheme's own error in a step. What is only near the truth is
//! near no scheme.

use super::candidate::Candidate;
use super::race::{Race, defects_of_all, quantile};
use super::replay::{Defect, Replay};
use super::result::{Deviation, Explained, Undecided};
use super::transition::{Transition, spread};
use super::{Found, Identity, Question, median, median_relative};
use crate::integrators;
use rayon::prelude::*;

/// Transitions that it is measured on.
const MEASURED: usize = 8;
/// A trajectory is near a scheme whose steps it misses by this part of the scheme's own error.
const NEAR: f64 = 0.02;
/// Where the truth of a step is not known, it has to be this small a part of what the step moves.
const SMALL: f64 = 1e-3;

/// The scheme whose steps the trajectory nearly takes.
pub(super) fn nearest(
    question: &Question,
    race: &Race,
    all: &[Transition],
    schemes: &[Candidate],
) -> Option<Found> {
    let truth = truth(question)?;
    let (candidate, _) = schemes
        .par_iter()
        .filter_map(|scheme| {
            let part = typical_part_of_error(race, scheme, &truth.forced_as(scheme))?;
            let hinted = question.hint.is_some();
            (part <= NEAR || (hinted && part.is_finite())).then_some((scheme, part))
        })
        .collect::<Vec<_>>()
        .into_iter()
        .min_by(|a, b| a.1.total_cmp(&b.1))?;
    let defects = defects_of_all(race.replay, candidate, all);
    let explained = left(race, all, candidate, &defects, Vec::new())?;
    let identity = Identity {
        defect: explained.residual,
        relative: median_relative(&defects),
        undecided: Some(Undecided::Near),
        transitions: all.len(),
        followed: defects.iter().filter(|d| d.fits()).count(),
        left_out: race.left_out.clone(),
        ..Identity::of(candidate)
    };
    Some(Found {
        identity: Some(identity),
        explained: Some(explained),
    })
}

/// Whether what a scheme under wrong forces leaves is small against its own error.
pub(super) fn is_near(question: &Question, race: &Race, scheme: &Candidate) -> bool {
    truth(question).is_some_and(|truth| {
        let part = typical_part_of_error(race, scheme, &truth.forced_as(scheme));
        part.is_some_and(|part| part <= NEAR)
    })
}

/// What a scheme with these deviations leaves; None if it is no number.
pub(super) fn left(
    race: &Race,
    all: &[Transition],
    scheme: &Candidate,
    defects: &[Defect],
    deviations: Vec<Deviation>,
) -> Option<Explained> {
    let pairs = all.iter().zip(defects);
    let worst = pairs.max_by(|a, b| a.1.relative.total_cmp(&b.1.relative));
    let worst = worst.filter(|(_, defect)| !defect.fits());
    let explained = Explained {
        scheme: Some(scheme.label()),
        residual: quantile(defects, 0.5),
        largest_at: worst.map(|(t, _)| race.replay.rows.steps[t.from]),
        deviations,
        equivalent: Vec::new(),
    };
    explained.residual.is_finite().then_some(explained)
}

/// Steps so much finer that their error is none beside a scheme's.
fn truth(question: &Question) -> Option<Candidate> {
    let rk4 = integrators::find("rk4")?;
    Some(Candidate::method(question.system, rk4, 16))
}

/// The median over a few steps of [`part_of_error`].
fn typical_part_of_error(race: &Race, scheme: &Candidate, truth: &Candidate) -> Option<f64> {
    let few = spread(race.sample, MEASURED);
    median(
        few.iter()
            .filter_map(|t| part_of_error(race.replay, scheme, truth, t)),
    )
}

/// How far the data is from a scheme's step, in parts of how far that is from the truth; None where the
/// scheme cannot take it.
fn part_of_error(
    replay: &Replay,
    scheme: &Candidate,
    truth: &Candidate,
    at: &Transition,
) -> Option<f64> {
    let mut replayer = scheme.replayer(&replay.settings);
    let predicted = replay.predict(&mut replayer, at).ok()?;
    let units = replay.units(&mut replayer, at, &predicted, 1).ok()?;
    let off = replay.farthest(at, &predicted, &units);
    let mut exact = truth.replayer(&replay.settings);
    let error = match replay.predict(&mut exact, at) {
        Ok(exact) => {
            let numbers = exact
                .x
                .iter()
                .chain(&exact.v)
                .zip(predicted.x.iter().chain(&predicted.v));
            let errors = numbers
                .zip(&units)
                .map(|((a, b), unit)| (a - b).abs() / unit);
            errors.fold(0.0, f64::max)
        }
        Err(_) => f64::NAN,
    };
    let part = off / error;
    if part.is_finite() {
        return Some(part);
    }
    // The truth is beyond the numbers, or the scheme exact.
    let relative = replay.defect(&mut replayer, at).relative;
    Some(if relative <= SMALL {
        NEAR * relative / SMALL
    } else {
        f64::INFINITY
    })
}
