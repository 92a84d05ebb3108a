//! Where steps end, and that the same run gives the same bits.

use super::{chain, pair, pairs, run};
use crate::testkit::built;
use crate::testkit::scenes::shipped;
use springcheck::integrators::adaptive::Adaptive;
use springcheck::physics::{ParticleSystem, State};
use springcheck::scene::Scene;
use springcheck::solvers::{AdaptiveEngine, Engine};

#[test]
fn runs_end_where_they_should_and_stay_there() {
    let scene = shipped("order/undamped.yml");
    for (_, pair) in pairs() {
        for until in [1.0 / 3.0, 0.1, 0.7, 1e-9, 1.0] {
            let system = ParticleSystem::new(&scene);
            let mut engine = AdaptiveEngine::new(&scene, system, pair, 1e-7, until);
            let mut before = 0.0;
            while !engine.done() {
                engine.step().expect("a step");
                assert!(engine.state().t > before);
                before = engine.state().t;
            }
            assert_eq!(engine.state().t.to_bits(), f64::to_bits(until));
            let (end, counts) = (engine.state().clone(), engine.counts());
            engine.step().expect("nothing to do");
            assert_eq!((engine.state(), engine.counts()), (&end, counts));
        }
        // Nothing to do at all.
        for until in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let system = ParticleSystem::new(&scene);
            let mut engine = AdaptiveEngine::new(&scene, system, pair, 1e-7, until);
            assert!(engine.done());
            engine.step().expect("nothing to do");
            assert_eq!(engine.state().t, 0.0);
        }
    }
}

/// Tolerances that are none are taken as the tightest or the loosest there is.
#[test]
fn impossible_tolerances_are_the_nearest_possible() {
    let scene = shipped("pa1/scene00.yml");
    for (_, pair) in pairs() {
        let end = |tolerance: f64| run(&scene, pair, tolerance).1;
        let tightest = end(4.0 * f64::EPSILON);
        for tolerance in [f64::NAN, 0.0, -1.0, 1e-300] {
            assert_eq!(end(tolerance), tightest);
        }
        assert_eq!(end(f64::INFINITY), end(1.0));
        assert_ne!(end(1.0), tightest);
    }
}

#[test]
fn runs_repeat_to_the_last_bit() {
    for (_, pair) in pairs() {
        let [one, other] = [(); 2].map(|()| run(&chain(), pair, 1e-6).1);
        assert_eq!(one, other);
    }
}

/// The same scene with lengths in units 1024 times smaller.
fn enlarged(scene: &Scene) -> Scene {
    const BY: f64 = 1024.0;
    let mut scene = scene.clone();
    for particle in &mut scene.particles {
        particle.position = particle.position.map(|x| BY * x);
        particle.velocity = particle.velocity.map(|v| BY * v);
    }
    for spring in &mut scene.springs {
        spring.rest_length *= BY;
    }
    scene.solver.gravity *= BY;
    scene
}

/// A tolerance means the same in any unit of length: a power of two changes exponents only, and no
/// step.
#[test]
fn units_do_not_matter() {
    let scene = chain();
    let large = enlarged(&scene);
    for (_, pair) in pairs() {
        let (_, small) = run(&scene, pair, 1e-6);
        let (_, large) = run(&large, pair, 1e-6);
        assert_eq!(small.len(), large.len());
        for (small, large) in small.iter().zip(&large) {
            let grown = |values: &[f64]| values.iter().map(|x| 1024.0 * x).collect::<Vec<_>>();
            assert_eq!(small.t, large.t);
            assert_eq!(
                (grown(&small.x), grown(&small.v)),
                (large.x.clone(), large.v.clone())
            );
        }
    }
    // The mutant: a tolerance in metres.
    let steps = |scene: &Scene| {
        let (system, mut state) = built(scene);
        let mut stepper = Adaptive::new(pair("dop853"), 1e-6, 1.0);
        let mut steps = 0;
        while state.t < 1.0 {
            stepper.step(&system, 1.0, &mut state).expect("a step");
            steps += 1;
        }
        steps
    };
    assert_ne!(steps(&scene), steps(&large));
}

/// Steps add up to the time, not nearly: each is the difference of the times at its ends.
#[test]
fn a_free_particle_is_where_its_time_says() {
    let mut scene = shipped("order/undamped.yml");
    scene.springs.clear();
    scene.solver.gravity = 0.0;
    scene.duration = 10.0;
    for (_, pair) in pairs() {
        let (_, states) = run(&scene, pair, 1e-12);
        let end: &State = states.last().expect("an end");
        let start = &states[0];
        for at in 0..start.x.len() {
            let x = start.x[at] + 10.0 * start.v[at];
            // A rounding of at most 8 m a step.
            let rounding = 8.9e-16 * states.len() as f64;
            assert!((end.x[at] - x).abs() < rounding, "{} {}", end.x[at], x);
        }
    }
}
