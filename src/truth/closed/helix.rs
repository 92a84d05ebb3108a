//! One charged particle in a uniform magnetic field, under constant forces and linear drag: a helix that drifts.

use super::group::{Body, Group};
use super::mode::{Mode, Start};
use super::vector::{norm, unit};
use nalgebra::{Complex, Vector3};

/// x(t) = x(0) + h φ1(λ h) u + h² φ2(λ h) a across the field, with λ = -b/m + i w: i stands for a quarter turn.
/// Along the field it is the fall of a particle without a charge.
#[derive(Debug, Clone)]
pub(super) struct Helix {
    body: Body,
    /// Unit vector along q B.
    along: Vector3<f64>,
    /// λ, 1/s.
    rate: Complex<f64>,
    /// The scene's size, m.
    size: f64,
}

impl Helix {
    /// None of a group that is not one charged particle without springs, in a field.
    pub fn of(group: &Group) -> Option<Self> {
        let ([body], []) = (&group.bodies[..], &group.links[..]) else {
            return None;
        };
        Some(Self {
            along: unit(body.turning)?,
            rate: Complex::new(-body.drag / body.mass, norm(body.turning)),
            body: *body,
            size: group.size,
        })
    }

    /// What it is, and why.
    pub fn words(&self) -> [&'static str; 2] {
        if self.body.drag > 0.0 {
            [
                "helix with linear drag",
                "a charged free particle in a magnetic field, under constant forces and linear drag",
            ]
        } else {
            [
                "helix",
                "a charged free particle in a magnetic field, under constant forces alone",
            ]
        }
    }

    /// Adds displacement and gained velocity at `t` to flat vectors of the scene.
    pub fn add(&self, t: f64, x: &mut [f64], v: &mut [f64]) {
        let Body {
            velocity, constant, ..
        } = self.body;
        let (u, a) = (self.across(velocity), self.across(constant));
        let [phi1, phi2] = phis(self.rate * t);
        let moved = self.turned(u, phi1 * t) + self.turned(a, phi2 * (t * t));
        let gained = self.turned(u, self.rate * t * phi1) + self.turned(a, phi1 * t);
        let (mode, start) = self.fall();
        let response = mode.response(t);
        let moved = moved + self.along * response.position(start);
        let gained = gained + self.along * response.gained(start);
        let at = 3 * self.body.id;
        for axis in 0..3 {
            x[at + axis] += moved[axis];
            v[at + axis] += gained[axis];
        }
    }

    /// The motion along the field: drag alone slows it.
    fn fall(&self) -> (Mode, Start) {
        let mode = Mode {
            w: 0.0,
            g: -0.5 * self.rate.re,
        };
        let start = Start {
            velocity: self.body.velocity.dot(&self.along),
            pull: self.body.constant.dot(&self.along),
        };
        (mode, start)
    }

    /// The part of a vector across the field.
    fn across(&self, a: Vector3<f64>) -> Vector3<f64> {
        a - self.along * self.along.dot(&a)
    }

    /// A vector across the field, multiplied by a complex number: v x B is a quarter turn.
    fn turned(&self, a: Vector3<f64>, by: Complex<f64>) -> Vector3<f64> {
        a * by.re + a.cross(&self.along) * by.im
    }

    /// Bound on the distance of any computed position in [0, t] from the exact one, m.
    ///
    /// 16 eps of the scene's size or the distance travelled, where that is larger, covers each sum; 16 eps |λ| t of
    /// the circle's size covers the phase, which a rounded rate moves at eps |λ|.
    pub fn error_bar(&self, t: f64) -> f64 {
        let Body {
            velocity, constant, ..
        } = self.body;
        let (u, a) = (norm(self.across(velocity)), norm(self.across(constant)));
        // The integrals of e^(λs) and of that integral.
        let slow = 2.0 / self.rate.norm();
        let across = u * t.min(slow) + a * t * (0.5 * t).min(slow);
        let circle = u * t.min(slow) + a * (0.5 * t * t).min(slow * slow);
        let (mode, start) = self.fall();
        let reach = across.hypot(mode.travel_bound(start, t));
        16.0 * f64::EPSILON * (self.size.max(reach) + self.rate.norm() * t * circle)
    }
}

/// φ1(z) = (e^z - 1)/z and φ2(z) = (e^z - 1 - z)/z².
fn phis(z: Complex<f64>) -> [Complex<f64>; 2] {
    if z.norm() > 0.5 {
        let gained = z.exp() - 1.0;
        return [gained / z, (gained - z) / z / z];
    }
    // The closed forms cancel here; 18 terms of the series reach rounding.
    let second = (2..20).rev().fold(Complex::new(0.0, 0.0), |sum, k| {
        (sum * z + 1.0) / f64::from(k)
    });
    [second * z + 1.0, second]
}
