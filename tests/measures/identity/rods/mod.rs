//! Schemes of scenes with rods: own methods at every stabilisation, and programs by formulas of their own.

mod own;
mod written;

use super::*;
use crate::testkit::scenes::parsed;
use springcheck::scene::Stabilisation;

const STABILISATIONS: [(Stabilisation, &str, &str); 3] = [
    (Stabilisation::None, "none", "unstabilised"),
    (Stabilisation::Project, "project", "projected"),
    (Stabilisation::Baumgarte, "baumgarte", "baumgarte"),
];

fn with(body: &str, by: Stabilisation) -> Scene {
    let words = STABILISATIONS
        .iter()
        .find(|(stabilisation, ..)| *stabilisation == by);
    let (_, word, _) = words.expect("a stabilisation");
    parsed(&format!(
        "{body}constraints: {{stabilisation: {word}}}\nduration: 1.0\n"
    ))
}

/// A spherical pendulum away from the origin.
const PENDULUM: &str = "
solver: {type: rk4, timestep: 0.01}
particles:
  - {pos: [0.5, 0.25, 1.5], fixed: true}
  - {pos: [1.25, 0.25, 0.5], vel: [0.8, 1.2, 0.6], mass: 1.3}
rods:
  - {particle_ids: [0, 1]}
";

/// A double pendulum of unequal masses, its arms bent.
const DOUBLE: &str = "
solver: {type: rk4, timestep: 0.005}
particles:
  - {pos: [0, 0, 0], fixed: true}
  - {pos: [0.75, 0, -0.5], vel: [0, 0.7, 0], mass: 2.0}
  - {pos: [0.75, 0.5, 0.25], vel: [0.4, 0.7, 0], mass: 0.5}
rods:
  - {particle_ids: [0, 1]}
  - {particle_ids: [1, 2]}
";

/// Two unequal masses on a rod, thrown with a spin.
const DUMBBELL: &str = "
solver: {type: rk4, timestep: 0.01}
particles:
  - {pos: [0, 0, 2], vel: [1, 0.5, 2], mass: 2.0}
  - {pos: [0.75, 0.5, 2.25], vel: [1, -0.25, 3.5], mass: 0.7}
rods:
  - {particle_ids: [0, 1]}
";
