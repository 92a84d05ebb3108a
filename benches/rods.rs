//! What a rod costs, and what scenes without rods pay. Compare figures of one run only.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use springcheck::integrators::{self, Settings};
use springcheck::physics::ParticleSystem;
use springcheck::scene::{self, Scene};
use springcheck::solvers::advance;
use springcheck::verbs;
use std::fmt::Write;
use std::hint::black_box;

/// A chain of so many links, 10 m long, along a quarter of a circle from a fixed end; `member` is what links are.
fn chain(links: u32, member: &str) -> Scene {
    let mut yaml = "solver: {type: rattle, timestep: 0.0005}\nparticles:\n\
                    - {pos: [0, 0, 0], fixed: true}\n"
        .to_owned();
    let length = 10.0 / f64::from(links);
    let radius = 20.0 / std::f64::consts::PI;
    for i in 1..=links {
        let angle = f64::from(i) * length / radius;
        let [x, z] = [radius * angle.sin(), radius * (1.0 - angle.cos())];
        let _ = writeln!(yaml, "- {{pos: [{x:?}, 0, {z:?}], mass: {length:?}}}");
    }
    let _ = writeln!(yaml, "{member}:");
    for i in 0..links {
        let stiffness = if member == "springs" {
            ", stiffness: 1000"
        } else {
            ""
        };
        let _ = writeln!(yaml, "- {{particle_ids: [{i}, {}]{stiffness}}}", i + 1);
    }
    scene::parse(yaml.as_bytes(), "bench.yml", verbs::names()).expect("a valid scene")
}

/// A step, s, in which no rod turns far, and the time after which a fall begins anew: later the chain cracks like a whip.
const H: f64 = 1e-4;
const FALL: f64 = 0.5;

/// Steps of a moving chain, per rod.
fn a_rod(c: &mut Criterion) {
    for id in ["rattle", "shake", "rk4"] {
        let mut group = c.benchmark_group(format!("a step of a chain, {id}"));
        for links in [10, 100, 1000] {
            let scene = chain(links, "rods");
            let system = ParticleSystem::new(&scene);
            let method = integrators::find(id).expect("a method");
            let mut integrator = method.build(&Settings::default());
            let mut state = ParticleSystem::initial_state(&scene);
            group.throughput(Throughput::Elements(u64::from(links)));
            group.bench_function(format!("{links} rods"), |b| {
                b.iter(|| {
                    if state.t > FALL {
                        state = ParticleSystem::initial_state(&scene);
                    }
                    let end = state.t + H;
                    advance(integrator.as_mut(), black_box(&system), H, end, &mut state)
                        .expect("a step");
                });
            });
        }
        group.finish();
    }
}

/// RATTLE without rods against velocity Verlet, which it then is.
fn no_rod(c: &mut Criterion) {
    let scene = chain(1000, "springs");
    let system = ParticleSystem::new(&scene);
    let mut group = c.benchmark_group("a step of 1,000 springs, no rods");
    for id in ["velocity_verlet", "rattle"] {
        let method = integrators::find(id).expect("a method");
        let mut integrator = method.build(&Settings::default());
        let mut state = ParticleSystem::initial_state(&scene);
        group.bench_function(format!("{id}, as it steps"), |b| {
            b.iter(|| integrator.step(black_box(&system), H, &mut state));
        });
        group.bench_function(format!("{id}, by advance"), |b| {
            b.iter(|| {
                let end = state.t + H;
                advance(integrator.as_mut(), black_box(&system), H, end, &mut state)
            });
        });
    }
    group.finish();
}

criterion_group!(benches, a_rod, no_rod);
criterion_main!(benches);
