//! Errors are proportional to the tolerance.

use super::{chain, pair, pairs, run, slope, tolerances};
use crate::testkit::line::released;
use crate::testkit::scenes::shipped;
use springcheck::integrators::adaptive::{ErrorEstimate, Pair};
use springcheck::physics::ParticleSystem;
use springcheck::scene::Scene;
use springcheck::truth::{self, Demand, Motion, NoStore};

/// The largest error of a position over all steps, m: nothing passes through zero in it.
fn error(scene: &Scene, pair: &Pair, tolerance: f64, truth: &dyn Motion) -> f64 {
    let (_, states) = run(scene, pair, tolerance);
    let times: Vec<f64> = states.iter().map(|state| state.t).collect();
    let truth = truth.states(&times);
    let distances = states.iter().enumerate().flat_map(|(k, state)| {
        let pairs = state.x.iter().zip(truth.x(k).to_vec());
        pairs
            .map(|(x, truth)| (x - truth).abs())
            .collect::<Vec<_>>()
    });
    distances.fold(0.0, f64::max)
}

/// ln tolerance and ln error, down to where rounding has a part in it: above 1e-12 m.
fn points(scene: &Scene, pair: &Pair, truth: &dyn Motion) -> Vec<(f64, f64)> {
    let errors = tolerances().map(|tol| (tol, error(scene, pair, tol, truth)));
    let above = errors.filter(|(_, error)| *error > 1e-12);
    above.map(|(tol, error)| (tol.ln(), error.ln())).collect()
}

/// A step's estimate falls as h^k with k the formula's order p, so h is as tolerance^(1/p) and the
/// error, as h^p, as the tolerance. At loose tolerances steps are not small against a radian, and
/// the ratio is off by some power of h: over seven decades, a factor of 5 would be a slope off by
/// ln 5 / ln 1e7 = 0.1.
fn law(seen: f64) -> Result<(), String> {
    if (seen - 1.0).abs() < 0.1 {
        Ok(())
    } else {
        Err(format!("slope {seen:.3}"))
    }
}

fn oscillator() -> (Scene, impl Motion) {
    let scene = shipped("oscillator/oscillator.yml");
    let truth = released(&scene);
    (scene, truth)
}

#[test]
fn errors_are_proportional_to_the_tolerance() {
    let (scene, truth) = oscillator();
    let chain = chain();
    let system = ParticleSystem::new(&chain);
    let found = truth::find(&chain, &system, Demand::Auto, chain.duration, &NoStore);
    // A hundredth of the smallest error.
    assert!(found.error_bound < 1e-12, "{:e}", found.error_bound);
    let motion = found.motion().expect("a truth");
    for (id, pair) in pairs() {
        for (scene, truth) in [(&scene, &truth as &dyn Motion), (&chain, motion)] {
            let points = points(scene, pair, truth);
            assert_eq!(points.len(), 15);
            let seen = slope(&points);
            law(seen).unwrap_or_else(|wrong| panic!("{}: {wrong}", id));
        }
    }
}

#[test]
fn estimates_of_another_order_are_not() {
    let (scene, truth) = oscillator();
    let right = pair("dop853");
    let ErrorEstimate::Mixed53 { fifth, third } = right.estimate else {
        panic!("a mixture");
    };
    // As h^4 alone: 8 / 4. As h^6 alone: 8 / 6.
    for (order, weights, expected) in [(3, third, 2.0), (5, fifth, 8.0 / 6.0)] {
        let estimate = ErrorEstimate::Embedded { order, weights };
        let wrong = Pair { estimate, ..*right };
        let seen = slope(&points(&scene, &wrong, &truth));
        law(seen).unwrap_err();
        assert!((seen - expected).abs() < 0.1, "{order}: {seen}");
    }
    // One that estimates nothing: steps only grow, whatever the tolerance.
    let estimate = ErrorEstimate::Embedded {
        order: 7,
        weights: &[0.0; 12],
    };
    let wrong = Pair { estimate, ..*right };
    law(slope(&points(&scene, &wrong, &truth))).unwrap_err();
}
