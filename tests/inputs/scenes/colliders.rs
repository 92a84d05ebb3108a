//! Obstacles in scene files: what they default to, and what is refused at its place.

use super::{Row, complete, parse};

/// As the rows of `refused.rs`.
#[rustfmt::skip]
pub const REFUSED: &[Row] = &[
    ("colliders, no list", "colliders: »3", &["colliders", "expected a list, found the number `3`"]),
    ("collider of no shape", "colliders: [»{friction: 1}]", &["colliders[0]", "expected one of `plane`, `ball`, `box`, `capsule` and `mesh`, found none"]),
    ("collider of two shapes", "colliders:\n- »plane: {normal: [0, 0, 1], offset: -9}\n  ball: {center: [0, 0, -9], radius: 1}", &["colliders[0]", "found plane and ball"]),
    ("collider of an unknown shape", "colliders: [{»plain: {normal: [0, 0, 1]}}]", &["colliders[0]", "unknown key `plain`", "the keys here are plane, ball, box"]),
    ("plane without normal", "colliders: [{plane: »{offset: 0}}]", &["colliders[0].plane.normal", "missing", "say which side is free"]),
    ("plane with a normal of 0", "colliders: [{plane: {normal: »[0, 0, 0]}}]", &["colliders[0].plane.normal", "a vector of length 0"]),
    ("plane with a normal of NaN", "colliders: [{plane: {normal: [0, 0, ».nan]}}]", &["colliders[0].plane.normal", "finite number"]),
    ("ball without radius", "colliders: [{ball: »{center: [0, 0, -9]}}]", &["colliders[0].ball.radius", "missing"]),
    ("ball of radius 0", "colliders: [{ball: {center: [0, 0, -9], radius: »0}}]", &["colliders[0].ball.radius", "expected a positive number (m), found 0"]),
    ("box of no height", "colliders:\n- box: {center: [0, 0, -9], half_extents: [1, 1, »0]}", &["colliders[0].box.half_extents", "expected a positive number (m), found 0"]),
    ("box turned by degrees", "colliders:\n- box: {center: [0, 0, -9], half_extents: [1, 1, 1], rotation: [0, 0, »45]}", &["colliders[0].box.rotation", "at most 6.28", "(rad), found 45"]),
    ("capsule of one point", "colliders:\n- capsule: {a: [0, 0, -9], b: »[0, 0, -9], radius: 1}", &["colliders[0].capsule.b", "two ends apart", "`ball: {center, radius}`"]),
    ("mesh without triangles", "colliders:\n- mesh: {vertices: [[0, 0, -9], [1, 0, -9], [0, 1, -9]], triangles: »[]}", &["colliders[0].mesh.triangles", "expected a row or more, found 0"]),
    ("mesh of two vertices", "colliders:\n- mesh: {vertices: »[[0, 0, -9], [1, 0, -9]], triangles: [[0, 1, 1]]}", &["colliders[0].mesh.vertices", "expected three rows or more, found 2"]),
    ("mesh with a vertex that is not there", "colliders:\n- mesh:\n    vertices: [[0, 0, -9], [1, 0, -9], [0, 1, -9]]\n    triangles: [»[0, 1, 3]]", &["colliders[0].mesh.triangles[0]", "a vertex from 0 to 2, found 3"]),
    ("mesh with half a vertex", "colliders:\n- mesh:\n    vertices: [[0, 0, -9], [1, 0, -9], [0, 1, -9]]\n    triangles: [»[0, 1, 0.5]]", &["colliders[0].mesh.triangles[0]", "a vertex from 0 to 2, found 0.5"]),
    ("mesh with a triangle of no area", "colliders:\n- mesh:\n    vertices: [[0, 0, -9], [1, 0, -9], [2, 0, -9]]\n    triangles: [»[0, 1, 2]]", &["colliders[0].mesh.triangles[0]", "three corners apart, found them on one line"]),
    ("mesh with a vertex of NaN", "colliders:\n- mesh:\n    vertices: [[0, 0, ».nan], [1, 0, -9], [0, 1, -9]]\n    triangles: [[0, 1, 2]]", &["colliders[0].mesh.vertices", "finite number"]),
    ("restitution above 1", "colliders:\n- plane: {normal: [0, 0, 1], offset: -9}\n  restitution: »1.1", &["colliders[0].restitution", "at most 1"]),
    ("restitution below 0", "colliders:\n- plane: {normal: [0, 0, 1], offset: -9}\n  restitution: »-0.1", &["colliders[0].restitution", "at least 0"]),
    ("friction below 0", "colliders:\n- plane: {normal: [0, 0, 1], offset: -9}\n  friction: »-0.1", &["colliders[0].friction", "at least 0"]),
    ("static friction below the other", "colliders:\n- plane: {normal: [0, 0, 1], offset: -9}\n  friction: 0.5\n  static_friction: »0.4", &["colliders[0].static_friction", "at least the friction (0.5), found 0.4"]),
    ("collider with two motions", "colliders:\n- plane: {normal: [0, 0, 1], offset: -9}\n  driven: »{velocity: [1, 0, 0], sine: {amplitude: [1, 0, 0], omega: 1}}", &["colliders[0].driven", "found sine and velocity"]),
    ("collider with no motion", "colliders:\n- plane: {normal: [0, 0, 1], offset: -9}\n  driven: »{}", &["colliders[0].driven", "expected one of `sine`, `velocity` and `table`, found none"]),
    ("particle inside a plane", "particles:\n- {pos: [0, 0, 0.05], mass: 1}\ncolliders:\n- »plane: {normal: [0, 0, 1]}", &["colliders[0]", "expected every free particle outside, found 0 0.05 m inside", "a ball of radius 0.1 m"]),
    ("particle inside a ball", "particles:\n- {pos: [0, 0, 0], mass: 1}\ncolliders:\n- »ball: {center: [0, 0, 0], radius: 1}", &["colliders[0]", "found 0 1.1 m inside"]),
    ("restitution beside a penalty", "colliders:\n- plane: {normal: [0, 0, 1], offset: -9}\n  restitution: »0.5\ncontact: {penalty: {stiffness: 1}}", &["colliders[0].restitution", "expected 0 beside `contact.penalty`, found 0.5", "takes the place of restitution"]),
    ("friction beside a penalty", "colliders:\n- plane: {normal: [0, 0, 1], offset: -9}\n  friction: »0.5\ncontact: {penalty: {stiffness: 1}}", &["colliders[0].friction", "expected 0 beside `contact.penalty`, found 0.5"]),
    ("static friction beside a penalty", "colliders:\n- plane: {normal: [0, 0, 1], offset: -9}\n  static_friction: »0.5\ncontact: {penalty: {stiffness: 1}}", &["colliders[0].static_friction", "expected 0 beside `contact.penalty`, found 0.5"]),
    ("restitution of particles beside their penalty", "particles: [{pos: [0, 0, 1], mass: 1}, {pos: [0, 0, 0], mass: 1}]\ncontact: {particles: true, restitution: »0.5, penalty: {stiffness: 1}}", &["contact.restitution", "expected 0 beside `contact.penalty`, found 0.5"]),
    ("friction of particles beside their penalty", "particles: [{pos: [0, 0, 1], mass: 1}, {pos: [0, 0, 0], mass: 1}]\ncontact: {particles: true, friction: »0.5, penalty: {stiffness: 1}}", &["contact.friction", "expected 0 beside `contact.penalty`, found 0.5"]),
    ("penalty without stiffness", "particles: [{pos: [0, 0, 1], mass: 1}, {pos: [0, 0, 0], mass: 1}]\ncontact: {particles: true, penalty: »{damping: 1}}", &["penalty.stiffness", "missing"]),
    ("colliders beside a driven rod", "particles: [{pos: [0, 0, 1], fixed: true}, {pos: [0, 0, 0], mass: 1}]
rods: [{particle_ids: [0, 1]}]
driven: [{particle_id: 0, velocity: [1, 0, 0]}]
colliders: »[{plane: {normal: [0, 0, 1], offset: -9}}]", &["colliders", "not supported yet beside rods with a driven end"]),
    ("contact of nothing", "contact: »{}", &["contact", "expected something to say of contact, found nothing"]),
    ("contact, no mapping", "contact: »3", &["contact", "expected a mapping such as {particles: true, restitution: 0.5}, found the number `3`"]),
    ("restitution of particles that do not collide", "contact: {restitution: »0.5}", &["contact.restitution", "expected `particles: true`"]),
    ("restitution of particles above 1", "particles: [{pos: [0, 0, 1], mass: 1}, {pos: [0, 0, 0], mass: 1}]\ncontact: {particles: true, restitution: »1.5}", &["contact.restitution", "at most 1"]),
    ("static friction of particles below the other", "particles: [{pos: [0, 0, 1], mass: 1}, {pos: [0, 0, 0], mass: 1}]\ncontact: {particles: true, friction: 0.5, static_friction: »0.4}", &["contact.static_friction", "at least the friction (0.5), found 0.4"]),
    ("particles inside each other", "particles: [{pos: [0, 0, 0], mass: 1}, {pos: [0, 0.15, 0], mass: 1}]
contact: {particles: »true}", &["contact.particles", "expected free particles apart, found 0 and 1 0.05 m inside each other"]),
    ("points that shall collide", "particles: [{pos: [0, 0, 0], mass: 1, radius: 0}, {pos: [0, 1, 0], mass: 1, radius: 0}]
contact: {particles: »true}", &["contact.particles", "expected free particles with a radius, found none", "two points never meet"]),
    ("particles in one place", "particles: [{pos: [0, 0, 0], mass: 1, radius: 0}, {pos: [0, 0, 0], mass: 1, radius: 0}, {pos: [0, 1, 0], mass: 1}]
contact: {particles: »true}", &["contact.particles", "expected free particles apart, found 0 and 1 in one place"]),
    ("particles in one place beside a penalty", "particles: [{pos: [0, 0, 0], mass: 1}, {pos: [0, 0, 0], mass: 1}]
contact: {particles: »true, penalty: {stiffness: 1}}", &["contact.particles", "found 0 and 1 in one place"]),
];

/// A normal is made a unit vector; static friction is sliding friction; nothing bounces or rubs unless a file says so.
#[test]
fn colliders_have_defaults() {
    let one = |more: &str| {
        let scene = parse(&complete(&format!(
            "colliders: [{{plane: {{normal: [0, 3, 4], offset: -9}}{more}}}]"
        )));
        scene.unwrap().colliders.remove(0)
    };
    let plain = one("");
    let plane = plain.plane.as_ref().unwrap();
    assert_eq!((plane.normal, plane.offset), ([0.0, 0.6, 0.8], -9.0));
    assert_eq!(
        [plain.restitution, plain.friction, plain.static_friction],
        [0.0; 3]
    );
    assert_eq!(one(", friction: 0.3").static_friction, 0.3);
    assert_eq!(
        one(", friction: 0.3, static_friction: 0.4").static_friction,
        0.4
    );
}

/// A gap of 0 is touching, and so is one that ten digits round below it.
#[test]
fn what_touches_is_not_inside() {
    for z in ["0.1", "0.09999999995"] {
        let scene = format!(
            "particles:\n- {{pos: [0, 0, {z}], mass: 1}}\ncolliders: [{{plane: {{normal: [0, 0, 1]}}}}]"
        );
        assert!(parse(&complete(&scene)).is_ok(), "{z}");
    }
}

/// A penalty presses what is inside, also at the start.
#[test]
fn with_a_penalty_particles_may_start_inside() {
    let scene = "particles:\n- {pos: [0, 0, 0.05], mass: 1}\n- {pos: [0, 0.1, 0.05], mass: 1}\n\
                 colliders: [{plane: {normal: [0, 0, 1]}}]\ncontact: {particles: true";
    assert!(parse(&complete(&format!("{scene}, penalty: {{stiffness: 1}}}}"))).is_ok());
    assert!(parse(&complete(&format!("{scene}}}"))).is_err());
}

/// Whatever is fixed, and whichever obstacle has no bounds.
#[test]
fn few_that_collide_may_have_any_number() {
    let scene = "particles:\n- {pos: [9, 0, 0.5], fixed: true}\n- {pos: [0, 0, 0.5], mass: 1}\n\
                 colliders: [{plane: {normal: [0, 0, 1]}}, {ball: {center: [0, 0, -9], radius: 1}}]\n\
                 contact: {particles: true}";
    let scene = parse(&complete(scene)).expect("a scene");
    let obstacles = springcheck::physics::constraints::contact::Obstacles::new(&scene);
    let obstacles = obstacles.expect("obstacles");
    let near = obstacles.near([0.0; 2], |particle| {
        (scene.particles[particle].position, 99.0)
    });
    assert_eq!(near.pairs().count(), 2);
}
