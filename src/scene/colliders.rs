//! Checks of obstacles: each is one shape that has a surface, and no particle starts inside of what gives impulses.

use super::drive::{Drive, motion};
use super::error::Refusal;
use super::model::{Collider, Particle, Scene};
use super::object::called;
use super::place::Problem;
use super::vectors::normalise;
use crate::shape::{Core, Shape};
use parry3d::bounding_volume::Aabb;
use parry3d::math::Vector;
use parry3d::partitioning::{Bvh, BvhBuildStrategy};
use parry3d::shape::Segment;
use std::collections::HashSet;

/// How far a start may be inside an obstacle and count as touching: of the largest number that goes into its distance.
/// Numbers of a file often have ten digits.
pub const TOUCHING: f64 = 1e-9;

impl Collider {
    /// Its shapes, without its motion: one, or the triangles of a mesh; none where the entry says none.
    pub fn shapes(&self) -> Vec<Shape> {
        let Some(mesh) = &self.mesh else {
            return self.shape().into_iter().collect();
        };
        let corner = |vertex: f64| mesh.vertices.0[vertex as usize];
        let triangles = mesh.triangles.0.iter();
        triangles
            .map(|row| Shape::triangle(row.map(corner)))
            .collect()
    }

    fn shape(&self) -> Option<Shape> {
        if let Some(plane) = &self.plane {
            return Some(Shape::Plane {
                normal: plane.normal,
                offset: plane.offset,
            });
        }
        if let Some(ball) = &self.ball {
            return Some(Shape::Round {
                core: Core::Point(Vector::from(ball.center)),
                radius: ball.radius,
            });
        }
        if let Some(block) = &self.block {
            return Some(Shape::block(
                block.center,
                block.half_extents,
                block.rotation,
            ));
        }
        if let Some(capsule) = &self.capsule {
            let [a, b] = [capsule.a, capsule.b].map(Vector::from);
            return Some(Shape::Round {
                core: Core::Segment(Segment::new(a, b)),
                radius: capsule.radius,
            });
        }
        None
    }

    /// Its displacement over time; None where it stays.
    pub fn displacement(&self) -> Option<Drive> {
        Drive::displacement(self.driven.as_ref()?)
    }
}

impl Scene {
    /// Whether particles may collide, with obstacles or with each other.
    pub fn collides(&self) -> bool {
        let among = self
            .contact
            .as_ref()
            .is_some_and(|contact| contact.particles);
        among || !self.colliders.is_empty()
    }

    /// The pairs of particles that springs or rods join, the smaller first: these do not collide.
    pub fn joined(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        let springs = self.springs.iter().map(|spring| spring.ends);
        let rods = self.rods.iter().map(|rod| rod.ends);
        springs.chain(rods).map(|[i, j]| [i.min(j), i.max(j)])
    }
}

/// Fills in what is absent, and makes normals unit vectors.
pub(super) fn complete(scene: &mut Scene) -> Result<(), Problem> {
    for (at, collider) in scene.colliders.iter_mut().enumerate() {
        if collider.static_friction.is_nan() {
            collider.static_friction = collider.friction;
        }
        if let Some(plane) = &mut collider.plane {
            normalise(&mut plane.normal, &format!("colliders[{at}].plane.normal"))?;
        }
    }
    if let Some(contact) = &mut scene.contact
        && contact.static_friction.is_nan()
    {
        contact.static_friction = contact.friction;
    }
    Ok(())
}

/// Checks the obstacles of a scene whose particles start at `starts`.
pub(super) fn check(scene: &Scene, starts: &[[f64; 3]]) -> Result<(), Problem> {
    let given = scene.contact.as_ref();
    let pressed = given.is_some_and(|contact| contact.penalty.is_some());
    for (at, collider) in scene.colliders.iter().enumerate() {
        let of = format!("colliders[{at}]");
        one_shape(&of, collider)?;
        if let Some(given) = &collider.driven {
            motion(&format!("{of}.driven"), given)?;
        }
        sticks(&of, [collider.friction, collider.static_friction])?;
        if pressed {
            let friction = [collider.friction, collider.static_friction];
            smooth(&of, collider.restitution, friction)?;
        }
        for shape in collider.shapes() {
            outside(&of, collider, &shape, scene, starts, pressed)?;
        }
    }
    contact(scene, starts)?;
    let contact = scene.contact.as_ref();
    let collide = match contact.filter(|contact| contact.particles) {
        Some(_) => "contact",
        None if scene.colliders.is_empty() => return Ok(()),
        None => "colliders",
    };
    let driven = scene.driven.iter().map(|driven| driven.particle);
    let on_rods = |id: usize| scene.rods.iter().any(|rod| rod.ends.contains(&id));
    for (there, key) in [
        (driven.into_iter().any(on_rods), "rods with a driven end"),
        (scene.strain_limit.is_some(), "`strain_limit`"),
    ] {
        if there {
            let help = "remove one of the two to run the rest of the scene";
            let refusal = Refusal::new(format!("not supported yet beside {key}"), help);
            return Err(Problem::new(collide, refusal));
        }
    }
    Ok(())
}

/// Checks that what sticks holds at least as well as what slides.
fn sticks(of: &str, [low, found]: [f64; 2]) -> Result<(), Problem> {
    if found >= low {
        return Ok(());
    }
    let message = format!("expected at least the friction ({low:?}), found {found:?}");
    let help = "what sticks holds at least as well as what slides";
    Problem::because(format!("{of}.static_friction"), message, help)
}

/// Checks how particles collide: with something, and not inside of each other at the start.
fn contact(scene: &Scene, starts: &[[f64; 3]]) -> Result<(), Problem> {
    let Some(contact) = &scene.contact else {
        return Ok(());
    };
    let friction = [contact.friction, contact.static_friction];
    sticks("contact", friction)?;
    if !contact.particles {
        for (key, value) in [
            ("restitution", contact.restitution),
            ("friction", contact.friction),
            ("static_friction", contact.static_friction),
        ] {
            if value != 0.0 {
                let message = "expected `particles: true`: it is of particles with each other";
                let help = "obstacles have coefficients of their own, under `colliders`";
                return Problem::because(format!("contact.{key}"), message, help);
            }
        }
        if scene.colliders.is_empty() || contact.penalty.is_none() {
            let message = "expected something to say of contact, found nothing";
            let help =
                "let particles collide with each other by `particles: true`, or remove `contact`";
            return Problem::because("contact", message, help);
        }
        return Ok(());
    }
    let pressed = contact.penalty.is_some();
    if pressed {
        smooth("contact", contact.restitution, friction)?;
    }
    let mut free = scene.particles.iter().filter(|particle| !particle.fixed);
    if free.clone().count() > 1 && free.all(|particle| particle.radius == 0.0) {
        let message = "expected free particles with a radius, found none";
        let help = "two points never meet: give `radius`, or leave `particles` out";
        return Problem::because("contact.particles", message, help);
    }
    apart(scene, starts, pressed)
}

/// Checks that beside a penalty nothing is said of impulses.
fn smooth(of: &str, restitution: f64, [sliding, sticking]: [f64; 2]) -> Result<(), Problem> {
    for (key, value) in [
        ("restitution", restitution),
        ("friction", sliding),
        ("static_friction", sticking),
    ] {
        if value != 0.0 {
            let message = format!("expected 0 beside `contact.penalty`, found {value:?}");
            let help = "a penalty is a spring and a damper along the normal: its `damping` takes the place of restitution, and it \
                        has no friction";
            return Problem::because(format!("{of}.{key}"), message, help);
        }
    }
    Ok(())
}

/// A positive number to six digits.
fn spoken(number: f64) -> f64 {
    let parts = 10.0_f64.powi(5 - number.log10().floor() as i32);
    if parts > 0.0 && parts.is_finite() {
        (number * parts).round() / parts
    } else {
        number
    }
}

/// Checks that no two free particles that collide start in one place, or inside each other unless a penalty presses them.
fn apart(scene: &Scene, starts: &[[f64; 3]], pressed: bool) -> Result<(), Problem> {
    let joined: HashSet<[usize; 2]> = scene.joined().collect();
    let around = |(id, particle): (usize, &Particle)| {
        let half = Vector::splat(particle.radius);
        Aabb::from_half_extents(Vector::from(starts[id]), half)
    };
    let free = || scene.particles.iter().enumerate().filter(|(_, p)| !p.fixed);
    // parry wants leaves numbered from 0.
    let numbers: Vec<usize> = free().map(|(id, _)| id).collect();
    let boxes: Vec<Aabb> = free().map(around).collect();
    let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
    for ((id, particle), own) in free().zip(&boxes) {
        let mut others: Vec<usize> = tree
            .intersect_aabb(own)
            .map(|leaf| numbers[leaf as usize])
            .collect();
        others.sort_unstable();
        for other in others.into_iter().filter(|other| id < *other) {
            let away = Vector::from(starts[other]) - Vector::from(starts[id]);
            let deep = particle.radius + scene.particles[other].radius - away.length();
            let ends = starts[id].iter().chain(&starts[other]);
            let largest = ends.fold(particle.radius, |most, c| most.max(c.abs()));
            if joined.contains(&[id, other]) {
                continue;
            }
            let [one, two] = [id, other].map(|id| called(&scene.bodies, id));
            if starts[id] == starts[other] {
                let message =
                    format!("expected free particles apart, found {one} and {two} in one place");
                let help = "nothing says in which direction they push each other: move one of them";
                return Problem::because("contact.particles", message, help);
            }
            if !pressed && deep > TOUCHING * largest {
                let deep = spoken(deep);
                let message = format!(
                    "expected free particles apart, found {one} and {two} {deep:?} m inside each other at the start"
                );
                let help = "particles collide by their `radius`, 0.1 m unless the file says otherwise: give smaller ones, or \
                            move them";
                return Problem::because("contact.particles", message, help);
            }
        }
    }
    Ok(())
}

fn one_shape(of: &str, collider: &Collider) -> Result<(), Problem> {
    let shapes = [
        ("plane", collider.plane.is_some()),
        ("ball", collider.ball.is_some()),
        ("box", collider.block.is_some()),
        ("capsule", collider.capsule.is_some()),
        ("mesh", collider.mesh.is_some()),
    ];
    let given: Vec<&str> = shapes.iter().filter(|s| s.1).map(|s| s.0).collect();
    if given.len() != 1 {
        let found = match given.len() {
            0 => "none".to_owned(),
            _ => given.join(" and "),
        };
        let message =
            format!("expected one of `plane`, `ball`, `box`, `capsule` and `mesh`, found {found}");
        let help = "an obstacle has one shape, as `plane: {normal: [0, 0, 1]}`";
        return Problem::because(of, message, help);
    }
    if let Some(capsule) = collider.capsule.as_ref().filter(|c| c.a == c.b) {
        let message = format!("expected two ends apart, found both at {:?}", capsule.a);
        let help = "a capsule of one point is a `ball: {center, radius}`";
        return Problem::because(format!("{of}.capsule.b"), message, help);
    }
    let Some(mesh) = &collider.mesh else {
        return Ok(());
    };
    for (at, row) in mesh.triangles.0.iter().enumerate() {
        let because = |message: String, help| {
            Problem::because(format!("{of}.mesh.triangles[{at}]"), message, help)
        };
        let count = mesh.vertices.0.len();
        if let Some(found) = row.iter().find(|v| v.fract() != 0.0 || **v >= count as f64) {
            let last = count.saturating_sub(1);
            let message = format!("expected a vertex from 0 to {last}, found {found:?}");
            return because(message, "vertices count from 0");
        }
        let [a, b, c] = row.map(|vertex| Vector::from(mesh.vertices.0[vertex as usize]));
        let (first, second) = (b - a, c - a);
        let area = first.cross(second).length();
        // To the rounding of a product.
        if area <= 4.0 * f64::EPSILON * first.length() * second.length() {
            let message = "expected three corners apart, found them on one line".to_owned();
            return because(message, "a triangle needs an area");
        }
    }
    Ok(())
}

/// Checks that no free particle starts inside, unless a penalty presses it there.
fn outside(
    of: &str,
    collider: &Collider,
    shape: &Shape,
    scene: &Scene,
    starts: &[[f64; 3]],
    pressed: bool,
) -> Result<(), Problem> {
    let moved = collider
        .displacement()
        .map_or([0.0; 3], |drive| drive.at(0.0)[0]);
    let free = scene.particles.iter().zip(starts).enumerate();
    for (id, (particle, start)) in free.filter(|(_, (particle, _))| !particle.fixed) {
        let name = called(&scene.bodies, id);
        if collider.mesh.is_some() && particle.radius == 0.0 {
            let message = format!("expected particles with a radius, found that {name} has none");
            let help =
                "a surface has no inside that a point could be in: give `radius`, or take a `box`";
            return Problem::because(format!("{of}.mesh"), message, help);
        }
        let at = [0, 1, 2].map(|axis| start[axis] - moved[axis]);
        let gap = shape.nearest(at).distance - particle.radius;
        let largest = at.iter().fold(particle.radius, |most, c| most.max(c.abs()));
        if !pressed && gap < -TOUCHING * largest {
            let deep = spoken(-gap);
            let message = format!(
                "expected every free particle outside, found {name} {deep:?} m inside at the start, as a ball of radius \
                 {:?} m",
                particle.radius
            );
            let help = "a particle collides by its `radius`, 0.1 m unless the file says otherwise: move it, or give a smaller one";
            return Problem::because(of, message, help);
        }
    }
    Ok(())
}
