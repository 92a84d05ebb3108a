//! Reuse: an integrator uses data from an earlier step only where they fit the present one.

use super::subject::{advance, distance};
use super::systems::Driven;
use super::{Finding, Law, SOLVED_TO};

/// s.
const STEP: f64 = 0.05;

/// Two solutions of the same stage equations from two guesses, each solved to 1e-12, with values of order
/// 1.
const BOUND: f64 = 2.0 * SOLVED_TO;

pub(super) const LAW: Law = Law {
    id: "reuse",
    summary: "handed another state, or the same place at another time, an integrator that has run \
              does what a fresh one does",
    derivation: "two solves to 1e-12 from different guesses; explicit ones give the same bits",
    judge: |subject| {
        let start = Driven::start();
        let mut first = start.clone();
        subject.advance(&Driven, STEP, 1, &mut first)?;
        let mut other_place = first.clone();
        for x in &mut other_place.x {
            *x += 0.25;
        }
        let mut other_time = first;
        other_time.t += 1.0;
        let (mut off, mut case) = (0.0, "another state");
        for (what, state) in [
            ("the start once more", &start),
            ("another place", &other_place),
            ("another time", &other_time),
        ] {
            let mut used = subject.fresh();
            advance(used.as_mut(), &Driven, STEP, 1, &mut start.clone())?;
            let (mut by_used, mut by_fresh) = (state.clone(), state.clone());
            advance(used.as_mut(), &Driven, STEP, 1, &mut by_used)?;
            subject.advance(&Driven, STEP, 1, &mut by_fresh)?;
            let found = distance(&by_used, &by_fresh);
            if found > off {
                (off, case) = (found, what);
            }
        }
        let what = format!("used before, then handed {case}");
        Ok(Finding::at_most(off, BOUND, &what))
    },
};
