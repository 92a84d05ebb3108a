//! The energy scale S that errors are relative to.

use crate::physics::constraints::contact::Obstacles;
use crate::physics::{ParticleSystem, System};
use crate::scene::{Scene, Spring};

/// S in joules: the larger of K(0) + U_elastic(0) and `peak`, the largest kinetic energy of the
/// truth where one is known; if both are 0, the sum over free particles of m |g| L, with L the
/// scene's size, its obstacles included. None if all of these are 0.
///
/// Not the total energy, which depends on where gravity's zero is.
pub fn energy_scale(scene: &Scene, system: &ParticleSystem, peak: Option<f64>) -> Option<f64> {
    let start = ParticleSystem::initial_state(scene);
    let own = system.kinetic(&start.v) + system.elastic(0.0, &start.x);
    // Rest lengths computed from positions leave rounding, not energy.
    let own = Some(own).filter(|own| *own > elastic_rounding(scene));
    let weight: f64 = scene
        .particles
        .iter()
        .filter(|p| !p.fixed)
        .map(|p| p.mass * gravity(scene))
        .sum();
    let size = system.obstacles().map_or(0.0, Obstacles::size);
    let rest = weight * scene.size().max(size);
    // A truth that stands still leaves only rounding, too.
    let peak = peak.filter(|peak| *peak > f64::EPSILON * rest && peak.is_finite());
    let moving = own.unwrap_or(0.0).max(peak.unwrap_or(0.0));
    let scale = if moving > 0.0 { moving } else { rest };
    (scale > 0.0).then_some(scale)
}

/// The energy K + U_elastic beyond which a run counts as diverged, joules: 1e12 `scale`, or as much of the kinetic
/// energy that all would have at the speed of what is driven; and never less than a thousand times what a free fall for
/// the whole duration gains, which is motion however small the scale. None without any of them.
pub fn divergence_limit(scene: &Scene, scale: Option<f64>) -> Option<f64> {
    let fall = free_fall(scene) * scene.duration * scene.duration;
    let drives = scene.drives();
    let obstacles = scene.colliders.iter().filter_map(|one| one.displacement());
    let all = drives.into_iter().chain(obstacles);
    let fastest = all.map(|drive| drive.speed_bound(scene.duration));
    let speed = fastest.fold(0.0, f64::max);
    let free = scene.particles.iter().filter(|p| !p.fixed);
    let driven = 0.5 * free.map(|p| p.mass).sum::<f64>() * speed * speed;
    let limit = (1e12 * scale.unwrap_or(0.0).max(driven)).max(1e3 * fall);
    (limit > 0.0 && limit.is_finite()).then_some(limit)
}

/// The size of gravity, m/s²; exact along an axis.
pub(crate) fn gravity(scene: &Scene) -> f64 {
    let [x, y, z] = scene.gravity();
    x.hypot(y).hypot(z)
}

/// The energy gravity, wind and the drag of moving air at rest give the free particles in t seconds, over t², J/s².
pub(super) fn free_fall(scene: &Scene) -> f64 {
    let wind = scene.wind.as_ref().map_or(0.0, |wind| wind.strength.abs());
    let [x, y, z] = scene.air().velocity;
    let air = x.hypot(y).hypot(z);
    let free = scene.particles.iter().filter(|p| !p.fixed);
    let fall = free.map(|p| {
        let blown = (p.drag.abs() + p.quadratic_drag.abs() * air) * air;
        let a = gravity(scene) + (wind + blown) / p.mass;
        0.5 * p.mass * a * a
    });
    fall.sum()
}

/// Elastic energy of all springs when each is off its rest length by a few last bits of that or of its
/// ends' coordinates, which are larger far from the origin.
fn elastic_rounding(scene: &Scene) -> f64 {
    let reach = |s: &Spring| {
        let ends = s.ends.iter().filter_map(|end| scene.particles.get(*end));
        let coordinates = ends.flat_map(|p| p.position);
        coordinates.fold(s.rest_length, |most, c| most.max(c.abs()))
    };
    let off = |s: &Spring| {
        let stretch = 8.0 * f64::EPSILON * reach(s);
        0.5 * s.stiffness * stretch * stretch
    };
    scene.springs.iter().map(off).sum()
}
