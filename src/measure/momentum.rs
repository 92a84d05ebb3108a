//! Linear and angular momentum where the scene conserves them.

use crate::physics::{ParticleSystem, System};
use crate::scene::Scene;
use crate::trajectory::Trajectory;
use crate::truth::farthest;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Largest departure from the initial value; null where the scene does not conserve it.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
pub struct Momentum {
    /// Of the total momentum, kg m/s; null where the scene does not keep it.
    #[serde(rename = "linear_error_max_kg_m_s")]
    pub linear_error_max: Option<f64>,
    /// Of the total angular momentum about the origin, kg m²/s; null where the scene does not keep it.
    #[serde(rename = "angular_error_max_kg_m2_s")]
    pub angular_error_max: Option<f64>,
}

/// Largest departures from the initial values over the recorded instants; each None where
/// something is fixed or an effect does not keep it. None where velocities are not known.
pub fn momentum(scene: &Scene, system: &ParticleSystem, run: &Trajectory) -> Option<Momentum> {
    // Obstacles push, as what is fixed does.
    let free = scene.particles.iter().all(|p| !p.fixed) && scene.colliders.is_empty();
    let keeps = |keeps: fn(&dyn crate::physics::effects::Effect) -> bool| {
        free && system.effects().iter().all(|(_, e)| keeps(e.as_ref()))
    };
    let linear = keeps(|e| e.keeps_momentum());
    // A strain limit moves the ends of what turns.
    let turns = system.strain_limiter().is_none();
    let angular = turns && keeps(|e| e.keeps_angular_momentum());
    if run.is_empty() || !run.has_velocities() || !(linear || angular) {
        return None;
    }
    let totals = |k: usize| totals(scene, run.x(k), run.v(k));
    let start = totals(0);
    let (mut linear_error, mut angular_error) = (0.0_f64, 0.0_f64);
    for k in 1..run.len() {
        let now = totals(k);
        linear_error = linear_error.max(farthest(&now.0, &start.0));
        angular_error = angular_error.max(farthest(&now.1, &start.1));
    }
    Some(Momentum {
        linear_error_max: (linear && linear_error.is_finite()).then_some(linear_error),
        angular_error_max: (angular && angular_error.is_finite()).then_some(angular_error),
    })
}

/// Momentum, kg m/s, and angular momentum about the origin, kg m²/s.
pub(crate) fn totals(scene: &Scene, x: &[f64], v: &[f64]) -> ([f64; 3], [f64; 3]) {
    let (mut p, mut l) = ([0.0; 3], [0.0; 3]);
    let states = x.chunks_exact(3).zip(v.chunks_exact(3));
    for (particle, (x, v)) in scene.particles.iter().zip(states) {
        let m = particle.mass;
        for a in 0..3 {
            let (b, c) = ((a + 1) % 3, (a + 2) % 3);
            p[a] += m * v[a];
            l[a] += m * (x[b] * v[c] - x[c] * v[b]);
        }
    }
    (p, l)
}
