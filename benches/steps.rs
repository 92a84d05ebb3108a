//! What a step costs, and what recording and measuring add. Compare figures of one run only.

use criterion::{Criterion, criterion_group, criterion_main};
use springcheck::integrators::{self, Settings};
use springcheck::measure::{self, EnergySeries};
use springcheck::physics::ParticleSystem;
use springcheck::scene::{self, Scene};
use springcheck::solvers::{Limits, Setting, Solver};
use springcheck::trajectory::{Recorder, Unwatched};
use springcheck::verbs;
use std::fmt::Write;
use std::hint::black_box;

fn read(yaml: &str) -> Scene {
    scene::parse(yaml.as_bytes(), "bench.yml", verbs::names()).expect("a valid scene")
}

/// One spring and gravity: two effects on one free particle.
fn one_spring() -> Scene {
    read(
        "solver: {type: symplectic_euler, timestep: 0.0005}\n\
         particles:\n\
         - {pos: [0, 0, 2], fixed: true}\n\
         - {pos: [0, 0, 1], mass: 0.2}\n\
         springs: [{particle_ids: [0, 1], stiffness: 20}]\n",
    )
}

/// A chain of 20 links hanging sideways.
fn chain() -> Scene {
    let mut yaml =
        "solver: {type: symplectic_euler, timestep: 0.0005}\nduration: 500\nparticles:\n\
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

fn a_step(c: &mut Criterion) {
    let scene = one_spring();
    let system = ParticleSystem::new(&scene);
    let mut group = c.benchmark_group("one spring, two effects, a step");
    for method in integrators::fixed().iter() {
        let mut integrator = method.build(&Settings::default());
        let mut state = ParticleSystem::initial_state(&scene);
        group.bench_function(method.id, |b| {
            b.iter(|| integrator.step(black_box(&system), 0.0005, &mut state));
        });
    }
    group.finish();
}

/// 1,000,000 steps of the chain: stepping alone, watched for divergence, recorded, and measured too.
fn recording(c: &mut Criterion) {
    let scene = chain();
    let system = ParticleSystem::new(&scene);
    let scale = measure::energy_scale(&scene, &system, None);
    let limits =
        Limits::new(system.clone(), measure::divergence_limit(&scene, scale)).now_and_then();
    let steps = scene.steps(scene.solver.timestep);
    let mut group = c.benchmark_group("chain of 20, 1,000,000 steps");
    group.sample_size(10);
    for id in ["symplectic_euler", "rk4"] {
        let method = integrators::find(id).expect("a method");
        let solver = Solver::method(method);
        let setting = Setting::Steps {
            timestep: 0.0005,
            steps,
        };
        let run = || solver.start(&scene, &system, &setting).expect("a run");
        group.bench_function(format!("{id}, stepping"), |b| {
            b.iter(|| {
                let mut integrator = method.build(&Settings::default());
                let mut state = ParticleSystem::initial_state(&scene);
                for _ in 0..steps {
                    let _ = integrator.step(black_box(&system), 0.0005, &mut state);
                }
                state
            });
        });
        group.bench_function(format!("{id}, watched"), |b| {
            b.iter(|| run().finish(&limits, &mut Unwatched, &|_| {}));
        });
        group.bench_function(format!("{id}, recorded and measured"), |b| {
            b.iter(|| {
                let mut recorder = Recorder::new(steps, 63, 0.0005);
                let _ = run().finish(&limits, &mut recorder, &|_| {});
                let run = recorder.finish();
                let series = EnergySeries::new(&system, &run);
                series.map(|series| measure::judge(&series, scale, false))
            });
        });
    }
    group.finish();
}

criterion_group!(benches, a_step, recording);
criterion_main!(benches);
