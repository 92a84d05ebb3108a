//! What a run is expected to take on a nominal machine, from what it counts: the same on every machine,
//! so that all sweep the same settings.

use crate::physics::ParticleSystem;
use crate::scene::Scene;
use crate::solvers::Kind;
use crate::solvers::{Setting, Solver};

/// Nanoseconds on the nominal machine. A step beside its forces, and each particle in it:
const STEP: f64 = 30.0;
const PARTICLE: f64 = 4.0;
/// An evaluation beside its members, and each particle and spring in it:
const CALL: f64 = 35.0;
const EVALUATION: f64 = 4.0;
const SPRING: f64 = 10.0;
/// A linear solve of n free particles, n^1.5 of these while it is small and dense, n of the others:
const DENSE: f64 = 280.0;
const SPARSE: f64 = 2_500.0;
/// A step of rapier, each body and joint in it, and in each of its substeps:
const WORLD: f64 = 1_000.0;
const BODY: f64 = 250.0;
const SWEPT: f64 = 90.0;
/// Steps the counts are taken from.
const SAMPLE: u64 = 4;

/// Runs a timing takes, and the least time it takes, ns.
pub(super) const TIMED: f64 = 3.5;
pub(super) const TIMED_LEAST: f64 = 1.2e7;

/// Nanoseconds a step.
pub fn of_step(scene: &Scene, system: &ParticleSystem, solver: &Solver, setting: &Setting) -> f64 {
    let (particles, springs) = (scene.particles.len() as f64, scene.springs.len() as f64);
    if solver.kind == Kind::Rapier {
        let substeps = f64::from(solver.substeps);
        return WORLD + (particles + springs) * (BODY + SWEPT * substeps);
    }
    let Ok(mut run) = solver.start(scene, system, setting) else {
        return STEP;
    };
    // A step that fails ends the sample.
    let _ = run.advance(SAMPLE);
    let counts = run.counts();
    let each = |count: Option<u64>| count.unwrap_or(0) as f64 / run.taken().max(1) as f64;
    let pairs = scene.gravitational.len() as f64;
    let evaluation = CALL + EVALUATION * particles + SPRING * (springs + 2.0 * pairs);
    let free = scene.particles.iter().filter(|p| !p.fixed).count() as f64;
    let solve = (DENSE * free.powf(1.5)).min(SPARSE * free);
    STEP + PARTICLE * particles
        + evaluation * each(counts.all_force_passes())
        + solve * each(counts.linear_solves)
}
