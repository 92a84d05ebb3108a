//! The energy scale S that errors are relative to.

use crate::scene::Scene;
use crate::system::{ParticleSystem, System};

/// S in joules: K(0) + U_elastic(0); if that is 0, the sum over free particles of m |g| L, with L
/// the scene's size. None if all of these are 0.
///
/// Not the total energy, which depends on where gravity's zero is.
pub fn energy_scale(scene: &Scene, system: &ParticleSystem) -> Option<f64> {
    let start = ParticleSystem::initial_state(scene);
    let own = system.kinetic(&start.v) + system.elastic(0.0, &start.x);
    // Rest lengths computed from positions leave rounding, not energy.
    let rounding = elastic_rounding(scene);
    if own > rounding {
        return Some(own);
    }
    let weight: f64 = scene
        .particles
        .iter()
        .filter(|p| !p.fixed)
        .map(|p| p.mass * scene.solver.gravity.abs())
        .sum();
    let scale = weight * scene.size();
    (scale > 0.0).then_some(scale)
}

/// Elastic energy of all springs when each is off its rest length by a few last bits.
fn elastic_rounding(scene: &Scene) -> f64 {
    let off = |s: &crate::scene::Spring| {
        let stretch = 8.0 * f64::EPSILON * s.rest_length;
        0.5 * s.stiffness * stretch * stretch
    };
    scene.springs.iter().map(off).sum()
}
