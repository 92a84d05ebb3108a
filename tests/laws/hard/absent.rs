//! What a scene does not call for, or what could do nothing, is not built.

use super::scene;
use springcheck::physics::ParticleSystem;
use springcheck::scene::Scene;

/// Effects that were built, and how many members each has.
fn built(scene: &Scene) -> Vec<(&'static str, usize)> {
    let system = ParticleSystem::new(scene);
    let effects = system.effects().iter();
    effects.map(|(row, e)| (row.id, e.members())).collect()
}

#[test]
fn a_free_body_has_no_effect() {
    let mut scene = scene("free_body");
    assert_eq!(built(&scene), []);
    scene.solver.gravity = -9.81;
    assert_eq!(built(&scene), [("gravity", 1)]);
}

#[test]
fn springs_between_fixed_ends_are_left_out() {
    let mut scene = scene("one_free");
    assert_eq!(scene.springs.len(), 10);
    assert_eq!(built(&scene), [("gravity", 1), ("springs", 8)]);
    scene.particles[0].fixed = false;
    assert_eq!(built(&scene), [("gravity", 2), ("springs", 9)]);
}
