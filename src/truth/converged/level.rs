//! Both estimates on one mesh, and what follows from them.

use super::dormand_prince::DormandPrince;
use super::gragg::Gragg;
use super::mesh::Mesh;
use super::reference::STEPS;
use super::stepper::{Precise, Stepper, integrate};
use crate::physics::System;
use crate::truth::{States, farthest};

/// Estimates closer than this, relative to the size, have converged; and steps whose own error is
/// estimated to be smaller need no halving before others.
const TARGET: f64 = 1e-13;

/// Estimates closer than this, relative to the largest coordinate, have converged too.
const ROUNDING: f64 = 32.0 * f64::EPSILON;

/// Estimates that differ by this fraction of the size have lost the motion.
pub(super) const LOST: f64 = 0.1;

/// Both estimates on one mesh.
pub(super) struct Level {
    pub mesh: Mesh,
    pub first: States,
    /// Largest distance of the two up to each instant, m.
    pub gaps: Vec<f64>,
    /// Each piece's own error in position, m, and in velocity, m/s, as estimated.
    errors: Vec<[f64; 2]>,
}

impl Level {
    pub fn new(system: &(dyn System + Sync), start: &Precise, mesh: Mesh) -> Self {
        let mut errors = vec![[0.0_f64; 2]; mesh.pieces()];
        let note = |piece: usize, h: f64, method: &DormandPrince| {
            for (most, error) in errors[piece].iter_mut().zip(method.local_error(h)) {
                // A piece whose error is not finite needs halving too.
                *most = if error.is_finite() {
                    most.max(error)
                } else {
                    f64::INFINITY
                };
            }
        };
        let (first, second) = rayon::join(
            || integrate(DormandPrince::default(), system, start, &mesh, STEPS, note),
            || integrate(Gragg::default(), system, start, &mesh, 1, |_, _, _| {}),
        );
        Self {
            gaps: apart(&first, &second),
            mesh,
            first,
            errors,
        }
    }

    /// The mesh with those pieces halved whose own error is too large, or all if there are none;
    /// and whether it is all. Pieces long after the estimates have lost the motion can wait.
    pub fn halved(&self, size: f64, most: u64) -> (Mesh, bool) {
        let speed = largest(&self.first.v);
        let needed = |piece: usize| {
            let [position, velocity] = self.errors[piece];
            let excess = (position / size).max(velocity / speed) / TARGET;
            match excess {
                e if e.is_nan() || e <= 1.0 => 0,
                e if e.is_infinite() => 1,
                // The error is of order 8.
                e => (e.log2() / 8.0).ceil().clamp(1.0, 4.0) as u8,
            }
        };
        let kept = self.gaps.iter().take_while(|gap| **gap < LOST * size);
        let intervals = self.mesh.intervals();
        let reach = (kept.count() + intervals / 8).clamp(1, intervals);
        let pieces = self.mesh.range(reach - 1).end;
        let all = (0..pieces).all(|piece| needed(piece) == 0);
        let more = |piece| match piece {
            beyond if beyond >= pieces => 0,
            _ if all => 1,
            piece => needed(piece),
        };
        (self.mesh.refined(more, most), all)
    }

    /// Force evaluations a piece costs: as a level, and at the end (a third estimate, a neighbour and
    /// two noisy motions).
    pub fn costs() -> [u64; 2] {
        let first = u64::from(STEPS) * DormandPrince::default().evaluations();
        [first + Gragg::default().evaluations(), (2 + 3) * first]
    }

    /// The first estimate of another system, from another start or with other steps.
    pub fn again(&self, system: &dyn System, start: &Precise, each: u32) -> States {
        let method = DormandPrince::default();
        integrate(method, system, start, &self.mesh, each, |_, _, _| {})
    }

    /// Spreads values that hold up to each instant of a coarser level over the instants of this one.
    pub fn spread(&self, coarse: &[f64]) -> Vec<f64> {
        let instants = self.mesh.intervals();
        let ratio = (instants / (coarse.len() - 1).max(1)).max(1);
        let up_to = |k: usize| coarse.get(k.div_ceil(ratio)).or(coarse.last());
        (0..=instants)
            .map(|k| up_to(k).copied().unwrap_or(f64::INFINITY))
            .collect()
    }

    /// The factor by which gaps have shrunk from this level to a finer one, as the geometric mean
    /// over the instants where the finer one is neither at the target nor lost. Infinite where it is
    /// lost everywhere (smaller steps may still help), 1 where nothing lies between.
    pub fn shrunk_to(&self, finer: &Level, target: f64, size: f64) -> f64 {
        let lost = LOST * size;
        let before = finer.spread(&self.gaps);
        let (mut sum, mut between) = (0.0, 0_u64);
        for (before, after) in before.iter().zip(&finer.gaps) {
            if *after > target && *after < lost {
                sum += (before.min(size) / after).ln();
                between += 1;
            }
        }
        if between > 0 {
            return (sum / between as f64).exp();
        }
        // The start's gap is 0 in any case.
        let all_lost = finer.gaps.get(1).is_none_or(|gap| *gap >= lost);
        if all_lost { f64::INFINITY } else { 1.0 }
    }

    /// This size, or where it is 0 the largest distance from the start, m.
    pub fn size_or(&self, size: f64) -> f64 {
        if size > 0.0 {
            return size;
        }
        let start = self.first.x(0);
        let distances = (1..=self.mesh.intervals()).map(|k| farthest(self.first.x(k), start));
        distances.filter(|d| d.is_finite()).fold(0.0, f64::max)
    }

    /// Whether the first estimate leaves the finite numbers before the end.
    pub fn ends_early(&self) -> bool {
        !self.first.x.last().is_none_or(|x| x.is_finite())
    }

    /// Number of steps of the reference.
    pub fn steps(&self) -> u64 {
        self.mesh.pieces() as u64 * u64::from(STEPS)
    }

    /// Estimates closer than this, m, have converged.
    pub fn target(&self, size: f64) -> f64 {
        (TARGET * size).max(ROUNDING * largest(&self.first.x))
    }

    /// The last and largest gap, m.
    pub fn gap(&self) -> f64 {
        self.gaps.last().copied().unwrap_or(0.0)
    }
}

/// The largest finite magnitude.
pub(super) fn largest(values: &[f64]) -> f64 {
    let magnitudes = values.iter().map(|c| c.abs());
    magnitudes.filter(|c| c.is_finite()).fold(0.0, f64::max)
}

/// How far apart two motions of the same mesh have been up to each instant, m.
pub(super) fn apart(a: &States, b: &States) -> Vec<f64> {
    running_largest((0..a.len()).map(|k| farthest(a.x(k), b.x(k))))
}

/// For each value, the largest so far.
pub(super) fn running_largest(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let largest = values.scan(0.0, |most: &mut f64, value| {
        *most = most.max(value);
        Some(*most)
    });
    largest.collect()
}
