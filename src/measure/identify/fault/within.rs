//! Rows several steps apart: which of the steps between them went wrong.

use super::super::candidate::Candidate;
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
    let prefix = Prefix::new(spot)?;
    let schemes = guesses.iter().filter_map(|guess| match &guess.way {
        Way::Scheme(candidate) => Some((guess, candidate)),
        Way::Steps(_) => None,
    });
    for (guess, candidate) in schemes.take(affordable) {
        for j in 0..span {
            for (only, when) in [(true, "in step"), (false, "from step")] {
                let end = prefix.altered(spot, candidate, j, if only { 1 } else { span - j });
                if spot.distance(end.as_ref()) <= FIT {
                    let step = spot.step() + j;
                    let within = format!("within these {span} steps");
                    let rest = if only { "only" } else { "on" };
                    let says = format!("{within}, {when} {step} {rest}: {}", guess.says);
                    return Some(says);
                }
            }
        }
    }
    None
}

/// The scheme's own states at each step of the span.
struct Prefix(Vec<State>);

impl Prefix {
    fn new(spot: &Spot) -> Option<Self> {
        let h = spot.replay.rows.timestep;
        let mut replayer = spot.followed.replayer(&spot.replay.settings);
        let mut state = spot.replay.state(spot.at.from, None);
        let mut states = vec![state.clone()];
        for j in 0..spot.span() {
            let before = states.len().checked_sub(2).and_then(|k| states.get(k));
            let step = spot.step() + j;
            replayer.advance(step, 1, h, before, &mut state).ok()?;
            states.push(state.clone());
        }
        Some(Self(states))
    }

    /// The end of the span with `steps` steps from the `j`th taken by another candidate.
    fn altered(&self, spot: &Spot, other: &Candidate, j: u64, steps: u64) -> Option<State> {
        let h = spot.replay.rows.timestep;
        let settings = &spot.replay.settings;
        let at = usize::try_from(j).ok()?;
        let mut state = self.0.get(at)?.clone();
        let before = at.checked_sub(1).and_then(|k| self.0.get(k));
        let start = spot.step() + j;
        let mut replayer = other.replayer(settings);
        replayer.advance(start, steps, h, before, &mut state).ok()?;
        let mut replayer = spot.followed.replayer(settings);
        let rest = spot.span() - j - steps;
        replayer
            .advance(start + steps, rest, h, None, &mut state)
            .ok()?;
        state.is_finite().then_some(state)
    }
}
