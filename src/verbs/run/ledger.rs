//! What the scene is, and which effects ran, how often, at what cost.

use super::plan::Plan;
use super::ran::Run;
use crate::measure::{Check, CheckStatus};
use crate::physics::ParticleSystem;
use crate::physics::effects::Effect;
use crate::report::{EffectUse, SceneFacts};
use crate::scene::Scene;
use crate::solvers::Kind;
use std::time::{Duration, Instant};

pub fn scene_facts(plan: &Plan, runs: &[Run], scale: Option<f64>) -> SceneFacts {
    let scene = plan.scene;
    let (mut forces, mut damping) = (0, 0);
    for (case, run) in plan.cases.iter().zip(runs) {
        if let (Kind::Integrator, Run::Ran(ran)) = (case.solver.kind, run) {
            forces += ran.counts.force_evaluations.unwrap_or(0);
            damping += ran.counts.damping_evaluations.unwrap_or(0);
        }
    }
    let effects = effects(scene, &plan.system, [forces, damping]);
    facts(scene, effects, scale)
}

/// Each effect in force, evaluated so often: all forces, damping alone.
pub fn effects(
    scene: &Scene,
    system: &ParticleSystem,
    [forces, damping]: [u64; 2],
) -> Vec<EffectUse> {
    let start = ParticleSystem::initial_state(scene);
    let rows = system.effects().iter();
    rows.map(|(row, effect)| EffectUse {
        id: row.id.to_owned(),
        members: effect.members(),
        evaluations: forces
            + if effect.kinds().depends_on_velocity() {
                damping
            } else {
                0
            },
        wall_ns: Some(cost(effect.as_ref(), &start.x, &start.v)),
    })
    .collect()
}

/// What the file says, with what ran and the scale of its energy.
pub fn facts(scene: &Scene, effects: Vec<EffectUse>, scale: Option<f64>) -> SceneFacts {
    SceneFacts {
        name: scene.name.clone(),
        file: scene.file.clone(),
        particles: scene.particles.len(),
        springs: scene.springs.len(),
        effects,
        timestep: scene.solver.timestep,
        duration: scene.duration,
        energy_scale_j: scale,
        description: scene.description.clone(),
        own_integrator: scene.solver.method.clone(),
    }
}

/// Nanoseconds of one evaluation: the least of three batches.
fn cost(effect: &dyn Effect, x: &[f64], v: &[f64]) -> f64 {
    let mut f = vec![0.0; x.len()];
    let batch = |f: &mut [f64]| {
        let start = Instant::now();
        let mut calls = 0;
        while start.elapsed() < Duration::from_micros(100) {
            for _ in 0..16 {
                std::hint::black_box(effect.add_force(0.0, x, v, std::hint::black_box(f)));
            }
            calls += 16;
        }
        start.elapsed().as_secs_f64() * 1e9 / f64::from(calls)
    };
    (0..3).map(|_| batch(&mut f)).fold(f64::INFINITY, f64::min)
}

/// Says why errors have no relative size in a scene without an energy scale.
pub fn no_scale(scale: Option<f64>) -> Option<Check> {
    scale.is_none().then(|| Check {
        id: "energy-scale".to_owned(),
        subject: "scene".to_owned(),
        status: CheckStatus::Skip,
        measured: None,
        bound: None,
        derivation: "S = K(0) + U_elastic(0), else the sum of m |g| L".to_owned(),
        message:
            "everything starts at rest with its springs unstretched, and weight or size is 0: \
                  energy errors have no relative size here"
                .to_owned(),
    })
}
