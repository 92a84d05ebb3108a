//! What a running simulation keeps, and what reading a scene takes: bytes per spring and particle of a large cloth.

#[path = "testkit/mod.rs"]
mod testkit;

use springcheck::integrators::{self, Settings};
use springcheck::physics::ParticleSystem;
use springcheck::scene::{self, DampingModel, Scene};
use springcheck::verbs;
use std::sync::{Mutex, PoisonError};

#[global_allocator]
static ALLOCATOR: dhat::Alloc = dhat::Alloc;

/// One test after the other: they count the bytes of the whole process.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

/// System, state and integrator while a simulation runs, and at the worst moment of two steps; with
/// `scene` the scene it was built from, too. Bytes per spring.
fn bytes_per_spring(method: &str, scene: Scene, keep_scene: bool) -> [f64; 2] {
    let springs = scene.springs.len() as f64;
    let method = integrators::find(method).expect("a method");
    let system = ParticleSystem::new(&scene);
    let mut state = ParticleSystem::initial_state(&scene);
    let kept = keep_scene.then_some(scene);
    let mut integrator = method.build(&Settings::default());
    let mut worst = 0;
    for _ in 0..2 {
        let done = integrator.step(&system, 1e-4, &mut state);
        done.expect("an explicit step");
        worst = worst.max(dhat::HeapStats::get().curr_bytes);
    }
    drop(kept);
    let running = dhat::HeapStats::get().curr_bytes;
    [worst, running].map(|bytes| bytes as f64 / springs)
}

#[test]
fn a_running_simulation_takes_under_100_bytes_per_spring() {
    let _one = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    let _profiler = dhat::Profiler::builder().testing().build();
    // 595,978 springs with dampers between 99,856 particles. A spring takes 32 bytes, and one in
    // twenty has a copy; each has a sixth of a particle, which takes 16 bytes of weight and 24 for
    // each vector: inverse mass, x, v, then a with symplectic Euler, nine vectors with rk4.
    let cloth = || testkit::cloth::cloth(316, 0.01, DampingModel::Axial);
    for (method, vectors) in [("symplectic_euler", 4.0), ("rk4", 12.0)] {
        let [worst, running] = bytes_per_spring(method, cloth(), false);
        let derived = 32.0 * 1.05 + (24.0 * vectors + 16.0) / 5.97;
        println!("{method}: {running:.1} bytes per spring, derived {derived:.1}");
        assert_eq!(worst, running, "{method}: a step takes memory of its own");
        assert!(running < derived + 1.0, "{method}: {running} bytes");
        assert!(running < 100.0, "{method}: {running} bytes");
        // With the scene beside it, it would not be: the scale sees what is kept.
        let [with_scene, _] = bytes_per_spring(method, cloth(), true);
        assert!(
            with_scene > 100.0,
            "{method}: {with_scene} bytes with the scene"
        );
    }
}

#[test]
fn reading_a_cloth_takes_little_more_than_the_cloth() {
    let _one = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    // The names that files may use are made once for all files.
    let names = verbs::names();
    let _profiler = dhat::Profiler::builder().testing().build();
    let text = testkit::cloth::in_few_lines(316);
    let scene = scene::parse(text.as_bytes(), "cloth.yml", names).expect("a scene");
    let read = dhat::HeapStats::get();
    let count = scene.particles.len() as f64;
    let members = size_of_val(&scene.particles[..])
        + size_of_val(&scene.springs[..])
        + size_of_val(&scene.triangles[..]);
    // Vectors double as they grow, and so are at most twice as long as what they hold; the check of distances takes
    // each particle's start once more.
    let derived = (2 * members) as f64 / count + 24.0;
    let peak = read.max_bytes as f64 / count;
    println!("{peak:.0} bytes per particle, derived at most {derived:.0}");
    assert!(peak < derived, "{peak} bytes per particle");
    assert!(read.max_bytes < 400 << 20);
    // No block for a member: 3,762 in all, a dozen for each of 316 rows.
    let blocks = read.total_blocks as f64 / count;
    assert!(blocks < 0.1, "{blocks} blocks per particle");
}
