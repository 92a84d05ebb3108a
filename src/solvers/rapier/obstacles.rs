//! A scene's obstacles as rapier colliders, and a ball for each particle.
//!
//! rapier's contact has a law of its own, which is not ours: it acts once a step, from the velocity at its start, and rests
//! a little inside. Coefficients are the obstacle's (rule Max, those of particles are 0), and a pair is looked at in every
//! step, so that the law does not depend on what was near before (`contact_recycling` off).

use crate::scene::{Collider, Drive, Scene};
use crate::solvers::Unsupported;
use rapier3d::dynamics::{CoefficientCombineRule, RigidBodyBuilder, RigidBodyHandle};
use rapier3d::geometry::{
    ColliderBuilder, Group, InteractionGroups, InteractionTestMode, SharedShape, TriMeshFlags,
};
use rapier3d::math::Vector;
use rapier3d::pipeline::PhysicsWorld;

const PARTICLES: Group = Group::GROUP_1;
const OBSTACLES: Group = Group::GROUP_2;
/// Particles as they collide with each other.
const AMONG: Group = Group::GROUP_3;

/// What balls and planes are made larger by where a particle has no extent, m.
const EXTENT: f64 = 0.1;

/// rapier takes any normal for a centre that is exactly on a surface, as one without extent is that touches it. Such balls
/// get an extent, and planes are moved back by as much, which leaves all gaps as they are.
fn extent(scene: &Scene) -> f64 {
    let mut free = scene.particles.iter().filter(|particle| !particle.fixed);
    let none = free.any(|particle| particle.radius == 0.0);
    if none && solid(scene) { EXTENT } else { 0.0 }
}

/// A half space is solid: nothing passes it.
fn solid(scene: &Scene) -> bool {
    scene.colliders.iter().all(|one| one.plane.is_some())
}

/// Whether rapier's contact has a counterpart of all obstacles of a scene.
///
/// # Errors
/// [`Unsupported`] where it has none.
pub fn takes(scene: &Scene) -> Result<(), Unsupported> {
    let own = |[slides, sticks]: [f64; 2]| sticks > slides;
    let mut each = scene.colliders.iter();
    let reason = if let Some(at) = each.position(|one| own([one.friction, one.static_friction])) {
        format!("colliders[{at}] has a static friction of its own: rapier has one coefficient")
    } else if let Some(contact) = &scene.contact
        && own([contact.friction, contact.static_friction])
    {
        "contact has a static friction of its own: rapier has one coefficient".to_owned()
    } else if scene
        .contact
        .as_ref()
        .is_some_and(|one| one.penalty.is_some())
    {
        "contact has a penalty: rapier's contact has a law of its own".to_owned()
    } else {
        return Ok(());
    };
    Err(Unsupported { reason })
}

/// Adds the colliders of a scene; returns the bodies of obstacles that move.
pub(super) fn add(
    scene: &Scene,
    bodies: &[RigidBodyHandle],
    world: &mut PhysicsWorld,
) -> Result<Vec<(RigidBodyHandle, Drive)>, Unsupported> {
    let mut moved = Vec::new();
    let among = scene.contact.as_ref().filter(|contact| contact.particles);
    if scene.colliders.is_empty() && among.is_none() {
        return Ok(moved);
    }
    takes(scene)?;
    let parameters = &mut world.integration_parameters;
    parameters.contact_recycling = false;
    // Without sweeps after the drift there is hardly any friction.
    let sweeps = parameters.num_internal_stabilization_iterations.max(1);
    parameters.num_internal_stabilization_iterations = sweeps;
    // Continuous detection keeps what is fast from passing shapes, and each other.
    let (solid, extent) = (among.is_none() && solid(scene), extent(scene));
    parameters.max_ccd_substeps = usize::from(!solid);
    for (at, collider) in scene.colliders.iter().enumerate() {
        let Some((shape, place)) = shape(collider, extent) else {
            return Err(Unsupported {
                reason: format!("colliders[{at}] has no shape that rapier takes"),
            });
        };
        let builder = between(ColliderBuilder::new(shape), OBSTACLES, PARTICLES)
            .friction(collider.friction)
            .restitution(collider.restitution);
        let rotation = collider
            .block
            .as_ref()
            .map_or([0.0; 3], |block| block.rotation);
        let displacement = collider.displacement();
        let body = match displacement {
            Some(_) => RigidBodyBuilder::kinematic_position_based(),
            None => RigidBodyBuilder::fixed(),
        };
        let start = displacement
            .as_ref()
            .map_or([0.0; 3], |drive| drive.at(0.0)[0]);
        let body = world.insert_body(body.translation(Vector::from_array(start)));
        let builder = builder
            .translation(place)
            .rotation(Vector::from_array(rotation));
        world.insert_collider(builder, Some(body));
        moved.extend(displacement.map(|drive| (body, drive)));
    }
    let free = scene.particles.iter().zip(bodies);
    for (particle, body) in free.filter(|(particle, _)| !particle.fixed) {
        let ball = ColliderBuilder::new(SharedShape::ball(particle.radius + extent));
        let ball = between(ball, PARTICLES, OBSTACLES)
            .density(0.0)
            .friction(0.0);
        world.insert_collider(ball, Some(*body));
        // Another ball for the others, which has coefficients.
        if let Some(contact) = among {
            let ball = ColliderBuilder::new(SharedShape::ball(particle.radius));
            let ball = between(ball, AMONG, AMONG)
                .density(0.0)
                .friction(contact.friction)
                .restitution(contact.restitution);
            world.insert_collider(ball, Some(*body));
        }
        if let Some(body) = world.bodies.get_mut(*body) {
            body.enable_ccd(!solid);
        }
    }
    Ok(moved)
}

fn between(builder: ColliderBuilder, own: Group, other: Group) -> ColliderBuilder {
    builder
        .collision_groups(InteractionGroups::new(own, other, InteractionTestMode::And))
        .friction_combine_rule(CoefficientCombineRule::Max)
        .restitution_combine_rule(CoefficientCombineRule::Max)
}

/// A shape, and where it is before it moves; planes are moved back.
fn shape(collider: &Collider, back: f64) -> Option<(SharedShape, Vector)> {
    let vector = Vector::from_array;
    if let Some(plane) = &collider.plane {
        let normal = vector(plane.normal);
        return Some((
            SharedShape::halfspace(normal),
            normal * (plane.offset - back),
        ));
    }
    if let Some(ball) = &collider.ball {
        return Some((SharedShape::ball(ball.radius), vector(ball.center)));
    }
    if let Some(block) = &collider.block {
        let [x, y, z] = block.half_extents;
        return Some((SharedShape::cuboid(x, y, z), vector(block.center)));
    }
    if let Some(capsule) = &collider.capsule {
        let shape = SharedShape::capsule(vector(capsule.a), vector(capsule.b), capsule.radius);
        return Some((shape, Vector::ZERO));
    }
    let mesh = collider.mesh.as_ref()?;
    let triangles = mesh.triangles.0.iter();
    let triangles = triangles
        .map(|row| row.map(|vertex| vertex as u32))
        .collect();
    let vertices = mesh.vertices.0.iter().copied().map(vector).collect();
    let flags = TriMeshFlags::FIX_INTERNAL_EDGES;
    let shape = SharedShape::trimesh_with_flags(vertices, triangles, flags).ok()?;
    Some((shape, Vector::ZERO))
}
