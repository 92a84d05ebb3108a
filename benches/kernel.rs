//! What a step costs per spring: one thread, several, and effects nobody calls for. Compare
//! figures of one run only.

#[path = "../tests/testkit/mod.rs"]
mod testkit;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use rayon::ThreadPoolBuilder;
use springcheck::integrators::{self, Settings};
use springcheck::physics::effects::{Effect, Gravity, Springs};
use springcheck::physics::{ForceKinds, ParticleSystem, Power, System};
use springcheck::scene::{DampingModel, Scene};
use std::hint::black_box;
use testkit::cloth::{cloth, shuffled};

/// Steps of one method on a scene, on so many threads. Criterion's elements are springs.
fn steps(
    group: &mut BenchmarkGroup<WallTime>,
    name: &str,
    method: &str,
    scene: &Scene,
    system: &(dyn System + Sync),
    threads: usize,
) {
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.expect("threads");
    let method = integrators::find(method).expect("a method");
    let mut integrator = method.build(&Settings::default());
    let mut state = ParticleSystem::initial_state(scene);
    group.throughput(Throughput::Elements(scene.springs.len() as u64));
    group.bench_function(format!("{name}/{threads} threads"), |b| {
        // 0.05 ms: the cloth stays near where it is, however long the bench.
        pool.install(|| b.iter(|| integrator.step(black_box(system), 5e-5, &mut state)));
    });
}

/// One thread: ns per spring per step by size and damper.
fn one_thread(c: &mut Criterion) {
    let mut group = c.benchmark_group("one thread, symplectic Euler");
    for n in [32, 100, 316] {
        for (damper, damping, model) in [
            ("undamped", 0.0, DampingModel::Axial),
            ("axial", 0.01, DampingModel::Axial),
            ("isotropic", 0.01, DampingModel::Isotropic),
        ] {
            let scene = cloth(n, damping, model);
            let system = ParticleSystem::new(&scene);
            let name = format!("{n}, {damper}");
            steps(&mut group, &name, "symplectic_euler", &scene, &system, 1);
        }
    }
    group.finish();
}

/// Several threads, by size: never a loss, and a gain from where it matters.
fn threads(c: &mut Criterion) {
    for method in ["symplectic_euler", "rk4"] {
        let mut group = c.benchmark_group(format!("threads, {method}"));
        for n in [16, 32, 45, 58, 71, 100, 129, 200, 316] {
            let scene = cloth(n, 0.01, DampingModel::Axial);
            let system = ParticleSystem::new(&scene);
            for threads in [1, 2, 4] {
                let name = format!("{n}, {} springs", scene.springs.len());
                steps(&mut group, &name, method, &scene, &system, threads);
            }
        }
        let scene = shuffled(cloth(316, 0.01, DampingModel::Axial), 1);
        let system = ParticleSystem::new(&scene);
        for threads in [1, 4] {
            steps(
                &mut group,
                "316, shuffled",
                method,
                &scene,
                &system,
                threads,
            );
        }
        group.finish();
    }
}

/// Springs and gravity and nothing else: no registry, no list.
struct ByHand {
    inverse_mass: Vec<f64>,
    gravity: Gravity,
    springs: Springs,
}

impl System for ByHand {
    fn dim(&self) -> usize {
        self.inverse_mass.len()
    }
    fn inverse_mass(&self) -> &[f64] {
        &self.inverse_mass
    }
    fn kinds(&self) -> ForceKinds {
        ForceKinds::NONE
    }
    fn acceleration(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        a.fill(0.0);
        let mut power = self.gravity.add_force(t, x, v, a);
        power += self.springs.add_force(t, x, v, a);
        for (a, w) in a.iter_mut().zip(&self.inverse_mass) {
            *a *= w;
        }
        power
    }
    fn potential(&self, t: f64, x: &[f64]) -> f64 {
        self.gravity.potential(t, x) + self.springs.potential(t, x)
    }
}

/// Drag, wind, attraction and cubic springs are in the registry and not in the scene.
fn absent(c: &mut Criterion) {
    let mut group = c.benchmark_group("effects not called for");
    for n in [2, 8, 32] {
        let scene = cloth(n, 0.0, DampingModel::Axial);
        let registry = ParticleSystem::new(&scene);
        let by_hand = ByHand {
            inverse_mass: registry.inverse_mass().to_vec(),
            gravity: Gravity::new(&scene).expect("gravity"),
            springs: Springs::new(&scene).expect("springs"),
        };
        let systems: [(&str, &(dyn System + Sync)); 2] =
            [("in the registry", &registry), ("by hand", &by_hand)];
        for (name, system) in systems {
            let name = format!("{n}, {name}");
            steps(&mut group, &name, "symplectic_euler", &scene, system, 1);
        }
    }
    group.finish();
}

criterion_group!(benches, one_thread, threads, absent);
criterion_main!(benches);
