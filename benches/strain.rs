//! What a strain limit costs: steps of a cloth of 50 x 50 without one, with one that nothing exceeds, and with one that
//! acts. Compare figures of one run only.

#[path = "../tests/testkit/mod.rs"]
mod testkit;

use criterion::{Criterion, criterion_group, criterion_main};
use springcheck::integrators::{self, Settings};
use springcheck::physics::ParticleSystem;
use springcheck::physics::constraints::StrainLimiter;
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

/// Steps of 0.05 ms of symplectic Euler. A limit of 0 acts on about half of the springs of a cloth that hangs.
fn steps(c: &mut Criterion) {
    let mut group = c.benchmark_group("strain limit, cloth of 50 x 50, a step");
    for (name, limit) in [
        ("none", None),
        ("idle", Some((1e3, 10))),
        ("1 sweep", Some((0.0, 1))),
        ("4 sweeps", Some((0.0, 4))),
    ] {
        let scene = limited(limit);
        let system = ParticleSystem::new(&scene);
        let method = integrators::find("symplectic_euler").expect("a method");
        let mut integrator = method.build(&Settings::default());
        let mut state = ParticleSystem::initial_state(&scene);
        group.bench_function(name, |b| {
            b.iter(|| {
                let end = state.t + 5e-5;
                advance(
                    integrator.as_mut(),
                    black_box(&system),
                    5e-5,
                    end,
                    &mut state,
                )
            });
        });
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
