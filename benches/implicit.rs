//! What an implicit step costs on a cloth. Compare figures of one run only.

use criterion::{Criterion, criterion_group, criterion_main};
use springcheck::integrators::{self, Settings};
use springcheck::physics::ParticleSystem;
use springcheck::scene::{self, Scene};
use std::fmt::Write;
use std::hint::black_box;

/// s.
const STEP: f64 = 5e-3;

/// n by n particles of 10 g, 10 cm apart, hung by two corners: structural, shear and flexion
/// springs.
fn cloth(n: usize, stiffness: f64) -> Scene {
    let mut yaml = format!("solver: {{type: implicit_euler, timestep: {STEP}}}\nparticles:\n");
    for (row, column) in (0..n * n).map(|p| (p / n, p % n)) {
        let (x, y) = (0.1 * row as f64, 0.1 * column as f64);
        let fixed = row == 0 && (column == 0 || column == n - 1);
        let _ = writeln!(yaml, "- {{pos: [{x}, {y}, 2], mass: 0.01, fixed: {fixed}}}");
    }
    yaml += "springs:\n";
    for (row, column) in (0..n * n).map(|p| (p / n, p % n)) {
        for (down, right) in [(0, 1), (1, 0), (1, 1), (1, -1), (0, 2), (2, 0)] {
            let (to_row, to) = (row + down, column as isize + right);
            if to_row < n && (0..n as isize).contains(&to) {
                let ends = [row * n + column, to_row * n + to as usize];
                let _ = writeln!(yaml, "- {{particle_ids: {ends:?}, stiffness: {stiffness}}}");
            }
        }
    }
    scene::parse(yaml.as_bytes(), "cloth.yml", springcheck::verbs::names()).expect("a valid scene")
}

fn a_step(c: &mut Criterion) {
    let mut group = c.benchmark_group("cloth 100 x 100, implicit Euler, a step");
    group.sample_size(10);
    for (stiffness, tolerance) in [(1e2, 1e-6), (1e4, 1e-10), (1e4, 1e-12)] {
        let scene = cloth(100, stiffness);
        let system = ParticleSystem::new(&scene);
        let method = integrators::find("implicit_euler").expect("a method");
        let mut integrator = method.build(&Settings {
            tolerance,
            ..Settings::default()
        });
        let mut state = ParticleSystem::initial_state(&scene);
        group.bench_function(format!("k = {stiffness}, to {tolerance:e}"), |b| {
            b.iter(|| integrator.step(black_box(&system), STEP, &mut state));
        });
    }
    group.finish();
}

criterion_group!(benches, a_step);
criterion_main!(benches);
