//! A particle on a line under a constant force and drag with the square of its speed.

use super::group::{Group, is_plain};
use super::vector::{norm, unit};
use nalgebra::Vector3;

pub(super) const METHOD: &str = "fall with quadratic drag";
pub(super) const REASON: &str =
    "a free particle on a line under a constant force and quadratic drag";

/// u' = a - k |u| u along a line, u the velocity relative to the air, a >= 0 and k = c / m > 0.
///
/// With V = √(a / k), the terminal speed, and r = √(a k): against the force u = -V tan(q - r t), until it turns; along it
/// u = V (y + tanh r t) / (1 + y tanh r t), y = u0 / V. Without a force u = u0 / (1 + k u0 t). Ways are logarithms of
/// these denominators over k. Not to be confused with linear drag, whose velocities are exponentials.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fall {
    particle: usize,
    /// Unit vector along the force, or along the velocity where there is none.
    along: Vector3<f64>,
    /// Velocity of the air, m/s.
    air: Vector3<f64>,
    /// Relative velocity at the start, m/s.
    start: f64,
    /// a, m/s².
    pull: f64,
    /// k, 1/m.
    drag: f64,
    /// The scene's size, m.
    size: f64,
}

impl Fall {
    /// None unless the group is one particle without springs and without linear drag whose velocity relative to the
    /// air lies along the force.
    pub fn of(group: &Group) -> Option<Self> {
        let ([body], []) = (&group.bodies[..], &group.links[..]) else {
            return None;
        };
        let relative = body.velocity - body.air;
        let force = body.constant;
        if body.drag != 0.0 || relative.cross(&force) != Vector3::zeros() {
            return None;
        }
        let along = [force, relative].into_iter().find_map(unit);
        let along = along.unwrap_or(Vector3::x());
        let start = norm(relative).copysign(relative.dot(&along));
        let fall = Self {
            particle: body.id,
            along,
            air: body.air,
            start,
            pull: norm(force),
            drag: body.quadratic / body.mass,
            size: group.size,
        };
        // Ways are logarithms of 1 and these, over the drag.
        let Self { drag, pull, .. } = fall;
        let y = if pull > 0.0 {
            start / (pull / drag).sqrt()
        } else {
            0.0
        };
        let plain = [drag, drag * start, drag * pull, y * y].map(is_plain);
        (drag > 0.0 && plain == [true; 4]).then_some(fall)
    }

    /// Way against the force, way along it (m, both not negative) and relative velocity at `t`.
    fn relative(&self, t: f64) -> (f64, f64, f64) {
        let Self {
            start, pull, drag, ..
        } = *self;
        if pull == 0.0 {
            let q = drag * start * t;
            return (0.0, q.ln_1p() / drag, start / (1.0 + q));
        }
        let (terminal, rate) = ((pull / drag).sqrt(), (pull * drag).sqrt());
        let y = start / terminal;
        let turned = (-y).max(0.0).atan() / rate;
        if t < turned {
            let (sin, tan) = ((rate * t).sin(), (rate * t).tan());
            let half = (0.5 * rate * t).sin();
            let way = (-y * sin - 2.0 * half * half).ln_1p() / drag;
            let speed = terminal * (-y - tan) / (1.0 - y * tan);
            return (way, 0.0, -speed);
        }
        let up = 0.5 * (y.min(0.0) * y.min(0.0)).ln_1p() / drag;
        let (y, z) = (y.max(0.0), rate * (t - turned));
        let way = if z < 1.0 {
            let half = (0.5 * z).sinh();
            (2.0 * half * half + y * z.sinh()).ln_1p()
        } else {
            // cosh z + y sinh z = e^z (1 + (y - 1) (1 - e^-2z) / 2).
            z + (-0.5 * (y - 1.0) * (-2.0 * z).exp_m1()).ln_1p()
        };
        let tanh = z.tanh();
        let speed = terminal * (y + tanh) / (1.0 + y * tanh);
        (up, way / drag, speed)
    }

    /// Adds the displacement and the gained velocity at `t` to flat vectors of the scene.
    pub fn add(&self, t: f64, x: &mut [f64], v: &mut [f64]) {
        let (against, along, speed) = self.relative(t);
        let moved = self.along * (along - against) + self.air * t;
        let gained = self.along * (speed - self.start);
        for axis in 0..3 {
            x[3 * self.particle + axis] += moved[axis];
            v[3 * self.particle + axis] += gained[axis];
        }
    }

    /// Bound on the distance of any computed position in [0, t] from the exact one, m: 16 roundings of the size or of
    /// the way gone. Each step above rounds a few times, and none of them makes more of it than the way itself. Early on
    /// the logarithms are so small that they have lost digits.
    pub fn error_bar(&self, t: f64) -> f64 {
        let (against, along, _) = self.relative(t);
        let way = against + along + norm(self.air) * t;
        16.0 * f64::EPSILON * (self.size.max(way) + f64::MIN_POSITIVE / self.drag)
    }
}
