//! The exact flow of one damper after the other, at frozen positions.
//!
//! A damper of coefficient c between inverse masses w1 and w2 acts on one number at a time, the relative velocity u
//! of its ends along a direction: u' = α - c (w1 + w2) u, and the momentum of the two is kept. Each such flow is
//! exact. A magnetic field turns one particle's velocity, which is exact too, and counts as a damper here. One after
//! the other they are the flow of all dampers together where no two share a particle, and to first
//! order in h elsewhere; a sweep in the reverse order is then the adjoint.

mod bend;
mod bound;
mod turn;

pub use bound::Bound;

use crate::physics::System;
use crate::space::dot;

/// How a system's dampers can be applied.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dampers {
    /// Together alone, by products with their matrix: [`System::damping`].
    Whole,
    /// One after the other: no particle has two of them, so that a sweep with the accelerations is exact.
    Apart,
    /// One after the other: some particle has two of them.
    Shared,
}

/// A sweep over all dampers, by [`System::sweep`].
pub struct Sweep<'a> {
    x: &'a [f64],
    v: &'a mut [f64],
    inverse_mass: &'a [f64],
    h: f64,
    /// Whether the dampers act in the reverse order.
    pub backward: bool,
    /// Whether each flow is that of the midpoint rule and not the exact one, where damping acts alone: (1 - z/2)/(1 +
    /// z/2) for e^-z, and a turn by 2 atan(w h/2) for one by w h.
    pub midpoint: bool,
    /// The acceleration at rest, which `v` already has h times; None where only damping acts.
    a: Option<&'a [f64]>,
    /// The integral of the velocity: as without dampers, and corrected by each.
    moved: Option<&'a mut [f64]>,
    /// The factor of all coefficients.
    scale: f64,
    /// The directions that particles cannot move in, where there are some.
    bound: Option<&'a Bound>,
    /// What the dampers have taken out, J.
    dissipated: f64,
    decay: Decay,
}

/// A velocity that relaxes at this rate over h.
#[derive(Debug, Clone, Copy, Default)]
struct Decay {
    /// 1/s.
    rate: f64,
    /// The sum of the inverse masses, 1/kg.
    w: f64,
    /// What a velocity loses, as an impulse: (1 - e^(-rate h)) / w.
    lost: f64,
    /// What is kept of the velocity, e^(-rate h).
    kept: f64,
    /// h φ1(-rate h), the part of an acceleration.
    pushed: f64,
    /// h² φ2(-rate h), what the present acceleration moves.
    moved: f64,
}

/// The largest exponent. One of a negative h beyond it would be infinite, and 0 times that no number.
const EXPONENT: f64 = 700.0;

impl<'a> Sweep<'a> {
    /// A sweep of damping alone over `h` seconds, which may be negative, at positions `x`.
    pub fn new(system: &'a dyn System, x: &'a [f64], v: &'a mut [f64], h: f64) -> Self {
        Self {
            x,
            v,
            inverse_mass: system.inverse_mass(),
            h,
            backward: false,
            midpoint: false,
            a: None,
            moved: None,
            scale: 1.0,
            bound: None,
            dissipated: 0.0,
            decay: Decay::default(),
        }
    }

    /// The same of dampers and the acceleration `a` together, for dampers that are [`Apart`](Dampers::Apart): `v` has
    /// h a already. `moved` is ∫ v as without dampers, if it is wanted, and becomes that with them.
    pub fn with(self, a: &'a [f64], moved: Option<&'a mut [f64]>) -> Self {
        Self {
            a: Some(a),
            moved,
            ..self
        }
    }

    /// Positions, m.
    pub fn x(&self) -> &'a [f64] {
        self.x
    }

    /// Energy taken out so far, J.
    pub fn dissipated(&self) -> f64 {
        self.dissipated
    }

    /// Sweeps with the particles at other positions.
    pub fn elsewhere(&mut self, x: &[f64], all: impl FnOnce(&mut Sweep)) {
        let mut there = Sweep {
            x,
            v: self.v,
            inverse_mass: self.inverse_mass,
            h: self.h,
            backward: self.backward,
            midpoint: self.midpoint,
            a: self.a,
            moved: self.moved.as_deref_mut(),
            scale: self.scale,
            bound: self.bound,
            dissipated: self.dissipated,
            decay: self.decay,
        };
        all(&mut there);
        self.dissipated = there.dissipated;
    }

    /// Multiplies the coefficients by `factor` during `all`.
    pub fn scaled(&mut self, factor: f64, all: impl FnOnce(&mut Self)) {
        let before = self.scale;
        self.scale *= factor;
        all(self);
        self.scale = before;
    }

    /// A damper c, N s/m, between the particles i and j along a vector of any length; nothing where that is 0.
    #[inline(always)]
    pub fn along(&mut self, [i, j]: [usize; 2], c: f64, d: [f64; 3]) {
        let Some([i, j]) = self.pair([i, j]) else {
            return;
        };
        if let Some(bound) = self.bound(&[i, j]) {
            let square = dot(d, d);
            if square >= f64::MIN_POSITIVE {
                // The rate of d² / 2, without a root.
                self.rate(bound, c / square, [(i, d.map(|d| -d)), (j, d)]);
            }
            return;
        }
        let (wi, wj) = (self.inverse_mass[i], self.inverse_mass[j]);
        if !self.relaxes(c, wi + wj) {
            return;
        }
        // n nᵀ = d dᵀ / d², without a root. All but the energy is linear in what is along d.
        let square = dot(d, d);
        if square < f64::MIN_POSITIVE {
            return;
        }
        let inverse = 1.0 / square;
        let along = |from: &[f64], to: &[f64]| {
            (to[0] - from[0]) * d[0] + (to[1] - from[1]) * d[1] + (to[2] - from[2]) * d[2]
        };
        let u = along(&self.v[i..i + 3], &self.v[j..j + 3]);
        let impulse = if let Some(a) = self.a {
            let alpha = along(&a[i..i + 3], &a[j..j + 3]);
            let (after, moved) = self.relaxed(u, alpha, inverse);
            let w = self.decay.w;
            if let Some(by) = &mut self.moved {
                for axis in 0..3 {
                    by[i + axis] -= wi / w * moved * inverse * d[axis];
                    by[j + axis] += wj / w * moved * inverse * d[axis];
                }
            }
            (u - after) / w
        } else {
            // Few operations stand between a velocity and the next, which may be the next damper's.
            let impulse = self.decay.lost * u;
            self.dissipated += 0.5 * inverse * impulse * (u + self.decay.kept * u);
            impulse
        };
        for (place, w) in [(i, wi * inverse), (j, -wj * inverse)] {
            for (v, d) in self.v[place..place + 3].iter_mut().zip(d) {
                *v += (w * d) * impulse;
            }
        }
    }

    /// A damper c, N s/m, between the particles i and j in all directions.
    #[inline]
    pub fn between(&mut self, [i, j]: [usize; 2], c: f64) {
        let Some([i, j]) = self.pair([i, j]) else {
            return;
        };
        if let Some(bound) = self.bound(&[i, j]) {
            for d in self.axes() {
                self.rate(bound, c, [(i, d.map(|d| -d)), (j, d)]);
            }
            return;
        }
        let (wi, wj) = (self.inverse_mass[i], self.inverse_mass[j]);
        if !self.relaxes(c, wi + wj) {
            return;
        }
        let w = self.decay.w;
        for (i, j) in (i..i + 3).zip(j..j + 3) {
            let u = self.v[j] - self.v[i];
            let alpha = self.a.map_or(0.0, |a| a[j] - a[i]);
            let (after, moved) = self.relaxed(u, alpha, 1.0);
            // What hangs on a fixed particle has the new velocity itself: a difference would round by the old one.
            if wi == 0.0 {
                self.v[j] = self.v[i] + after;
            } else if wj == 0.0 {
                self.v[i] = self.v[j] - after;
            } else {
                let change = (after - u) / w;
                self.v[i] -= wi * change;
                self.v[j] += wj * change;
            }
            if let Some(by) = &mut self.moved {
                by[i] -= wi / w * moved;
                by[j] += wj / w * moved;
            }
        }
    }

    /// Drag b, N s/m, on particle i.
    #[inline]
    pub fn on(&mut self, i: usize, b: f64) {
        let Some([i, _]) = self.pair([i, i]) else {
            return;
        };
        if let Some(bound) = self.bound(&[i]) {
            return self.slow(bound, b, i);
        }
        if !self.relaxes(b, self.inverse_mass[i]) {
            return;
        }
        for i in i..i + 3 {
            let alpha = self.a.map_or(0.0, |a| a[i]);
            let (after, moved) = self.relaxed(self.v[i], alpha, 1.0);
            self.v[i] = after;
            if let Some(by) = &mut self.moved {
                by[i] += moved;
            }
        }
    }

    /// The places of two particles' first coordinates; None outside the vectors.
    #[inline]
    fn pair(&self, ends: [usize; 2]) -> Option<[usize; 2]> {
        let places = ends.map(|end| 3 * end);
        let inside = |&place: &usize| place + 2 < self.v.len();
        places.iter().all(inside).then_some(places)
    }

    /// Prepares the decay of a damper on inverse masses of the sum w; false where nothing relaxes.
    #[inline]
    fn relaxes(&mut self, c: f64, w: f64) -> bool {
        let rate = c * self.scale * w;
        // Neighbours are often alike, and an exponential costs as much as the rest.
        if rate != self.decay.rate || w != self.decay.w {
            let z = (-rate * self.h).min(EXPONENT);
            self.decay = Decay {
                rate,
                w,
                lost: -z.exp_m1() / w,
                kept: z.exp(),
                ..Decay::default()
            };
            if self.midpoint {
                self.decay.kept = (1.0 + 0.5 * z) / (1.0 - 0.5 * z);
                self.decay.lost = -z / (1.0 - 0.5 * z) / w;
            } else if self.a.is_some() {
                self.decay.pushed = self.h * phi1(z);
                self.decay.moved = self.h * self.h * phi2(z);
            }
        }
        rate != 0.0
    }

    /// The relative velocity after h, and what the damper adds to the relative displacement. Books the energy, of
    /// which `part` is the square of the velocities' unit.
    #[inline]
    fn relaxed(&mut self, u: f64, alpha: f64, part: f64) -> (f64, f64) {
        let (h, decay) = (self.h, self.decay);
        if self.a.is_none() {
            let after = decay.kept * u;
            self.dissipated += 0.5 * part * decay.lost * u * (u + after);
            return (after, 0.0);
        }
        let before = u - h * alpha;
        let after = decay.kept * before + decay.pushed * alpha;
        let moved = decay.moved * (alpha - decay.rate * before);
        let gain = 0.5 * (after - before) * (after + before);
        self.dissipated += part * (alpha * (h * before + moved) - gain) / decay.w;
        (after, moved - 0.5 * h * h * alpha)
    }
}

/// (e^z - 1) / z.
pub(crate) fn phi1(z: f64) -> f64 {
    if z == 0.0 { 1.0 } else { z.exp_m1() / z }
}

/// (e^z - 1 - z) / z².
pub(crate) fn phi2(z: f64) -> f64 {
    if z.abs() > 0.5 {
        return (z.exp_m1() - z) / z / z;
    }
    // The closed form cancels here; 16 terms of 1/2 + z/6 + z²/24 + ... reach rounding.
    (2..18)
        .rev()
        .fold(0.0, |sum, k| (sum * z + 1.0) / f64::from(k))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phi2_is_continuous_where_the_series_takes_over() {
        // Both sides of |z| = 1/2 agree to the closed form's cancellation, about 8 eps.
        for z in [0.5_f64, -0.5] {
            let closed = (z.exp_m1() - z) / z / z;
            assert!((phi2(z) - closed).abs() < 2e-15, "{z}");
        }
        assert_eq!(phi2(0.0), 0.5);
    }
}
