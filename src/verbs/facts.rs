//! The facts about a scene and its truth that the reports of all verbs state, and what all their runs use: the
//! energy scale and the limits beyond which a run has diverged.

use crate::measure::{self, Check, CheckStatus};
use crate::physics::effects::Effect;
use crate::physics::{ParticleSystem, System};
use crate::report::{EffectUse, SceneFacts, TruthFacts};
use crate::scene::Scene;
use crate::solvers::Limits;
use crate::truth::{Truth, TruthKind};
use std::time::{Duration, Instant};

/// The scale S of energy errors, J. It takes in the largest kinetic energy of the truth up to its horizon.
pub fn energy_scale(scene: &Scene, system: &ParticleSystem, truth: &Truth) -> Option<f64> {
    let peak = truth.motion().map(|motion| {
        let times = motion.landmarks(truth.horizon);
        let states = motion.states(&times);
        let kinetic = (0..times.len()).map(|k| system.kinetic(states.v(k)));
        kinetic.fold(0.0, f64::max)
    });
    measure::energy_scale(scene, system, peak.filter(|peak| peak.is_finite()))
}

/// The limits beyond which a run of this scene has diverged. They do not depend on whether a truth is known.
pub fn limits(scene: &Scene, system: &ParticleSystem) -> Limits {
    let scale = measure::energy_scale(scene, system, None);
    Limits::new(system.clone(), measure::divergence_limit(scene, scale))
}

/// The file's facts, its energy scale (J), and each active effect with how often hand-written integrators
/// evaluated it: `forces` counts evaluations of all forces, `damping` further ones of damping alone.
pub fn scene(
    scene: &Scene,
    system: &ParticleSystem,
    [forces, damping]: [u64; 2],
    scale: Option<f64>,
) -> SceneFacts {
    let start = ParticleSystem::initial_state(scene);
    let effects = system.effects().iter().map(|(row, effect)| {
        let damps = effect.kinds().depends_on_velocity();
        EffectUse {
            id: row.id.to_owned(),
            members: effect.members(),
            evaluations: forces + if damps { damping } else { 0 },
            wall_ns: Some(wall_ns(effect.as_ref(), &start.x, &start.v)),
        }
    });
    // Every evaluation solves for their forces; rattle and shake solve beside it.
    let rods = system.rods().map(|rods| EffectUse {
        id: "rods".to_owned(),
        members: rods.len(),
        evaluations: forces,
        wall_ns: Some(wall_ns_of(start.x.len(), |f| {
            system.add_rod_forces(0.0, &start.x, &start.v, f);
        })),
    });
    SceneFacts {
        name: scene.name.clone(),
        file: scene.file.clone(),
        particles: scene.particles.len(),
        objects: scene.bodies.clone(),
        springs: scene.springs.len(),
        rods: scene.rods.len(),
        effects: effects.chain(rods).collect(),
        timestep: scene.solver.timestep,
        duration: scene.duration,
        energy_scale_j: scale,
        description: scene.description.clone(),
        own_integrator: scene.solver.method.clone(),
    }
}

/// The wall time of one evaluation, ns.
fn wall_ns(effect: &dyn Effect, x: &[f64], v: &[f64]) -> f64 {
    wall_ns_of(x.len(), |f| {
        std::hint::black_box(effect.add_force(0.0, x, v, std::hint::black_box(f)));
    })
}

/// The wall time of one call, ns: the least of three batches.
fn wall_ns_of(dim: usize, mut call: impl FnMut(&mut [f64])) -> f64 {
    let mut f = vec![0.0; dim];
    let mut batch = |f: &mut [f64]| {
        let start = Instant::now();
        // Reading the clock takes as long as a small effect; a large one is timed once.
        let (mut calls, mut more) = (0, 1);
        while start.elapsed() < Duration::from_micros(100) {
            for _ in 0..more {
                call(f);
            }
            calls += more;
            more = 16;
        }
        start.elapsed().as_secs_f64() * 1e9 / f64::from(calls)
    };
    (0..3).map(|_| batch(&mut f)).fold(f64::INFINITY, f64::min)
}

/// The facts that reports state about a truth.
pub fn truth(truth: &Truth) -> TruthFacts {
    let known = truth.kind != TruthKind::None;
    TruthFacts {
        kind: truth.kind,
        method: truth.method.clone(),
        error_bound_m: known.then_some(truth.error_bound),
        horizon_s: known.then_some(truth.horizon),
        reason: Some(truth.reason.clone()),
    }
}

/// The skipped check that says why energy errors have no relative size; None where the scene has an energy scale.
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
        ..Check::default()
    })
}
