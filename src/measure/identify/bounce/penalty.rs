//! Contact by penalty with a law of the program's own.

use super::{Bounce, Way};
use crate::physics::effects::{Penalty, PenaltyLaw};
use crate::physics::{ParticleSystem, System};
use crate::scene::Scene;

/// The scene with such forces in the place of impacts; None where the treatment has none.
pub(in super::super) fn pressed(
    scene: &Scene,
    system: &ParticleSystem,
    bounce: &Bounce,
) -> Option<ParticleSystem> {
    let Way::Force { pulls, .. } = bounce.way.does else {
        return None;
    };
    let [stiffness, damping] = bounce.force;
    let law = PenaltyLaw {
        stiffness,
        damping,
        pulls,
        rubs: bounce.rubs(),
    };
    let sized = bounce.met_by(system);
    let obstacles = sized.obstacles()?;
    let pressed = ParticleSystem::with(scene, &|row| match row.id {
        "penalty" => Some(Box::new(Penalty::with(obstacles.copied(), law)) as _),
        _ => (row.build)(scene),
    });
    let free = pressed.with_rods(|_| None).limited_as(|_| None);
    Some(free.with_obstacles(|_| None))
}
