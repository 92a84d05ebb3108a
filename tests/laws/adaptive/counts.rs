//! Evaluations, and the stages that are reused.

use super::{pair, pairs, run};
use crate::testkit::built;
use crate::testkit::scenes::shipped;
use springcheck::integrators::adaptive::{Adaptive, Pair};
use springcheck::physics::{Power, State, System};
use springcheck::solvers::{AdaptiveEngine, Engine};
use std::cell::Cell;

/// Six a step of Dormand-Prince 5(4), rejected or not, and two at the start; twelve of DOP853, eleven of
/// its rejected ones, and one at the start.
fn law(id: &str, engine: &AdaptiveEngine, steps: u64) -> Result<(), String> {
    let [accepted, rejected, start] = match id {
        "dop853" => [12, 11, 1],
        _ => [6, 6, 2],
    };
    let expected = accepted * steps + rejected * engine.rejected() + start;
    let counted = engine.counts().force_evaluations;
    if counted == Some(expected) {
        Ok(())
    } else {
        Err(format!("{counted:?} instead of {expected}"))
    }
}

#[test]
fn evaluations_are_as_stated() {
    let scene = shipped("hard/through_each_other.yml");
    for (id, right) in pairs() {
        let (engine, states) = run(&scene, right, 1e-6);
        let steps = states.len() as u64 - 1;
        assert!(steps > 20 && engine.rejected() > 5);
        law(id, &engine, steps).unwrap();
        let per = match id {
            "dop853" => [12, 11],
            _ => [6, 6],
        };
        assert_eq!(right.evaluations(), per);
        let counts = engine.counts();
        assert_eq!(
            (counts.damping_evaluations, counts.linear_solves),
            (Some(0), Some(0))
        );

        let forgetful = Pair {
            first_same_as_last: !right.first_same_as_last,
            ..*right
        };
        let (engine, states) = run(&scene, &forgetful, 1e-6);
        law(id, &engine, states.len() as u64 - 1).unwrap_err();
    }
}

/// Reuse changes no bit: where the last stage is the step's end.
#[test]
fn a_stage_that_is_reused_is_the_one_that_would_be_evaluated() {
    let scene = shipped("order/axial.yml");
    let ends = |id: &str| {
        [true, false].map(|first_same_as_last| {
            let pair = Pair {
                first_same_as_last,
                ..*pair(id)
            };
            let (_, states) = run(&scene, &pair, 1e-6);
            states.last().expect("an end").clone()
        })
    };
    let [reused, evaluated] = ends("dormand_prince54");
    assert_eq!(reused, evaluated);
    // The mutant: DOP853's last stage is at the end's time, and not at its place.
    let [reused, evaluated] = ends("dop853");
    assert_ne!(reused, evaluated);
}

/// Forces that turn round when told to: for the stepper, a state that was changed without notice.
struct Turned<'a> {
    inner: &'a dyn System,
    turned: Cell<bool>,
}

impl System for Turned<'_> {
    fn dim(&self) -> usize {
        self.inner.dim()
    }
    fn inverse_mass(&self) -> &[f64] {
        self.inner.inverse_mass()
    }
    fn acceleration(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        let sign = if self.turned.get() { -1.0 } else { 1.0 };
        let v: Vec<f64> = v.iter().map(|v| sign * v).collect();
        self.inner.acceleration(t, x, &v, a)
    }
    fn potential(&self, t: f64, x: &[f64]) -> f64 {
        self.inner.potential(t, x)
    }
}

/// The stage from before is not used for a state it does not belong to.
#[test]
fn a_state_that_was_changed_is_evaluated_anew() {
    let (system, start) = built(&shipped("order/axial.yml"));
    for (id, pair) in pairs() {
        let turned = Turned {
            inner: &system,
            turned: Cell::new(false),
        };
        let two = |change: &dyn Fn(&mut State), turn: bool, fresh: bool| {
            turned.turned.set(false);
            let mut stepper = Adaptive::new(pair, 1.0, 1.0);
            let mut state = start.clone();
            let h = 0.01;
            let until = state.t + h;
            stepper.step(&turned, until, &mut state).expect("a step");
            assert_eq!(state.t, until);
            change(&mut state);
            turned.turned.set(turn);
            if fresh {
                stepper = Adaptive::new(pair, 1.0, 1.0);
            }
            let until = state.t + h;
            stepper.step(&turned, until, &mut state).expect("a step");
            assert_eq!(state.t, until);
            state
        };
        let flip = |state: &mut State| state.v.iter_mut().for_each(|v| *v = -*v);
        let push = |state: &mut State| state.x[3] += 1e-9;
        let later = |state: &mut State| state.t += 1.0;
        for change in [&flip as &dyn Fn(&mut State), &push, &later] {
            assert_eq!(
                two(change, false, false),
                two(change, false, true),
                "{}",
                id
            );
        }
        // The mutant: what the stepper cannot see, and a stale stage with it.
        let stale = two(&|_| (), true, false) != two(&|_| (), true, true);
        assert_eq!(stale, pair.first_same_as_last, "{}", id);
    }
}
