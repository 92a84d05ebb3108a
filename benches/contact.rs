//! What contact costs: steps of a cloth that falls past nothing, past a ball that is out of reach, and over a ball; and of
//! balls at rest on a plane, ours and rapier's. Compare figures of one run only.

#[path = "../tests/testkit/mod.rs"]
mod testkit;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use springcheck::integrators::{self, Settings};
use springcheck::physics::{Counting, ParticleSystem, State};
use springcheck::scene::Scene;
use springcheck::solvers::rapier::{RapierEngine, RapierSettings};
use springcheck::solvers::{Engine, advance};
use std::hint::black_box;
use testkit::scenes::parsed;

/// The timestep of cloths, s.
const H: f64 = 5e-4;

/// A cloth of this many particles on a side, 1 m by 1 m and 0.2 kg, above what is there.
fn cloth(side: usize, colliders: &str) -> Scene {
    parsed(&format!(
        "solver: {{type: velocity_verlet, timestep: {H}}}\n\
         duration: 10\n\
         objects:\n\
         - cloth: {{name: sheet, origin: [-0.5, -0.5, 0], u: [1, 0, 0], v: [0, 1, 0], particles: [{side}, {side}], mass: 0.2,\n\
             \x20   radius: 0.005, drag: 5.0e-5, structural: {{stiffness: 4, damping: 0.01}}, shear: {{stiffness: 2, damping: 0.005}}}}\n\
         {colliders}\n"
    ))
}

/// A step of Verlet from the state after 0.15 s, when the cloth over the ball lies on it in part.
fn cloths(c: &mut Criterion) {
    for side in [20, 100] {
        let mut group = c.benchmark_group(format!("contact, cloth of {side} x {side}, 10 steps"));
        group.sample_size(10);
        for (name, colliders) in [
            ("none", ""),
            (
                "out of reach",
                "colliders: [{ball: {center: [0, 0, -99], radius: 0.4}, friction: 0.3}]",
            ),
            (
                "over a ball",
                "colliders: [{ball: {center: [0, 0, -0.42], radius: 0.4}, friction: 0.3}]",
            ),
        ] {
            let scene = cloth(side, colliders);
            let system = Counting::new(ParticleSystem::new(&scene));
            let mut start = ParticleSystem::initial_state(&scene);
            let run = |state: &mut State, steps: usize| {
                let method = integrators::find("velocity_verlet").expect("a method");
                let mut integrator = method.build(&Settings::default());
                for _ in 0..steps {
                    let end = state.t + H;
                    advance(integrator.as_mut(), black_box(&system), H, end, state)
                        .expect("a step");
                }
            };
            run(&mut start, 300);
            group.bench_function(name, |b| {
                b.iter_batched_ref(
                    || start.clone(),
                    |state| run(state, 10),
                    criterion::BatchSize::LargeInput,
                );
            });
        }
        group.finish();
    }
}

/// Balls of 1 kg side by side on a plane, a step of 1/240 s.
fn at_rest(c: &mut Criterion) {
    let mut group = c.benchmark_group("contact, balls at rest on a plane, a step");
    group.sample_size(10);
    for side in [10, 100] {
        let places = (0..side * side).map(|n| {
            let [x, y] = [n % side, n / side].map(|at| 0.3 * at as f64);
            format!("- {{pos: [{x}, {y}, 0.1], mass: 1, radius: 0.1}}\n")
        });
        let particles: String = places.collect();
        let scene = parsed(&format!(
            "solver: {{type: velocity_verlet, timestep: 0.004166666666666667}}\nduration: 10\n\
             colliders: [{{plane: {{normal: [0, 0, 1]}}, friction: 0.5}}]\nparticles:\n{particles}"
        ));
        let h = scene.solver.timestep;
        let system = Counting::new(ParticleSystem::new(&scene));
        let method = integrators::find("velocity_verlet").expect("a method");
        let mut integrator = method.build(&Settings::default());
        let mut state = ParticleSystem::initial_state(&scene);
        group.bench_function(BenchmarkId::new("velocity_verlet", side * side), |b| {
            b.iter(|| {
                let end = state.t + h;
                advance(integrator.as_mut(), black_box(&system), h, end, &mut state)
                    .expect("a step")
            });
        });
        let settings = RapierSettings::default();
        let engine = RapierEngine::new(&scene, ParticleSystem::new(&scene), h, &settings);
        let mut engine = engine.expect("a world");
        group.bench_function(BenchmarkId::new("rapier", side * side), |b| {
            b.iter(|| engine.step().expect("a step"));
        });
    }
    group.finish();
}

criterion_group!(benches, cloths, at_rest);
criterion_main!(benches);
