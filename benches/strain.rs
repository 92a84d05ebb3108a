//! What a strain limit costs: steps of a cloth of 50 x 50 without one, with one that nothing exceeds, and with one that
//! acts. Compare figures of one run only.

#[path = "../tests/testkit/mod.rs"]
mod testkit;

use criterion::{Criterion, criterion_group, criterion_main};
use springcheck::integrators::{self, Settings};
use springcheck::physics::constraints::StrainLimiter;
use springcheck::physics::{ParticleSystem, State};
use springcheck::scene::{DampingModel, Scene, StrainLimit};
use springcheck::solvers::advance;
use std::hint::black_box;
use testkit::cloth::cloth;

/// A cloth of 50 x 50 with this limit and number of sweeps.
fn limited(limit: Option<(f64, usize)>) -> Scene {
    let mut scene = cloth(50, 0.01, DampingModel::Axial);
    scene.strain_limit = limit.map(|(ratio, iterations)| StrainLimit {
        ratio,
        iterations,
        also_compression: false,
    });
    scene
}

/// The timestep, s.
const H: f64 = 5e-5;

/// Steps before it is timed.
const HUNG: u64 = 30_000;

/// Steps of 0.05 ms of symplectic Euler of a cloth that has hung for 1.5 s. A limit of 10 % acts on some springs in each
/// step, one of 0 on about half of them.
fn steps(c: &mut Criterion) {
    let mut group = c.benchmark_group("strain limit, cloth of 50 x 50, a step");
    for (name, limit) in [
        ("none", None),
        ("idle", Some((1e3, 10))),
        ("some springs, 1 sweep", Some((0.1, 1))),
        ("some springs, 4 sweeps", Some((0.1, 4))),
        ("half of the springs, 1 sweep", Some((0.0, 1))),
        ("half of the springs, 4 sweeps", Some((0.0, 4))),
    ] {
        let scene = limited(limit);
        let system = ParticleSystem::new(&scene);
        let method = integrators::find("symplectic_euler").expect("a method");
        let mut integrator = method.build(&Settings::default());
        let mut state = ParticleSystem::initial_state(&scene);
        let mut step = |state: &mut State| {
            let end = state.t + H;
            advance(integrator.as_mut(), black_box(&system), H, end, state).expect("a step")
        };
        let hung: u64 = (0..HUNG).map(|_| step(&mut state).springs).sum();
        println!("{name}: {} springs corrected a step", hung / HUNG);
        group.bench_function(name, |b| b.iter(|| step(&mut state)));
    }
    group.finish();
}

/// One sweep that corrects every spring.
fn sweep(c: &mut Criterion) {
    let scene = limited(Some((0.0, 1)));
    let limiter = StrainLimiter::new(&scene).expect("a limiter");
    let start = ParticleSystem::initial_state(&scene);
    let far: Vec<f64> = start.x.iter().map(|x| 1.1 * x).collect();
    let mut group = c.benchmark_group("strain limit, cloth of 50 x 50, a sweep");
    group.bench_function("every spring", |b| {
        b.iter(|| {
            let (mut x, mut v) = (far.clone(), start.v.clone());
            limiter.correct(None, black_box(&mut x), &mut v)
        });
    });
    group.finish();
}

criterion_group!(benches, steps, sweep);
criterion_main!(benches);
