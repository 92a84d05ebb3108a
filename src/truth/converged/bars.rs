//! The error bar of the reference, from a third estimate, a neighbour and magnified rounding.

use super::level::{Level, apart, largest, running_largest};
use super::mesh::Mesh;
use super::rate::scatter;
use super::reference::STEPS;
use super::stepper::Precise;
use crate::physics::constraints::Rods;
use crate::physics::constraints::contact::Obstacles;
use crate::physics::{Power, System};
use std::cell::RefCell;

/// The bar is this many times the distance of the estimates plus the effect of rounding: two errors
/// of one kind and one sign differ by less than either.
const CAUTION: f64 = 3.0;

/// The neighbour starts this far away, relative to the size: its distance keeps eight digits, and
/// eight orders of magnitude are left to grow through.
const OFFSET: f64 = 1e-8;

impl Level {
    /// The largest distance, m, up to each instant, of the first estimate from the second and from
    /// a third, which is the first at half the step. Two estimates may meet by chance once one
    /// growing mode is all that is left of their errors, but they rarely meet the third as well.
    pub fn gaps_of_three(&self, system: &(dyn System + Sync), start: &Precise) -> Vec<f64> {
        let third = self.again(system, start, 2 * STEPS);
        let gaps = apart(&self.first, &third).into_iter().zip(&self.gaps);
        gaps.map(|(third, second)| third.max(*second)).collect()
    }

    /// How far a motion that starts beside this one has parted from it up to each instant, in units of
    /// their distance at the start: at least 1, infinite where one is not finite.
    pub fn amplification(
        &self,
        system: &(dyn System + Sync),
        start: &Precise,
        size: f64,
    ) -> Vec<f64> {
        // Every free coordinate is moved, each by a fixed fraction of the offset.
        let mut beside = start.clone();
        let coordinates = beside.x.iter_mut().zip(system.inverse_mass()).enumerate();
        for (at, (x, inverse_mass)) in coordinates {
            if *inverse_mass > 0.0 {
                *x += OFFSET * size * scatter(at);
            }
        }
        let mut distances = apart(&self.first, &self.again(system, &beside, STEPS));
        let first = distances.first().copied().unwrap_or(0.0);
        for distance in &mut distances {
            *distance = if first > 0.0 { *distance / first } else { 1.0 };
        }
        distances
    }

    /// How far rounding may have led the first estimate astray up to each instant, m: the farther of
    /// two motions with magnified rounding, scaled back.
    pub fn rounding(&self, system: &(dyn System + Sync), start: &Precise) -> Vec<f64> {
        let astray = |seed| {
            let noisy = Noisy::new(system, seed);
            apart(&self.first, &self.again(&noisy, start, STEPS))
        };
        let (one, other) = rayon::join(|| astray(1), || astray(2));
        let farther = one.iter().zip(&other).map(|(a, b)| a.max(*b));
        farther.map(|distance| distance / MAGNIFIED).collect()
    }

    /// The error bar at each instant, m. `rounding` is how far rounding may have led the motion astray, m, `unseen` what
    /// bounces that are not seen any more may, m.
    pub fn bars(&self, rounding: &[f64], unseen: f64) -> Vec<f64> {
        let instants = 0..=self.mesh.intervals();
        let magnitudes = running_largest(instants.map(|k| largest(self.first.x(k))));
        let off = self.gaps.iter().zip(rounding).zip(magnitudes);
        off.map(|((gap, rounding), m)| CAUTION * (gap + rounding) + f64::EPSILON * m + unseen)
            .collect()
    }
}

/// The rate at which neighbours part, 1/s: the slope of ln(amplification) over time. None unless an
/// exponential describes the later growth better than a power of time, and has run through at least
/// e³: neighbours of regular motion part linearly.
pub(super) fn growth_rate(amplification: &[f64], mesh: &Mesh) -> Option<f64> {
    // Beyond a thousandth of the size, distances no longer grow as small ones do.
    let small = |factor: &f64| *factor < 1e-3 / OFFSET;
    let end = amplification.iter().take_while(|f| small(f)).count();
    let from = (end / 8).max(1);
    if end < from + 8 {
        return None;
    }
    let fit = |time: fn(f64) -> f64| {
        let instants = (from..end).map(|k| [time(mesh.time(k)), amplification[k].ln()]);
        least_squares(&instants.collect::<Vec<_>>())
    };
    let ([rate, misfit], [_, misfit_of_a_power]) = (fit(|t| t)?, fit(f64::ln)?);
    let gained = rate * (mesh.time(end - 1) - mesh.time(from));
    (gained > 3.0 && misfit < misfit_of_a_power).then_some(rate)
}

/// Slope of the least-squares line through these points, and the sum of its squared residuals.
fn least_squares(points: &[[f64; 2]]) -> Option<[f64; 2]> {
    let n = points.len() as f64;
    let mean = |c: usize| points.iter().map(|p| p[c]).sum::<f64>() / n;
    let (x_mean, y_mean) = (mean(0), mean(1));
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for [x, y] in points {
        let (dx, dy) = (x - x_mean, y - y_mean);
        xx += dx * dx;
        xy += dx * dy;
        yy += dy * dy;
    }
    (xx > 0.0).then(|| [xy / xx, yy - xy * xy / xx])
}

/// Noise is this many times a last bit: far above rounding, far below everything else.
const MAGNIFIED: f64 = 4096.0;

/// A system seen through noise: positions and velocities on the way in and accelerations on the way
/// out are off by up to [`MAGNIFIED`] last bits, each by an amount that its own bits and the seed
/// decide. A motion computed with it leaves the true one as rounding makes it leave, but faster by
/// the same factor; two estimates that happen to be rounded alike do not hide that.
///
/// The idea of CESTAC (Vignes 1993), with noise well above what it stands for.
struct Noisy<'a> {
    system: &'a dyn System,
    seed: u64,
    /// Positions and velocities as the system sees them.
    seen: RefCell<[Vec<f64>; 2]>,
}

impl<'a> Noisy<'a> {
    fn new(system: &'a dyn System, seed: u64) -> Self {
        let zero = vec![0.0; system.dim()];
        Self {
            system,
            seed,
            seen: RefCell::new([zero.clone(), zero]),
        }
    }

    fn off(&self, value: f64) -> f64 {
        value + value * (MAGNIFIED * f64::EPSILON * uniform(value.to_bits() ^ self.seed))
    }
}

impl System for Noisy<'_> {
    fn dim(&self) -> usize {
        self.system.dim()
    }
    fn inverse_mass(&self) -> &[f64] {
        self.system.inverse_mass()
    }
    fn acceleration(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        let mut seen = self.seen.borrow_mut();
        let [seen_x, seen_v] = &mut *seen;
        for (at, inverse_mass) in self.inverse_mass().iter().enumerate() {
            // Fixed coordinates keep their values.
            let free = *inverse_mass > 0.0;
            seen_x[at] = if free { self.off(x[at]) } else { x[at] };
            seen_v[at] = if free { self.off(v[at]) } else { v[at] };
        }
        let power = self.system.acceleration(t, seen_x, seen_v, a);
        for a in a {
            *a = self.off(*a);
        }
        power
    }
    fn rods(&self) -> Option<&Rods> {
        self.system.rods()
    }
    fn obstacles(&self) -> Option<&Obstacles> {
        self.system.obstacles()
    }
    fn place(&self, t: f64, x: &mut [f64], v: &mut [f64]) {
        self.system.place(t, x, v);
    }
    fn jumps(&self) -> &[f64] {
        self.system.jumps()
    }
    fn potential(&self, t: f64, x: &[f64]) -> f64 {
        self.system.potential(t, x)
    }
}

/// A number in [-1, 1) from all bits of another (Stafford's variant 13 of MurmurHash3's finisher).
fn uniform(mut bits: u64) -> f64 {
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    bits ^= bits >> 31;
    (bits >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}
