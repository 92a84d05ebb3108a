//! Scenes computed wrongly: forces or masses that are not the scene's. None where it makes no
//! difference.

use crate::physics::constraints::StrainLimiter;
use crate::physics::{ParticleSystem, System};
use crate::scene::{DampingModel, Drive, Scene, Vectors, Wind};

/// The scene changed by `change`, if `there` is something to change.
fn changed(scene: &Scene, there: bool, change: impl FnOnce(&mut Scene)) -> Option<ParticleSystem> {
    there.then(|| {
        let mut wrong = scene.clone();
        change(&mut wrong);
        ParticleSystem::new(&wrong)
    })
}

/// Driven particles that stay where they are fixed.
pub(super) fn drive_forgotten(scene: &Scene) -> Option<ParticleSystem> {
    driven(scene, |drive| drive.times(0.0))
}

/// Driven particles that move, and are at rest for dampers.
pub(super) fn drive_at_rest(scene: &Scene) -> Option<ParticleSystem> {
    let driven_end = |end: &usize| scene.driven.iter().any(|d| d.particle == *end);
    let damped = scene.springs.iter().filter(|s| s.damping != 0.0);
    let ends = damped.flat_map(|spring| &spring.ends).any(driven_end);
    driven(scene, Drive::still).filter(|_| ends)
}

/// Driven particles that forces see a step late.
pub(super) fn drive_late(scene: &Scene) -> Option<ParticleSystem> {
    driven(scene, |drive| drive.late(scene.solver.timestep))
}

/// Driven particles that forces see a step ahead.
pub(super) fn drive_early(scene: &Scene) -> Option<ParticleSystem> {
    driven(scene, |drive| drive.late(-scene.solver.timestep))
}

/// Tables passed straight from row to row.
pub(super) fn drive_unbent(scene: &Scene) -> Option<ParticleSystem> {
    let table = scene.driven.iter().any(|driven| driven.table.is_some());
    driven(scene, Drive::unbent).filter(|_| table)
}

fn driven(scene: &Scene, change: impl Fn(&Drive) -> Drive) -> Option<ParticleSystem> {
    (!scene.driven.is_empty()).then(|| ParticleSystem::new(scene).driven_as(change))
}

pub(super) fn strain_limit_forgotten(scene: &Scene) -> Option<ParticleSystem> {
    limited(scene, |_| None)
}

/// Springs are shortened, and go on stretching at the speed they had.
pub(super) fn strain_limit_of_positions(scene: &Scene) -> Option<ParticleSystem> {
    limited(scene, |limiter| Some(limiter.of_positions()))
}

/// Free ends move by half each, whatever their masses.
pub(super) fn strain_limit_by_halves(scene: &Scene) -> Option<ParticleSystem> {
    limited(scene, |limiter| Some(limiter.with_unit_masses()))
}

/// None where the limit is no other.
fn limited(
    scene: &Scene,
    change: fn(&StrainLimiter) -> Option<StrainLimiter>,
) -> Option<ParticleSystem> {
    let right = ParticleSystem::new(scene);
    let limiter = right.strain_limiter()?.clone();
    (change(&limiter).as_ref() != Some(&limiter)).then(|| right.limited_as(change))
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

/// No rods.
pub(super) fn rods_forgotten(scene: &Scene) -> Option<ParticleSystem> {
    changed(scene, !scene.rods.is_empty(), |wrong| wrong.rods.clear())
}

/// Tensions that turn no rod: without their part |u|²/l.
pub(super) fn turning_forgotten(scene: &Scene) -> Option<ParticleSystem> {
    let rods = !scene.rods.is_empty();
    rods.then(|| ParticleSystem::new(scene).with_rods(|rods| Some(rods.without_turning())))
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
