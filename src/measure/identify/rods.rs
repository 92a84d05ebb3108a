//! Schemes of scenes with rods: those of a list, and those with a number that the rows tell.

mod fitted;
mod schemes;

pub(super) use fitted::fitted;
pub(super) use schemes::{composed, kept, restabilised};

use super::candidate::Candidate;
use crate::physics::ParticleSystem;
use crate::scene::{Constraints, Particle, Rod, Scene, Stabilisation};

/// Every scheme of rods that some scene may have.
pub(super) fn every() -> Vec<Candidate> {
    let particle = |x: f64, mass| Particle {
        position: [x, 0.0, 0.0],
        mass,
        drag: 1.0,
        ..Particle::default()
    };
    let rod = |a| Rod {
        ends: [a, a + 1],
        length: 1.0,
    };
    let mut scene = Scene {
        particles: vec![particle(0.0, 1.0), particle(1.0, 2.0), particle(2.0, 1.0)],
        rods: vec![rod(0), rod(1)],
        ..Scene::default()
    };
    let mut all = Vec::new();
    for stabilisation in [Stabilisation::Project, Stabilisation::None] {
        scene.constraints = Some(Constraints {
            stabilisation,
            ..Constraints::default()
        });
        let system = ParticleSystem::new(&scene);
        all.extend(restabilised(&scene, &system, 1));
        all.extend(composed(&system));
        all.extend(fitted::named(&scene, &system));
    }
    all
}
