//! An effect the scene does not call for is not built and cannot be called.

use crate::testkit::cloth::cloth;
use springcheck::physics::ParticleSystem;
use springcheck::physics::effects::{EffectRow, REGISTRY};
use springcheck::scene::{Bending, DampingModel, GravitationalPair, Magnetic, Scene, Wind};

/// The ids of what a system has to call.
fn called(scene: &Scene) -> Vec<&'static str> {
    let system = ParticleSystem::new(scene);
    system.effects().iter().map(|(row, _)| row.id).collect()
}

/// What makes a scene call for one more effect.
type Call = fn(&mut Scene);

/// What the scene calls for one by one, each on top of gravity and springs.
const CALLS: [(&str, Call); 6] = [
    ("cubic_springs", |scene| scene.springs[0].cubic = 1.0),
    ("drag", |scene| scene.particles[1].drag = 0.1),
    ("wind", |scene| {
        scene.wind = Some(Wind {
            direction: [1.0, 0.0, 0.0],
            strength: 1.0,
        });
    }),
    ("gravitational", |scene| {
        scene.gravitational.push(GravitationalPair {
            ends: [0, 1],
            g: 1.0,
        });
    }),
    ("bending", |scene| {
        scene.bending.push(Bending {
            stiffness: 1.0,
            ..Bending::default()
        });
    }),
    ("magnetic", |scene| {
        scene.particles[1].charge = 1.0;
        scene.magnetic = Some(Magnetic {
            field: [0.0, 0.0, 1.0],
        });
    }),
];

#[test]
fn what_a_scene_does_not_call_for_is_never_called() {
    let plain = cloth(4, 0.0, DampingModel::Axial);
    assert_eq!(called(&plain), ["gravity", "springs"]);
    let built = |row: &EffectRow| (row.build)(&plain).is_some();
    for row in REGISTRY {
        assert_eq!(built(row), called(&plain).contains(&row.id), "{}", row.id);
    }
    // The check sees what is called for: each call brings its effect and no other.
    for (id, call) in CALLS {
        let mut scene = plain.clone();
        call(&mut scene);
        let mut with: Vec<_> = called(&scene);
        with.retain(|other| !["gravity", "springs"].contains(other));
        assert_eq!(with, [id]);
    }
    assert_eq!(
        CALLS.len() + 2,
        REGISTRY.len(),
        "an effect nobody calls for"
    );
    let mut weightless = plain.clone();
    weightless.solver.gravity = 0.0;
    assert_eq!(called(&weightless), ["springs"]);
}
