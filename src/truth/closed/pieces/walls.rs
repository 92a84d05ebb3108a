//! Planes at rest or in steady motion, and what an impact on one does.

use crate::scene::Scene;
use nalgebra::Vector3;

/// A plane.
#[derive(Debug, Clone)]
pub(in crate::truth::closed) struct Wall {
    /// A unit vector, to where it is free.
    pub normal: Vector3<f64>,
    /// Along the normal from the origin, m.
    offset: f64,
    /// m/s.
    pub velocity: Vector3<f64>,
    /// e.
    restitution: f64,
    /// µ of what slides, and of what sticks.
    pub friction: [f64; 2],
}

/// The obstacles of a scene, where all are such planes and no two particles collide.
pub(in crate::truth::closed) fn walls(scene: &Scene) -> Option<Vec<Wall>> {
    let free = scene.particles.iter().filter(|particle| !particle.fixed);
    let contact = scene.contact.as_ref();
    if contact.is_some_and(|contact| contact.particles) && free.count() > 1 {
        return None;
    }
    let walls = scene.colliders.iter().map(|collider| {
        let plane = collider.plane.as_ref()?;
        let velocity = match &collider.driven {
            None => [0.0; 3],
            Some(motion) => motion.velocity?,
        };
        Some(Wall {
            normal: plane.normal.into(),
            offset: plane.offset,
            velocity: velocity.into(),
            restitution: collider.restitution,
            friction: [collider.friction, collider.static_friction],
        })
    });
    walls.collect()
}

impl Wall {
    /// The gap of a particle of this radius at the start, and the size of what it comes from, m.
    pub fn gap(&self, radius: f64, x: Vector3<f64>) -> (f64, f64) {
        let along = self.normal.dot(&x);
        let from = x.abs().dot(&self.normal.abs()) + self.offset.abs() + radius;
        (along - self.offset - radius, from)
    }

    /// The speed at which a velocity leads away from it, m/s.
    pub fn parting(&self, v: Vector3<f64>) -> f64 {
        self.normal.dot(&(v - self.velocity))
    }

    /// The velocity after an impact: v_n' = -e v_n, and min(µ (1 + e) |v_n|, |v_t|) off the sliding velocity.
    pub fn struck(&self, v: Vector3<f64>) -> Vector3<f64> {
        let speed = -self.parting(v);
        let sliding = v - self.velocity + self.normal * speed;
        let slowed = self.slowed(speed, sliding);
        self.velocity + sliding * slowed + self.normal * (self.restitution * speed)
    }

    /// The part of its sliding velocity that an impact leaves, which approaches at this speed.
    fn slowed(&self, speed: f64, sliding: Vector3<f64>) -> f64 {
        let lost = self.friction[0] * (1.0 + self.restitution) * speed;
        let fast = sliding.norm();
        if lost < fast { 1.0 - lost / fast } else { 0.0 }
    }

    /// How the velocity after an impact changes with the one before it, of direction `d`: the derivative of
    /// [`struck`](Self::struck).
    pub fn struck_change(&self, v: Vector3<f64>, d: Vector3<f64>) -> Vector3<f64> {
        let speed = -self.parting(v);
        let sliding = v - self.velocity + self.normal * speed;
        let normal = self.normal.dot(&d);
        let mut change = -self.restitution * normal * self.normal;
        let left = self.slowed(speed, sliding);
        if left > 0.0 {
            let across = d - normal * self.normal;
            let along = sliding.try_normalize(0.0).unwrap_or_default();
            let with = along.dot(&across);
            let less = self.friction[0] * (1.0 + self.restitution) * normal;
            change += left * (across - with * along) + (with + less) * along;
        }
        change
    }
}
