//! Adaptive pairs: their coefficients, orders, tolerances, counts, and what they do where steps fail.

mod balance;
mod counts;
mod ends;
mod failures;
mod orders;
mod tableaux;
mod tolerance;

use springcheck::integrators;
use springcheck::integrators::adaptive::Pair;
use springcheck::physics::{ParticleSystem, State};
use springcheck::scene::Scene;
use springcheck::solvers::{AdaptiveEngine, Engine};

/// Every pair and its id.
fn pairs() -> impl Iterator<Item = (&'static str, &'static Pair)> {
    let pairs = integrators::pairs().iter();
    pairs.map(|method| (method.id, method.pair().expect("a pair")))
}

/// Of the formula that is advanced.
fn order(id: &str) -> u32 {
    integrators::find(id).expect("a pair").order
}

fn pair(id: &str) -> &'static Pair {
    let method = integrators::find(id).and_then(|method| method.pair());
    method.unwrap_or_else(|| panic!("no pair {id}"))
}

/// A chain of five links let go sideways, with dampers.
fn chain() -> Scene {
    let mut scene = crate::testkit::scenes::chain(5, 0.1, 0.1, 100.0);
    scene.solver.gravity = -9.81;
    scene.duration = 1.0;
    for spring in &mut scene.springs {
        spring.damping = 0.1;
    }
    scene
}

/// A run to the end of a scene: the engine there, and its states, the start included.
fn run(scene: &Scene, pair: &Pair, tolerance: f64) -> (AdaptiveEngine, Vec<State>) {
    let system = ParticleSystem::new(scene);
    let mut engine = AdaptiveEngine::new(scene, system, pair, tolerance, scene.duration);
    let mut states = vec![engine.state().clone()];
    while !engine.done() {
        engine.step().expect("a step");
        states.push(engine.state().clone());
    }
    (engine, states)
}

/// Slope of a line through points, by least squares.
fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let mean_x = points.iter().map(|p| p.0).sum::<f64>() / n;
    let mean_y = points.iter().map(|p| p.1).sum::<f64>() / n;
    let (mut xy, mut xx) = (0.0, 0.0);
    for (x, y) in points {
        xy += (x - mean_x) * (y - mean_y);
        xx += (x - mean_x) * (x - mean_x);
    }
    xy / xx
}

/// 1e-3, 10^-3.5, ... 1e-10.
fn tolerances() -> impl Iterator<Item = f64> {
    (6..=20).map(|k| 10_f64.powf(-0.5 * f64::from(k)))
}
