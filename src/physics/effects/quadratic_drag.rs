//! Drag with the square of the speed.

use super::drag::moved_by;
use super::{Effect, EffectRow, boxed, dot, velocity};
use crate::physics::{Derivative, ForceKinds, Jacobian, Linearization, Power};
use crate::scene::Scene;
use nalgebra::Matrix3;

pub(super) const ROW: EffectRow = EffectRow {
    id: "quadratic_drag",
    summary: "drag with the square of the speed on particles with a `quadratic_drag` coefficient",
    source: "f = -c |u| u (Newton), u = v - w relative to the air; dissipates c |v|³ where the air is at rest",
    elastic: false,
    constant: false,
    build: |scene| QuadraticDrag::new(scene).map(boxed),
};

/// f = -c |u| u on each particle with c > 0, u = v - w, w the velocity of the air.
///
/// The force on what is at rest, c |w| w, is what air that moves injects by; the rest dissipates. Not to be confused
/// with [`Drag`](super::Drag), which is linear, nor with drag on each axis for itself, which would depend on the axes.
pub struct QuadraticDrag {
    /// Particle and its c, N s²/m².
    coefficients: Vec<(usize, f64)>,
    /// w, m/s.
    air: [f64; 3],
}

impl QuadraticDrag {
    /// None when no free particle has quadratic drag.
    pub fn new(scene: &Scene) -> Option<Self> {
        let particles = scene.particles.iter().enumerate();
        let dragged = particles.filter(|(_, p)| !p.fixed && p.quadratic_drag != 0.0);
        let coefficients: Vec<_> = dragged.map(|(i, p)| (i, p.quadratic_drag)).collect();
        (!coefficients.is_empty()).then(|| Self {
            coefficients,
            air: scene.air().velocity,
        })
    }

    /// u and |u| of a particle.
    fn relative(&self, v: &[f64], i: usize) -> ([f64; 3], f64) {
        let v = velocity(v, i);
        let u = [0, 1, 2].map(|axis| v[axis] - self.air[axis]);
        (u, dot(u, u).sqrt())
    }
}

impl Effect for QuadraticDrag {
    fn members(&self) -> usize {
        self.coefficients.len()
    }

    fn kinds(&self) -> ForceKinds {
        ForceKinds::NON_LINEAR | moved_by(self.air)
    }

    fn add_force(&self, _t: f64, _x: &[f64], v: &[f64], f: &mut [f64]) -> Power {
        let mut power = Power::default();
        let wind = dot(self.air, self.air).sqrt();
        for &(i, c) in &self.coefficients {
            let (u, speed) = self.relative(v, i);
            for axis in 0..3 {
                f[3 * i + axis] -= c * speed * u[axis];
            }
            // (|u| u + |w| w)·v = |u| v² + (|w| - |u|) w·v, without the difference of two speeds that are near.
            let v = velocity(v, i);
            let (square, along) = (dot(v, v), dot(v, self.air));
            power.dissipated += c * speed * square;
            if wind > 0.0 {
                power.dissipated += c * along * (2.0 * along - square) / (wind + speed);
                power.injected += c * wind * along;
            }
        }
        power
    }

    fn add_rounding(&self, _t: f64, _x: &[f64], v: &[f64], f: &mut [f64]) {
        for &(i, c) in &self.coefficients {
            let (u, speed) = self.relative(v, i);
            let v = velocity(v, i);
            let terms = [0, 1, 2].map(|axis| v[axis].abs() + self.air[axis].abs());
            let all = terms[0] + terms[1] + terms[2];
            for axis in 0..3 {
                // Of the factor u, and of |u|, which all three components round.
                let off = 4.0 * speed * terms[axis] + 2.0 * u[axis].abs() * all;
                f[3 * i + axis] += f64::EPSILON * c.abs() * off;
            }
        }
    }

    /// The power on what is at rest.
    fn injected_power(&self, _t: f64, v: &[f64]) -> f64 {
        let wind = dot(self.air, self.air).sqrt();
        let along = |&(i, c): &(usize, f64)| c * wind * dot(self.air, velocity(v, i));
        self.coefficients.iter().map(along).sum()
    }

    /// -c (|u| + u uᵀ / |u|), which is symmetric, and 0 where u is.
    fn add_jacobian(
        &self,
        _t: f64,
        _x: &[f64],
        v: &[f64],
        _linearization: Linearization,
        out: &mut Jacobian,
    ) {
        for &(i, c) in &self.coefficients {
            let (u, speed) = self.relative(v, i);
            let inverse = if speed > 0.0 { 1.0 / speed } else { 0.0 };
            let slope = Matrix3::from_fn(|row, column| {
                let own = if row == column { speed } else { 0.0 };
                -c * (own + u[row] * (u[column] * inverse))
            });
            out.add_block(Derivative::Velocity, [i, i], &slope);
        }
    }
}
