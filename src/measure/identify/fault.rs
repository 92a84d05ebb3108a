//! The first fault: the first transition that leaves the scheme, and which change explains it.
//!
//! Rows that end early are no fault here; whether a file is whole is for its reader to say.

mod anchor;
mod edits;
mod explain;
mod guesses;
mod spot;
mod within;

pub use anchor::moved_anchor;

use super::candidate::{Candidate, Replayer};
use super::replay::{FIT, Replay};
use super::transition::{Transition, is_finite, neighbours};
use super::{HALF_SAMPLE, Identity, Question, Undecided, candidates, contact, rods, transition};
use crate::integrators;
use crate::measure::identify::Fault;
use crate::physics::{ParticleSystem, System};
use crate::trajectory::Rows;
use rayon::prelude::*;
use spot::Spot;

/// Transitions one replayer takes.
const CHUNK: usize = 64;
/// Directions in which inputs are moved by their rounding before a departure is called one. Two
/// equal roundings cancel in half of the directions; in a file of a million transitions they must
/// not in all.
const NUDGES: u64 = 32;
/// Beyond this defect no direction makes a difference.
const CLEARLY: f64 = 64.0 * FIT;

/// The first transition that does not follow the identity; for a mistake, the method it was meant
/// to be. None where all follow, and where nothing was identified. All rows are looked at, whatever
/// `question.transitions` is.
pub fn first_fault(question: &Question, identity: &Identity) -> Option<Fault> {
    let near = identity.undecided == Some(Undecided::Near);
    if near || followed_everywhere(question.rows, identity) {
        return None;
    }
    let named = |c: &Candidate| {
        (c.id.as_str(), c.substeps, &c.says)
            == (&identity.method, identity.substeps, &identity.says)
    };
    let mut all = candidates(question.scene, question.system);
    let treated = identity.contact.as_ref();
    let bounce = treated.and_then(|treated| treated.bounce.as_ref());
    let damped = || contact::damped(question, bounce?).into_iter().find(named);
    let candidate = all
        .find(named)
        .or_else(damped)
        .or_else(|| fitted(question).into_iter().find(named))?;
    let Some(treated) = treated else {
        return first_departure(question, &candidate);
    };
    let Some(bounce) = bounce else {
        let says = treated.says.clone();
        return match treated.unjudged {
            true => departure(question, &candidate, &|t| !met(question, t), |spot| {
                spot.explained()
            }),
            false => departure(question, &candidate, &|_| true, |spot| spot.counted(says)),
        };
    };
    if treated.mistakes.is_empty() {
        let candidate = candidate.bouncing(question.scene, question.system, bounce)?;
        return first_departure(question, &candidate);
    }
    let says = format!("at contact it {}", treated.says);
    departure(question, &candidate, &|_| true, |spot| spot.counted(says))
}

/// Whether something may touch in a transition.
fn met(question: &Question, t: &Transition) -> bool {
    let obstacles = question.system.obstacles();
    obstacles.is_some_and(|all| transition::beside(all, question.rows, t).is_some())
}

/// The candidates with a number that the rows tell.
fn fitted(question: &Question) -> Vec<Candidate> {
    let Question {
        scene,
        system,
        rows,
        settings,
        ..
    } = *question;
    let used = transition::choose(rows, system, question.transitions);
    let sample = super::bare(&transition::sample(&used, HALF_SAMPLE));
    let replay = Replay::new(scene, system, rows, settings);
    replay.map_or_else(Vec::new, |replay| {
        rods::fitted(scene, system, &replay, &sample, question.budget / 2)
    })
}

/// Whether the replay that found the identity has already seen every row follow it.
fn followed_everywhere(rows: &Rows, identity: &Identity) -> bool {
    let all = identity.transitions + 1 == rows.len();
    all && identity.followed == identity.transitions && !identity.mistake
}

/// The first transition that does not follow a candidate of the caller's choice.
pub fn first_departure(question: &Question, candidate: &Candidate) -> Option<Fault> {
    departure(question, candidate, &|_| true, |spot| {
        match candidate.says.as_ref().filter(|_| candidate.mistake) {
            None => spot.explained(),
            Some(says) => spot.throughout(says.to_string()),
        }
    })
}

/// The first of some transitions that does not follow a candidate, and how that is told.
fn departure(
    question: &Question,
    candidate: &Candidate,
    some: &dyn Fn(&Transition) -> bool,
    told: impl FnOnce(&Spot) -> Fault,
) -> Option<Fault> {
    let Question {
        scene,
        system,
        rows,
        settings,
        ..
    } = *question;
    let replay = Replay::new(scene, system, rows, settings)?;
    let method = || integrators::find(candidate.meant);
    let followed = if candidate.mistake {
        Candidate::method(system, method()?, candidate.substeps)
    } else {
        candidate.clone()
    };
    let start = ParticleSystem::initial_state(scene);
    let begins = rows.steps.first() == Some(&0) && rows.v(0) == Some(&start.v[..]);
    // Velocities that are staggered in the first row already are not begun again.
    let followed = if begins {
        followed
    } else {
        followed.begun_before()
    };
    let followed = replay.remembering(followed);
    let known = |t: &Transition| some(t) && replay.knows(&followed, t.from);
    let transitions: Vec<Transition> = neighbours(rows).filter(known).collect();
    let departures = departures(&replay, &followed, &transitions);
    // A closer look at one may find that rounding explains it after all.
    let spot = (0..departures.len())
        .find_map(|k| Spot::new(question, &replay, &followed, &transitions, &departures[k..]))?;
    Some(told(&spot))
}

/// The indices of the transitions that do not follow the candidate, in order.
fn departures(replay: &Replay, followed: &Candidate, transitions: &[Transition]) -> Vec<usize> {
    let places: Vec<usize> = (0..transitions.len()).collect();
    let chunks = places.par_chunks(CHUNK).flat_map_iter(|chunk| {
        let mut replayer = followed.replayer(&replay.settings);
        let leaves = |&&place: &&usize| departs(replay, &mut replayer, &transitions[place]);
        chunk.iter().filter(leaves).copied().collect::<Vec<_>>()
    });
    chunks.collect()
}

/// Whether rounding does not explain it. Where the scheme itself cannot step, nothing is claimed.
fn departs(replay: &Replay, replayer: &mut Replayer, transition: &Transition) -> bool {
    if !is_finite(replay.rows, transition.to) {
        return replay.predict(replayer, transition).is_ok();
    }
    let units = replay.defect(replayer, transition).units;
    if units <= FIT {
        return false;
    }
    // The defect is also infinite where the data leaves no room at all.
    let Ok(predicted) = replay.predict(replayer, transition) else {
        return false;
    };
    units > CLEARLY || {
        let units = replay.units(replayer, transition, &predicted, NUDGES);
        units.is_ok_and(|units| replay.farthest(transition, &predicted, &units) > FIT)
    }
}
