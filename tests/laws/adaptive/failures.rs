//! Steps that are rejected, and runs that end early.

use super::{pair, pairs, run};
use crate::testkit::scenes::shipped;
use springcheck::integrators::StepError;
use springcheck::integrators::adaptive::{Adaptive, ErrorEstimate, Pair};
use springcheck::physics::{Power, State, System};
use springcheck::solvers::Engine;
use std::f64::consts::PI;

/// Two ends run into each other: the force turns round in no time. Steps become short there, and it is
/// there that they are rejected.
#[test]
fn steps_are_short_where_the_force_is_sudden() {
    let scene = shipped("hard/through_each_other.yml");
    for ((id, pair), least) in pairs().zip([1.23e-3, 7.5e-3]) {
        let (engine, states) = run(&scene, pair, 1e-6);
        assert!(engine.rejected() > 10, "{}", id);
        let length = |two: &&[State]| two[1].t - two[0].t;
        let shortest = states
            .windows(2)
            .min_by(|a, b| length(a).total_cmp(&length(b)))
            .expect("steps were taken");
        let h = length(&shortest);
        // How long, at the 8 m/s they meet at, from the nearer end of that step to where they meet.
        let apart = |state: &State| (state.x[3] - state.x[0]).abs();
        let away = apart(&shortest[0]).min(apart(&shortest[1])) / 8.0;
        // A force that turns by 80 N is off by that in one stage at least. At 6 m/s a velocity may be off by
        // 6e-6 m/s, which is 80 h times the estimate's weight of the first stage, the smallest: 71/57600, and
        // in DOP853's mixture 0.0131² / hypot(0.0131, 0.0190). Measured 5.6e-5 and 2.7e-6 s.
        let allowed = 6e-6 / (80.0 * least);
        assert!(h < allowed && away < allowed, "{}: {h} {away}", id);
    }
    // The mutant: an estimate of nothing rejects nothing.
    let wrong = Pair {
        estimate: ErrorEstimate::Embedded {
            order: 4,
            weights: &[0.0; 7],
        },
        ..*pair("dormand_prince54")
    };
    let (engine, _) = run(&scene, &wrong, 1e-6);
    assert_eq!(engine.rejected(), 0);
}

/// One particle that moves along x, with this acceleration there.
struct One(fn(f64) -> f64);

impl System for One {
    fn dim(&self) -> usize {
        3
    }
    fn inverse_mass(&self) -> &[f64] {
        &[1.0; 3]
    }
    fn acceleration(&self, _t: f64, x: &[f64], _v: &[f64], a: &mut [f64]) -> Power {
        a.fill(0.0);
        a[0] = (self.0)(x[0]);
        Power::default()
    }
    fn potential(&self, _t: f64, _x: &[f64]) -> f64 {
        0.0
    }
}

fn outcome(system: &dyn System, pair: &Pair) -> (Result<(), StepError>, State) {
    let mut state = State::new(vec![1.0, 0.0, 0.0], vec![0.0; 3]);
    let mut stepper = Adaptive::new(pair, 1e-6, 1.0);
    while state.t < 2.0 {
        let before = state.clone();
        if let Err(error) = stepper.step(system, 2.0, &mut state) {
            assert_eq!(state, before, "an error moves nothing");
            return (Err(error), state);
        }
    }
    (Ok(()), state)
}

/// From rest at 1 m under x'' = -1/x² the centre is reached at π / (2 sqrt 2) s, and no
/// step leads there.
#[test]
fn a_motion_that_explodes_ends_with_a_time_and_a_particle() {
    let system = One(|x| -1.0 / (x * x));
    for (id, pair) in pairs() {
        let (ended, _) = outcome(&system, pair);
        let Err(StepError::TooShort { t, particle: 0 }) = ended else {
            panic!("{}: {ended:?}", id);
        };
        let collapse = PI / 8_f64.sqrt();
        assert!((t - collapse).abs() < 1e-4, "{}: {t}", id);
    }
    // Pushed outwards it is all well.
    let (ended, _) = outcome(&One(|x| 1.0 / (x * x)), pair("dop853"));
    assert_eq!(ended, Ok(()));
}

#[test]
fn forces_that_are_not_finite_are_named() {
    for (id, pair) in pairs() {
        let (ended, state) = outcome(&One(|_| f64::NAN), pair);
        assert_eq!(ended, Err(StepError::NotFinite { particle: 0 }));
        assert_eq!(state.t, 0.0);
        // From half-way on: x = 1 - t²/2 gets there at 1 s.
        let (ended, state) = outcome(&One(|x| if x < 0.5 { f64::INFINITY } else { -1.0 }), pair);
        assert_eq!(ended, Err(StepError::NotFinite { particle: 0 }));
        assert!((state.t - 1.0).abs() < 1e-12, "{}: {}", id, state.t);
    }
}
