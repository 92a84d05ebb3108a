//! Rows several steps apart: which of the steps between them went wrong.

use super::super::replay::FIT;
use super::guesses::{Guess, Way};
use super::spot::Spot;
use crate::physics::State;

/// Coordinates times steps that may be spent on the search.
const BUDGET: u64 = 30_000_000;

/// The first guess that, made in one step of the span or from one step on, explains its end.
pub(super) fn explain(spot: &Spot, guesses: &[Guess]) -> Option<String> {
    let span = spot.span();
    if span < 2 || spot.replay.rows.v.is_none() {
        return None;
    }
    let cost = span * span * spot.replay.rows.dim as u64;
    let affordable = (BUDGET / cost.max(1)) as usize;
    let own = own(spot)?;
    let schemes = guesses.iter().filter_map(|guess| match &guess.way {
        Way::Scheme(candidate) => Some((guess, candidate)),
        Way::Steps(_) => None,
    });
    for (guess, candidate) in schemes.take(affordable) {
        for (j, start) in (0..).zip(&own[..own.len() - 1]) {
            let before = (j as usize).checked_sub(1).map(|k| &own[k]);
            for (until, when, rest) in [(j + 1, "in step", "only"), (span, "from step", "on")] {
                let wrong = spot.advance(candidate, j..until, before, start.clone());
                let end = wrong.and_then(|at| spot.advance(spot.followed, until..span, None, at));
                if spot.distance(end.as_ref()) <= FIT {
                    let (step, says) = (spot.step() + j, &guess.says);
                    let within = format!("within these {span} steps");
                    return Some(format!("{within}, {when} {step} {rest}: {says}"));
                }
            }
        }
    }
    None
}

/// The scheme's own states, from the start of the span to its end.
fn own(spot: &Spot) -> Option<Vec<State>> {
    let mut states = vec![spot.replay.state(spot.at.from, None)];
    for j in 0..spot.span() {
        let before = states.len().checked_sub(2).map(|k| &states[k]);
        let next = spot.advance(spot.followed, j..j + 1, before, states.last()?.clone());
        states.push(next?);
    }
    Some(states)
}
