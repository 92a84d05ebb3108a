//! Checks of obstacles: each is one shape that has a surface, and no particle starts inside.

use super::drive::{Drive, motion};
use super::error::Refusal;
use super::model::{Collider, Scene};
use super::object::called;
use super::place::Problem;
use super::vectors::normalise;
use crate::shape::{Core, Shape};
use parry3d::math::Vector;
use parry3d::shape::Segment;

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
    Ok(())
}

/// Checks the obstacles of a scene whose particles start at `starts`.
pub(super) fn check(scene: &Scene, starts: &[[f64; 3]]) -> Result<(), Problem> {
    for (at, collider) in scene.colliders.iter().enumerate() {
        let of = format!("colliders[{at}]");
        one_shape(&of, collider)?;
        if let Some(given) = &collider.driven {
            motion(&format!("{of}.driven"), given)?;
        }
        if collider.static_friction < collider.friction {
            let (low, found) = (collider.friction, collider.static_friction);
            let message = format!("expected at least the friction ({low:?}), found {found:?}");
            let help = "what sticks holds at least as well as what slides";
            return Problem::because(format!("{of}.static_friction"), message, help);
        }
        for shape in collider.shapes() {
            outside(&of, collider, &shape, scene, starts)?;
        }
    }
    if scene.colliders.is_empty() {
        return Ok(());
    }
    for (there, key) in [
        (!scene.rods.is_empty(), "rods"),
        (scene.strain_limit.is_some(), "strain_limit"),
    ] {
        if there {
            let help = "remove one of the two to run the rest of the scene";
            let refusal = Refusal::new(format!("not supported yet beside `{key}`"), help);
            return Err(Problem::new("colliders", refusal));
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
    if mesh.triangles.0.is_empty() {
        let message = "expected at least one triangle, found none";
        return Problem::because(
            format!("{of}.mesh.triangles"),
            message,
            "a triangle is [0, 1, 2]",
        );
    }
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

/// Checks that no free particle starts inside.
fn outside(
    of: &str,
    collider: &Collider,
    shape: &Shape,
    scene: &Scene,
    starts: &[[f64; 3]],
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
        if gap < -TOUCHING * largest {
            let deep = -gap;
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
