//! The plane pendulum on a rigid rod, by Jacobi's elliptic functions.

use super::super::{Motion, States};
use super::elliptic::{Jacobi, Modulus};
use super::vector::{across, norm, unit};
use nalgebra::Vector3;

/// A bob on a rigid rod, swinging in a plane or going round in it; no damping.
///
/// q'' = -w² sin q with w² = g / l has q = 2 asin(k sn(w t + u0, k)) where it swings, with
/// k² = sin²(q0 / 2) + (q0' / 2w)², and q = 2 am(k w t + u0, 1/k) where it goes round. Not to be
/// confused with the spring pendulum, which has no closed form.
#[derive(Debug, Clone)]
pub struct Pendulum {
    pivot: Vector3<f64>,
    /// Unit vectors: along gravity, and across it in the plane of motion.
    down: Vector3<f64>,
    side: Vector3<f64>,
    /// Length of the rod, m.
    length: f64,
    /// w, rad/s.
    w: f64,
    /// None where it swings; where it passes the top, 1 or -1 with the sign of its angular velocity.
    round: Option<f64>,
    /// k, over 1 where the pendulum goes round.
    energy: f64,
    /// What the start is known to, over a rounding.
    known: Known,
    modulus: Modulus,
    start: Jacobi,
}

/// Components that should be 0 may be this fraction of the vector: a few roundings of the file's
/// numbers and their products.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Half an angle from straight down, the cosine not negative.
struct Half {
    sin: f64,
    cos: f64,
    /// The absolute error of the cosine, over a rounding.
    off: f64,
}

/// Errors of the start, over a rounding.
#[derive(Debug, Clone, Copy)]
struct Known {
    /// Of half the angle and of half the rate over w. A disturbance grows by exp(w t) at most.
    absolute: f64,
    /// Of their digits, which the phase keeps.
    relative: f64,
    /// The relative error of 1 - k²: where it nears 0, its two terms cancel.
    complement: f64,
}

impl Pendulum {
    /// The pendulum through this angle from straight down (rad) with this angular velocity (rad/s),
    /// on a rod of `length` (m) under `gravity` (m/s²). It moves in the plane of x and z about the
    /// origin, z up, and x is positive where the angle is.
    ///
    /// None unless length and gravity are positive and all numbers finite.
    pub fn new(length: f64, gravity: f64, angle: f64, rate: f64) -> Option<Self> {
        let finite = [length, gravity, angle, rate].iter().all(|n| n.is_finite());
        if !(finite && length > 0.0 && gravity > 0.0) {
            return None;
        }
        let (sin, cos) = (0.5 * angle).sin_cos();
        // Half angles differ in sign by a turn; the cosine is kept positive.
        let (sin, cos) = if cos < 0.0 { (-sin, -cos) } else { (sin, cos) };
        let off = cos;
        Some(Self::from_half(
            length,
            gravity,
            Half { sin, cos, off },
            rate,
        ))
    }

    fn from_half(length: f64, gravity: f64, half: Half, rate: f64) -> Self {
        let w = (gravity / length).sqrt();
        let r = 0.5 * rate / w;
        let Half { sin, cos, off } = half;
        let energy = sin.hypot(r);
        // 1 - k², the root of each factor: their product may leave the range of a double.
        let (apart, together) = (cos - r.abs(), cos + r.abs());
        let complement = apart.abs().sqrt() * together.sqrt();
        // At rest at the top both are 0, and nothing is lost.
        let over = |a: f64, b: f64| if a == 0.0 { 0.0 } else { a / b };
        let known = Known {
            absolute: off + r.abs(),
            relative: 1.0 + over(off - cos, complement),
            complement: over(cos * off + r * r, complement * complement),
        };
        let (round, modulus, start) = if apart >= 0.0 {
            let (k, dn) = (energy, cos);
            let (sn, cn) = if energy > 0.0 {
                (sin / energy, r / energy)
            } else {
                (0.0, 1.0)
            };
            (None, Modulus { k, complement }, Jacobi { sn, cn, dn })
        } else {
            let (k, complement) = (1.0 / energy, complement / energy);
            let (sn, cn, dn) = (sin, cos, r.abs() / energy);
            let jacobi = Jacobi { sn, cn, dn };
            (Some(r.signum()), Modulus { k, complement }, jacobi)
        };
        Self {
            pivot: Vector3::zeros(),
            down: -Vector3::z(),
            side: Vector3::x(),
            length,
            w,
            round,
            energy,
            known,
            modulus,
            start,
        }
    }

    /// The pendulum of a bob at this position and velocity, on a rod from `pivot`, under this
    /// acceleration of gravity (m, m/s, m/s²).
    ///
    /// None if the rod or gravity is zero, or the motion leaves a vertical plane.
    pub fn hung(
        pivot: [f64; 3],
        position: [f64; 3],
        velocity: [f64; 3],
        gravity: [f64; 3],
    ) -> Option<Self> {
        let [pivot, position, velocity, gravity] =
            [pivot, position, velocity, gravity].map(Vector3::from);
        let rod = position - pivot;
        let (length, speed) = (norm(rod), norm(velocity));
        let (down, along) = (unit(gravity)?, unit(rod)?);
        let out = |v: Vector3<f64>| v - down * v.dot(&down);
        // Twice: what rounding leaves along `down` is much of a vector that nearly is along it.
        let outward = |v: Vector3<f64>| unit(out(unit(out(v))?));
        // Along an axis nothing is lost where a vector is split.
        let exact = gravity.iter().filter(|c| **c != 0.0).count() == 1;
        // The plane is the rod's, or the velocity's where the rod hangs or stands straight.
        let least = if exact && speed == 0.0 { 0.0 } else { ROUNDING };
        let leans = across(rod, down) > least * length;
        let side = if leans {
            outward(along)?
        } else if speed > 0.0 {
            outward(velocity)?
        } else {
            outward(Vector3::ith(down.iamin(), 1.0))?
        };
        let (sin, cos) = (along.dot(&side), along.dot(&down));
        let ahead = side * cos - down * sin;
        let forward = velocity.dot(&ahead);
        if norm(velocity - ahead * forward) > ROUNDING * speed {
            return None;
        }
        // What is left out of the plane is an error of the start.
        let aside = if leans {
            0.0
        } else {
            norm(out(along) - side * sin)
        };
        let split = if exact { 0.0 } else { 2.0 };
        let half = Half::of(sin, cos, split + aside / f64::EPSILON);
        let found = Self::from_half(length, norm(gravity), half, forward / length);
        Some(Self {
            pivot,
            down,
            side,
            ..found
        })
    }

    /// Time of one swing there and back, or of one turn, s; infinite where it only just reaches
    /// the top.
    pub fn period(&self) -> f64 {
        let quarter = self.modulus.quarter_period();
        match self.round {
            None => 4.0 * quarter / self.w,
            Some(_) => 2.0 * quarter / (self.energy * self.w),
        }
    }

    /// Angle from straight down at `t`, rad, in (-π, π].
    pub fn angle(&self, t: f64) -> f64 {
        let (sin, cos, _) = self.half(t);
        // Half angles a turn apart are the same angle; the cosine is taken positive.
        let turned = if cos < 0.0 { -1.0 } else { 1.0 };
        2.0 * (turned * sin).atan2(turned * cos)
    }

    /// Angular velocity at `t`, rad/s.
    pub fn rate(&self, t: f64) -> f64 {
        self.half(t).2
    }

    /// Sine and cosine of half the angle, and the angular velocity.
    fn half(&self, t: f64) -> (f64, f64, f64) {
        let Self { w, energy, .. } = *self;
        let u = self.round.map_or(1.0, |way| way * energy) * w * t;
        let Jacobi { sn, cn, dn } = self.start.plus(&self.modulus.at(u), &self.modulus);
        let (sin, cos, rate) = match self.round {
            None => (energy * sn, dn, 2.0 * w * energy * cn),
            Some(way) => (sn, cn, way * 2.0 * w * energy * dn),
        };
        // Both have their own rounding; the bob stays on its circle.
        let one = sin.hypot(cos);
        (sin / one, cos / one, rate)
    }
}

/// The motion of the bob alone: states of three coordinates.
impl Motion for Pendulum {
    fn states(&self, times: &[f64]) -> States {
        let mut states = States::with_room(3, times.len());
        for &t in times {
            let (sin, cos, rate) = self.half(t);
            // Sine and cosine of the whole angle.
            let (sin, cos) = (2.0 * sin * cos, (cos - sin) * (cos + sin));
            let (down, side) = (self.length * self.down, self.length * self.side);
            let x = self.pivot + cos * down + sin * side;
            let v = rate * (cos * side - sin * down);
            states.push(x.as_slice(), v.as_slice());
        }
        states
    }

    /// The phase is off by 16 eps (1 + w t), with the speed's rate k w for w, and more near the energy that only just
    /// reaches the top: there the period goes like log |1 - k²|, of which few digits are left. Or the start is off by
    /// 8 eps, which grows by exp(w t) at most, whichever is less.
    fn error_bar(&self, t: f64) -> f64 {
        let Self { w, known, .. } = *self;
        let phase = w * self.energy * t;
        let periods = phase / self.modulus.quarter_period();
        let kept = known.relative * (1.0 + phase) + known.complement * periods;
        let grown = 1.0 + phase + 0.5 * known.absolute * (w * t).exp();
        // `min` takes the other of what is 0 times infinity: k' of 0, or the top itself.
        let bar = 16.0 * f64::EPSILON * self.length * kept.min(grown);
        // The bob is on its circle in any case, even where the phase is not known at all.
        bar.min(2.0 * self.length) + f64::EPSILON * (norm(self.pivot) + self.length)
    }
}

impl Half {
    /// Half the angle of this sine and cosine, without cancellation. `off` is the sine's absolute error, over a rounding,
    /// beside that of its last digit.
    fn of(sin: f64, cos: f64, off: f64) -> Self {
        let larger = (0.5 * (1.0 + cos.abs())).sqrt();
        let smaller = 0.5 * sin / larger;
        let (sin, cos) = if cos >= 0.0 {
            (smaller, larger)
        } else if smaller < 0.0 {
            (-larger, -smaller)
        } else {
            (larger, smaller)
        };
        let off = off + cos;
        Self { sin, cos, off }
    }
}
