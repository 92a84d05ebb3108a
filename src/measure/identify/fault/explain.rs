//! The change that explains a fault.

use super::super::candidate::Candidate;
use super::super::replay::FIT;
use super::super::transition::{Transition, is_finite};
use super::guesses::{Guess, Way};
use super::spot::{Spot, vector};
use super::{edits, guesses, within};
use crate::measure::identify::{Fault, Quantity};

/// A guess with a defect this small is good: data of the scheme itself can have as much.
const GOOD: f64 = 0.25 * FIT;
/// A good guess also leaves at most this fraction of the departure.
const MUCH: f64 = 0.25;
/// The words where only the writing went wrong.
const ALONE: &str = "in this row only, and the next follows from the one before it";
/// Transitions after the first that a guess is tried on, to see whether it lasts.
const AFTER: usize = 6;
/// The result of trying a guess.
struct Tried<'a> {
    guess: &'a Guess,
    /// The defect at the first departure.
    units: f64,
    /// Whether, with positions alone, the change lies in the step before the one that shows it.
    earlier: bool,
    /// Departures after the first that it explains as well, of those looked at.
    later: usize,
}

impl Spot<'_> {
    /// The fault, with its explanation.
    pub(super) fn explained(&self) -> Fault {
        let step = self.step();
        let alone = self.alone();
        if let Some(says) = edits::impossible(self) {
            let when = match alone {
                true => ALONE.to_owned(),
                false => self.how_often(),
            };
            return self.fault(step, format!("{when}: {says}"));
        }
        if alone {
            let says = edits::of_row(self)
                .or_else(|| edits::rewritten(self))
                .unwrap_or_else(|| off_by(self));
            return self.fault(step, format!("{ALONE}: {says}"));
        }
        let guesses = guesses::all(self);
        let best = self.best(&guesses);
        // A change that stays explains what comes after, whether it has a number or not.
        let lasts = |tried: &Tried| self.again() == 0 || tried.later > 0;
        if let Some(best) = best.as_ref().filter(|best| lasts(best)) {
            return self.by(best);
        }
        let fitted = guesses::numbers(self);
        let fitted = self
            .best(&fitted)
            .filter(|tried| lasts(tried))
            .map(|tried| self.by(&tried));
        if self.again() > 0
            && let Some(fault) = fitted
        {
            return fault;
        }
        if let Some(best) = best {
            return self.by(&best);
        }
        if let Some(says) = within::explain(self, &guesses) {
            return self.fault(step, says);
        }
        let says = edits::of_row(self).or_else(|| edits::of_step(self));
        match (says, fitted) {
            (None, Some(fault)) => fault,
            (says, _) => {
                let says = says.unwrap_or_else(|| unexplained(self));
                self.fault(step, format!("{}: {says}", self.how_often()))
            }
        }
    }

    /// The row is off, but the row after it follows from the row before: only the writing went
    /// wrong.
    fn alone(&self) -> bool {
        let rows = self.replay.rows;
        let next = self.at.to + 1;
        let again = self
            .departures
            .get(1)
            .map(|&place| self.transitions[place].from);
        // A row that is not finite starts no transition.
        let unusable = !is_finite(rows, self.at.to);
        if next >= rows.len() || !(unusable || again == Some(self.at.to)) || !is_finite(rows, next)
        {
            return false;
        }
        let past = Transition {
            to: next,
            ..self.at
        };
        let mut replayer = self.followed.replayer(&self.replay.settings);
        self.replay.defect(&mut replayer, &past).fits()
    }

    /// Of the guesses that explain the departure to rounding, those that explain most departures
    /// after it; of these the first that is good, else the nearest.
    fn best<'g>(&self, guesses: &'g [Guess]) -> Option<Tried<'g>> {
        let wanted = self.again().min(1);
        let mut fitting = Vec::new();
        for guess in guesses {
            let Some(mut tried) = self.tried(guess) else {
                continue;
            };
            let (later, all) = self.later(guess);
            tried.later = later;
            if tried.units <= GOOD && (wanted == 0 || all) {
                return Some(tried);
            }
            fitting.push(tried);
        }
        let most = fitting.iter().map(|t| t.later).max()?;
        fitting.retain(|t| t.later == most);
        let good = fitting.iter().position(|t| t.units <= GOOD);
        let nearest =
            (0..fitting.len()).min_by(|&a, &b| fitting[a].units.total_cmp(&fitting[b].units));
        let at = good.or(nearest)?;
        Some(fitting.swap_remove(at))
    }

    /// Tries a guess; None where rounding does not explain what is left, or the guess explains little.
    fn tried<'g>(&self, guess: &'g Guess) -> Option<Tried<'g>> {
        let own = |leg: &Candidate, candidate: &Candidate, steps: u64| {
            self.distance(self.arrive(leg, candidate, steps).as_ref())
        };
        let here = match &guess.way {
            Way::Scheme(candidate) => own(self.followed, candidate, self.span()),
            Way::Steps(steps) => own(self.followed, self.followed, *steps),
        };
        let fits = |units: f64, earlier: bool| {
            let near = units <= FIT && units <= MUCH * self.defect;
            near.then_some(Tried {
                guess,
                units,
                earlier,
                later: 0,
            })
        };
        let before = || match &guess.way {
            Way::Scheme(candidate) if self.replay.rows.v.is_none() => {
                fits(own(candidate, self.followed, self.span()), true)
            }
            _ => None,
        };
        fits(here, false).or_else(before)
    }

    /// The number of departures after the first that the guess explains, and whether it follows all
    /// transitions that were looked at.
    fn later(&self, guess: &Guess) -> (usize, bool) {
        let Way::Scheme(candidate) = &guess.way else {
            return (0, false);
        };
        let first = self.departures.first().copied().unwrap_or(0);
        let mut replayer = candidate.replayer(&self.replay.settings);
        let (mut explained, mut all) = (0, true);
        let after = self.transitions.iter().enumerate().skip(first + 1);
        for (place, transition) in after.take(AFTER) {
            let fits = self.replay.defect(&mut replayer, transition).fits();
            all &= fits;
            if fits && self.departures.contains(&place) {
                explained += 1;
            }
        }
        (explained, all && explained > 0)
    }

    fn by(&self, tried: &Tried) -> Fault {
        let says = &tried.guess.says;
        let (_, lasts) = self.later(tried.guess);
        let when = if lasts {
            self.how_long()
        } else {
            self.how_often()
        };
        match self.at.before {
            Some(k) if tried.earlier => {
                let shows = "positions alone show it one row later";
                self.fault(
                    self.replay.rows.steps[k],
                    format!("{when}: {says} ({shows})"),
                )
            }
            _ => self.fault(self.step(), format!("{when}: {says}")),
        }
    }
}

/// By how much the worst particle is off.
fn off_by(spot: &Spot) -> String {
    let x = vector(spot, Quantity::Position, 1.0);
    let i = spot.worst;
    if spot.replay.rows.v.is_none() {
        return format!("particle {i} is off by {x} m");
    }
    let v = vector(spot, Quantity::Velocity, 1.0);
    format!("particle {i} is off by {x} m and {v} m/s")
}

/// The words where nothing explains the fault.
fn unexplained(spot: &Spot) -> String {
    format!("{}, which no single change explains", off_by(spot))
}
