//! An effect the scene does not call for is not built and cannot be called.

use crate::testkit::cloth::cloth;
use springcheck::physics::ParticleSystem;
use springcheck::physics::effects::{EffectRow, REGISTRY};
use springcheck::scene::model::Plane;
use springcheck::scene::{
    Air, Bending, Collider, Contact, DampingModel, Driven, GravitationalPair, Magnetic, Penalty,
    Scene, Triangle, Wind,
};
use springcheck::solvers::{self, Setting};

/// The ids of what a system has to call.
fn called(scene: &Scene) -> Vec<&'static str> {
    let system = ParticleSystem::new(scene);
    system.effects().iter().map(|(row, _)| row.id).collect()
}

/// What makes a scene call for one more effect.
type Call = fn(&mut Scene);

/// What the scene calls for one by one, each on top of gravity and springs.
const CALLS: [(&str, Call); 10] = [
    ("cubic_springs", |scene| scene.springs[0].cubic = 1.0),
    ("drag", |scene| scene.particles[1].drag = 0.1),
    ("quadratic_drag", |scene| {
        scene.particles[1].quadratic_drag = 0.1;
    }),
    ("air_drag", |scene| {
        scene.air = Some(Air {
            density: 1.2,
            ..Air::default()
        });
        scene.triangles.push(Triangle {
            corners: [0, 1, 4],
            air_drag: 1.0,
        });
    }),
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
    ("driven", |scene| {
        let held = scene.particles.iter().position(|p| p.fixed);
        scene.driven.push(Driven {
            particle: held.expect("a corner"),
            velocity: Some([1.0, 0.0, 0.0]),
            ..Driven::default()
        });
    }),
    ("bending", |scene| {
        scene.bending.push(Bending {
            stiffness: 1.0,
            ..Bending::default()
        });
    }),
    ("penalty", |scene| {
        scene.colliders = vec![Collider {
            plane: Some(Plane::default()),
            ..Collider::default()
        }];
        scene.contact = Some(Contact {
            penalty: Some(Penalty::default()),
            ..Contact::default()
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

/// What each rapier world of a scene consists of: bodies and joints.
fn built(scene: &Scene, engine: &str) -> [u64; 2] {
    let solver = solvers::find(engine).expect("an engine");
    let timestep = scene.solver.timestep;
    let setting = Setting::Steps { timestep, steps: 1 };
    let system = ParticleSystem::new(scene);
    let run = solver.start(scene, &system, &setting).expect("a run");
    let world = run.counts().world.expect("a world");
    [world.bodies, world.joints]
}

#[test]
fn rapiers_world_has_a_body_a_particle_and_a_joint_only_where_the_scene_calls_for_one() {
    let mut scene = cloth(3, 0.0, DampingModel::Axial);
    let springs = scene.springs.len() as u64;
    // Springs between fixed ends could do nothing.
    let held =
        |s: &&springcheck::scene::Spring| s.ends.iter().all(|end| scene.particles[*end].fixed);
    let idle = scene.springs.iter().filter(held).count() as u64;
    assert_eq!(built(&scene, "rapier"), [9, springs - idle]);
    // Forces from outside need no joints at all.
    assert_eq!(built(&scene, "rapier-forces"), [9, 0]);
    // Drag is a joint to the air, which is one more body.
    let free = scene.particles.iter().filter(|p| !p.fixed).count() as u64;
    scene.particles.iter_mut().for_each(|p| p.drag = 0.1);
    assert_eq!(built(&scene, "rapier"), [10, springs - idle + free]);
    scene.springs.clear();
    assert_eq!(built(&scene, "rapier"), [10, free]);
    scene.particles.iter_mut().for_each(|p| p.drag = 0.0);
    assert_eq!(built(&scene, "rapier"), [9, 0]);
}
