//! What 1e-9 m costs with a tolerance, and with fixed steps of rk4. Compare figures of one run only.

use criterion::{Criterion, criterion_group, criterion_main};
use springcheck::integrators::{self, Method};
use springcheck::physics::ParticleSystem;
use springcheck::scene::{self, Scene};
use springcheck::solvers::{Limits, Run, Setting, Solver};
use springcheck::trajectory::Unwatched;
use springcheck::truth::{self, Demand, NoStore};
use springcheck::verbs;
use std::fmt::Write;

/// m, at the end.
const TARGET: f64 = 1e-9;
/// Settings on a grid of this ratio: eight a decade.
const RATIO: f64 = 1.333_521_432_163_324;

fn read(yaml: &str) -> Scene {
    scene::parse(yaml.as_bytes(), "bench.yml", verbs::names()).expect("a valid scene")
}

/// The chain of `steps`, 20 links let go sideways, for 2 s.
fn chain() -> Scene {
    let mut yaml = "solver: {type: symplectic_euler, timestep: 0.0005}\nduration: 2\nparticles:\n\
                    - {pos: [0, 0, 4], fixed: true}\n"
        .to_owned();
    for i in 1..=20 {
        let _ = writeln!(yaml, "- {{pos: [{}, 0, 4], mass: 0.1}}", 0.1 * f64::from(i));
    }
    yaml += "springs:\n";
    for i in 0..20 {
        let _ = writeln!(
            yaml,
            "- {{particle_ids: [{i}, {}], stiffness: 1000, damping: 0.1}}",
            i + 1
        );
    }
    read(&yaml)
}

/// `scenes/oscillator`: 1 kg on 50 N/m, for 5 s.
fn oscillator() -> Scene {
    read(
        "solver: {type: symplectic_euler, timestep: 0.01, gravity: 0}\nduration: 5\nparticles:\n\
         - {pos: [0, 0, 0], fixed: true}\n\
         - {pos: [0.5, 0, 0], mass: 1}\n\
         springs: [{particle_ids: [0, 1], stiffness: 50, rest_length: 0}]\n",
    )
}

fn finished(solver: &Solver, scene: &Scene, system: &ParticleSystem, setting: Setting) -> Run {
    let mut run = solver.start(scene, system, &setting).expect("a run");
    let limits = Limits::new(system.clone(), None).now_and_then();
    run.finish(&limits, &mut Unwatched, &|_| {});
    run
}

fn by_pair(scene: &Scene, system: &ParticleSystem, pair: &'static Method, tolerance: f64) -> Run {
    let setting = Setting::Tolerance {
        tolerance,
        duration: scene.duration,
        steps: 1,
        most: u64::MAX,
    };
    finished(&Solver::method(pair), scene, system, setting)
}

fn by_steps(scene: &Scene, system: &ParticleSystem, method: &'static Method, n: u64) -> Run {
    let setting = Setting::divided(scene.duration, n);
    finished(&Solver::method(method), scene, system, setting)
}

/// The first setting from which on three in a row reach the target.
fn loosest(mut next: impl FnMut(i32) -> f64) -> i32 {
    let mut reached = 0;
    for k in 0..200 {
        reached = if next(k) <= TARGET { reached + 1 } else { 0 };
        if reached == 3 {
            return k - 2;
        }
    }
    panic!("the target is not reached");
}

fn to_the_target(c: &mut Criterion, name: &str, scene: &Scene) {
    let system = ParticleSystem::new(scene);
    let truth = truth::find(scene, &system, Demand::Auto, scene.duration, &NoStore);
    let motion = truth.motion().expect("a truth");
    let end = motion.states(&[scene.duration]);
    let error = |engine: &Run| {
        let pairs = engine.state().x.chunks(3).zip(end.x.chunks(3));
        let squares = pairs.map(|(a, b)| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum());
        let largest: f64 = squares.fold(0.0, f64::max);
        largest.sqrt()
    };
    let mut group = c.benchmark_group(format!("{name}, to 1e-9 m"));
    for pair in integrators::pairs() {
        let tolerance = |k: i32| 1e-4 * RATIO.powi(-k);
        let at = tolerance(loosest(|k| {
            error(&by_pair(scene, &system, pair, tolerance(k)))
        }));
        let engine = by_pair(scene, &system, pair, at);
        let evaluations = engine.counts().force_evaluations;
        println!(
            "{}: tolerance {at:.1e}, error {:.1e} m, {} steps, {evaluations:?}",
            pair.id,
            error(&engine),
            engine.taken()
        );
        group.bench_function(pair.id, |b| b.iter(|| by_pair(scene, &system, pair, at)));
    }
    let rk4 = integrators::find("rk4").expect("a method");
    let steps = |k: i32| (100.0 * RATIO.powi(k)) as u64;
    let at = steps(loosest(|k| error(&by_steps(scene, &system, rk4, steps(k)))));
    println!("rk4: {at} steps");
    group.bench_function("rk4", |b| b.iter(|| by_steps(scene, &system, rk4, at)));
    group.finish();
}

fn accuracy(c: &mut Criterion) {
    to_the_target(c, "oscillator over 5 s", &oscillator());
    to_the_target(c, "chain of 20 over 2 s", &chain());
}

criterion_group!(benches, accuracy);
criterion_main!(benches);
