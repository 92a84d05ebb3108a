//! Scenes computed wrongly: forces or masses that are not the scene's. None where it makes no
//! difference.

use crate::physics::ParticleSystem;
use crate::scene::{DampingModel, Scene, Vectors, Wind};

/// The scene changed by `change`, if `there` is something to change.
fn changed(scene: &Scene, there: bool, change: impl FnOnce(&mut Scene)) -> Option<ParticleSystem> {
    there.then(|| {
        let mut wrong = scene.clone();
        change(&mut wrong);
        ParticleSystem::new(&wrong)
    })
}

/// The same g newtons on every particle: what a wind would do.
pub(super) fn gravity_without_mass(scene: &Scene) -> Option<ParticleSystem> {
    changed(scene, falls(scene) && weighs(scene), |wrong| {
        let mut force = match &scene.wind {
            Some(wind) => wind.direction.map(|d| d * wind.strength),
            None => [0.0; 3],
        };
        for (force, g) in force.iter_mut().zip(scene.gravity()) {
            *force += g;
        }
        wrong.solver.gravity = 0.0;
        wrong.solver.gravities = Vectors::default();
        wrong.wind = Some(Wind {
            direction: force,
            strength: 1.0,
        });
    })
}

pub(super) fn damping_isotropic(scene: &Scene) -> Option<ParticleSystem> {
    model(scene, DampingModel::Isotropic)
}

pub(super) fn damping_axial(scene: &Scene) -> Option<ParticleSystem> {
    model(scene, DampingModel::Axial)
}

fn model(scene: &Scene, model: DampingModel) -> Option<ParticleSystem> {
    let there = has_dampers(scene) && scene.damping_model != model;
    changed(scene, there, |wrong| wrong.damping_model = model)
}

/// Forces undivided, but gravity the acceleration it is.
pub(super) fn mass_ignored(scene: &Scene) -> Option<ParticleSystem> {
    changed(scene, weighs(scene), |wrong| {
        for pair in &mut wrong.gravitational {
            // The attraction itself stays G m1 m2.
            let [a, b] = pair.ends.map(|end| scene.particles[end].mass);
            pair.g *= a * b;
        }
        for particle in &mut wrong.particles {
            particle.mass = 1.0;
        }
    })
}

/// Forces undivided, weight among them. Without gravity this is `mass_ignored`.
pub(super) fn force_as_acceleration(scene: &Scene) -> Option<ParticleSystem> {
    (falls(scene) && weighs(scene)).then(|| ParticleSystem::new(scene).with_unit_masses())
}

fn falls(scene: &Scene) -> bool {
    scene.gravity() != [0.0; 3]
}

/// Whether some free particle's mass is not 1.
fn weighs(scene: &Scene) -> bool {
    scene.particles.iter().any(|p| !p.fixed && p.mass != 1.0)
}

fn has_dampers(scene: &Scene) -> bool {
    scene.springs.iter().any(|s| s.damping != 0.0)
}
