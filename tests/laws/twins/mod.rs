//! rapier's worlds are the scenes they claim to be: each engine equals the method of ours that it
//! is. Every law is a number that is small for the right pair and large for a mutant.

mod contact;
mod forces;
mod joints;
mod proofs;
mod scenes;
mod worlds;

use springcheck::integrators;
use springcheck::physics::ParticleSystem;
use springcheck::scene::Scene;
use springcheck::solvers::{
    Engine, IntegratorEngine, Setting, Solver, find, rapier::RapierSettings,
};

/// An integrator of ours on a scene.
fn ours(scene: &Scene, method: &str, h: f64) -> Box<dyn Engine> {
    Box::new(IntegratorEngine::new(
        scene,
        ParticleSystem::new(scene),
        integrators::find(method).expect(method),
        &integrators::Settings::default(),
        h,
    ))
}

/// A registered engine on a scene.
fn theirs(scene: &Scene, id: &str, timestep: f64) -> Box<dyn Engine> {
    build(&find(id).expect(id), scene, timestep)
}

fn build(solver: &Solver, scene: &Scene, timestep: f64) -> Box<dyn Engine> {
    let system = ParticleSystem::new(scene);
    let engine = solver.engine(scene, &system, &Setting::step(timestep));
    engine.unwrap_or_else(|e| panic!("{}: {e}", scene.name))
}

/// rapier with so many substeps and sweeps, none after the drift.
fn swept(iterations: u32, pgs: u32) -> Solver {
    Solver::rapier(RapierSettings {
        iterations,
        pgs,
        stabilization: 0,
        ..RapierSettings::DEFAULT
    })
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, c| most.max(c.abs()))
}

/// Largest distance of positions and velocities, each in units of the largest one, over `steps`
/// steps of `a` and as many times `substeps` of `b`. Infinite once a number is not finite.
fn apart(a: &mut dyn Engine, b: &mut dyn Engine, substeps: u32, steps: u32) -> f64 {
    let mut worst = 0.0_f64;
    let (mut x, mut v) = (largest(&a.state().x), largest(&a.state().v));
    let far = |a: &[f64], b: &[f64]| {
        let d: Vec<_> = a.iter().zip(b).map(|(a, b)| a - b).collect();
        if d.iter().all(|d| d.is_finite()) {
            largest(&d)
        } else {
            f64::INFINITY
        }
    };
    for _ in 0..steps {
        a.step().expect("a step");
        for _ in 0..substeps {
            b.step().expect("a step");
        }
        let (a, b) = (a.state(), b.state());
        (x, v) = (x.max(largest(&a.x)), v.max(largest(&a.v)));
        // 0 / 0 where nothing moves.
        let (dx, dv) = (far(&a.x, &b.x), far(&a.v, &b.v));
        worst = worst.max(if dx > 0.0 { dx / x } else { 0.0 });
        worst = worst.max(if dv > 0.0 { dv / v } else { 0.0 });
    }
    worst
}

/// The scene changed by a mutation.
fn mutated(scene: &Scene, mutate: impl FnOnce(&mut Scene)) -> Scene {
    let mut scene = scene.clone();
    mutate(&mut scene);
    scene
}
