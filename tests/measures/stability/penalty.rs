//! A particle on a penalty floor oscillates as on a spring, and limits the step as that does.

use super::measured::{engine, found};
use crate::testkit::method;
use crate::testkit::scenes::parsed;

use springcheck::measure::stability::{Effort, Limit, Linearised, measure};
use springcheck::physics::ParticleSystem;
use springcheck::scene::Scene;
use std::sync::atomic::{AtomicU64, Ordering};

/// sqrt(k/m), rad/s, of 1 kg on 1e4 N/m.
const W: f64 = 100.0;

/// It swings by m g/2k about its rest at m g/k, and so stays inside.
fn pressed() -> Scene {
    parsed(&format!(
        "solver: {{type: symplectic_euler, timestep: 0.001}}\n\
         particles: [{{mass: 1, radius: 0, pos: [0, 0, {}]}}]\n\
         colliders: [{{plane: {{normal: [0, 0, 1]}}}}]\n\
         contact: {{penalty: {{stiffness: 10000}}}}\n",
        -1.5 * 9.81 / (W * W)
    ))
}

#[test]
fn a_penalty_limits_the_step_as_a_spring_does() {
    let scene = pressed();
    let system = ParticleSystem::new(&scene);
    let start = ParticleSystem::initial_state(&scene);
    let linearised = Linearised::new(&system, &start, Effort::FULL);
    for id in ["symplectic_euler", "velocity_verlet"] {
        let right = 2.0 / W;
        let Limit::At(predicted) = linearised.predict(method(id), 0.001).limit else {
            panic!("{id}: no limit is predicted");
        };
        assert!((predicted / right - 1.0).abs() < 1e-9, "{id}: {predicted}");
        let measured = found(&engine(method(id)), &scene, Some(predicted));
        let Limit::At(limit) = measured.limit else {
            panic!("{id}: {measured:?}");
        };
        // Just below its limit Verlet swings farther than it starts, and leaves the floor: measured 5e-3 below.
        assert!((limit / right - 1.0).abs() < 1e-2, "{id}: {limit}");
    }
}

/// Two balls that keep e = 1 on a floor, at steps of many bounces each: what a step takes beyond the usual counts too, so
/// that a search ends. Steps of thousands of force passes are paid for one by one: past the budget goes at most one batch of
/// 256 and one step, of at most 2,000 events of some 120 passes, at 20 a step. Mutant: batches of 256 steps whatever they take.
#[test]
fn a_search_among_bounces_ends_with_its_budget() {
    let scene = parsed(
        "solver: {type: rk4, timestep: 0.02}\nduration: 1\n\
         particles: [{pos: [0, 0, 1], mass: 1}, {pos: [1, 0, 1.5], mass: 1}]\n\
         colliders: [{plane: {normal: [0, 0, 1]}, restitution: 1}]\n",
    );
    let system = ParticleSystem::new(&scene);
    let spent = AtomicU64::new(0);
    let tick = |steps: u64| {
        spent.fetch_add(steps, Ordering::Relaxed);
    };
    let budget = 20_000;
    let found = measure(
        &scene,
        &system,
        &engine(method("rk4")),
        0.02,
        None,
        budget,
        &tick,
    );
    let spent = spent.into_inner();
    assert!(spent < budget + 256 + 12_000, "{spent}");
    // Before the floor is met a step is a linear map, after it is none.
    assert!(!found.linear, "{found:?}");
}
