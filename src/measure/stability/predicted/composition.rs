//! Products of drifts and kicks on one mode: 2 x 2 maps.

use super::Limit;
use super::mode::Mode;
use super::verdict::Verdict;
use crate::integrators::{DampingTreatment, Stage};

/// The map of one step on (x, v), row-major.
pub(super) fn map(stages: &[Stage], damping: DampingTreatment, mode: Mode, h: f64) -> [f64; 4] {
    let Mode {
        stiffness: k,
        damping: c,
    } = mode;
    stages
        .iter()
        .fold([1.0, 0.0, 0.0, 1.0], |[a, b, p, q], stage| match *stage {
            Stage::Drift(part) => {
                let step = part * h;
                [a + step * p, b + step * q, p, q]
            }
            Stage::Kick(part) => {
                let step = part * h;
                let (kept, pushed) = match damping {
                    DampingTreatment::Explicit => (1.0 - step * c, step),
                    DampingTreatment::ExactFlow => ((-step * c).exp(), step * phi1(-step * c)),
                };
                [a, b, kept * p - pushed * k * a, kept * q - pushed * k * b]
            }
        })
}

/// (e^z - 1) / z.
pub(super) fn phi1(z: f64) -> f64 {
    if z == 0.0 { 1.0 } else { z.exp_m1() / z }
}

/// What the map's eigenvalues are.
struct Pair {
    trace: f64,
    determinant: f64,
}

/// A modulus above 1 by no more than this is rounding of a composition of nine factors.
const ROUNDING: f64 = 1e-12;

impl Pair {
    fn new([a, b, c, d]: [f64; 4]) -> Self {
        Self {
            trace: a + d,
            determinant: a * d - b * c,
        }
    }

    /// Jury's conditions: both eigenvalues within the unit circle.
    fn is_stable(&self) -> bool {
        self.determinant <= 1.0 + ROUNDING && 1.0 + self.determinant - self.trace.abs() >= -ROUNDING
    }

    /// Both real and not negative, or so close to a double real one that only rounding parts them.
    fn is_smooth(&self) -> bool {
        let half = 0.5 * self.trace;
        self.determinant >= 0.0
            && half >= 0.0
            && half * half - self.determinant >= -ROUNDING * half * half
    }

    fn modulus(&self) -> f64 {
        let half = 0.5 * self.trace;
        let disc = half * half - self.determinant;
        if disc < 0.0 {
            self.determinant.abs().sqrt()
        } else {
            half.abs() + disc.sqrt()
        }
    }
}

/// ln |largest eigenvalue| / h; a mode without stiffness also has the eigenvalue 1, of its place.
pub(super) fn growth(stages: &[Stage], damping: DampingTreatment, mode: Mode, h: f64) -> f64 {
    let map = map(stages, damping, mode, h);
    let modulus = if mode.stiffness == 0.0 {
        map[3].abs()
    } else {
        Pair::new(map).modulus()
    };
    modulus.clamp(f64::MIN_POSITIVE, f64::MAX).ln() / h
}

/// Cells a scan takes, in units of the mode's rate; then in parts of how far it has come.
const CELL: f64 = 0.01;
/// Nothing of what a method promises begins below; far above, limits are those of drag's flow.
const NEAR: f64 = 0.02;
const FAR: f64 = 1e12;

/// The first h, at most `upto`, at which `holds` no longer does, by a scan and bisection.
pub(super) fn first_failure(rate: f64, upto: f64, holds: &dyn Fn(f64) -> bool) -> Option<f64> {
    let mut before = 0.0;
    let mut u = NEAR;
    while u < FAR {
        let h = (u / rate).min(upto);
        if !holds(h) {
            let (mut low, mut high) = (before, h);
            while high - low > 1e-14 * high {
                let middle = 0.5 * (low + high);
                if middle <= low || middle >= high {
                    break;
                }
                if holds(middle) {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            return Some(low);
        }
        if h >= upto {
            return None;
        }
        before = h;
        u += CELL * u.max(1.0);
    }
    None
}

/// Of all modes together. `closed` gives the limit of a mode where a formula is known.
pub(super) fn judge(
    stages: &[Stage],
    damping: DampingTreatment,
    modes: &[Mode],
    h: f64,
    closed: Option<&dyn Fn(Mode) -> Option<f64>>,
) -> Option<Verdict> {
    let mut sorted = modes.to_vec();
    // The fastest first: it usually binds, and bounds how far the others are searched.
    sorted.sort_by(|a, b| b.rate().total_cmp(&a.rate()));
    let mut upto = f64::INFINITY;
    let mut all: Option<Verdict> = None;
    for mode in sorted {
        let found = match closed {
            Some(closed) => closed(mode),
            None => {
                let stable = |h: f64| {
                    let map = map(stages, damping, mode, h);
                    if mode.stiffness == 0.0 {
                        decays(stages, damping, mode, h)
                    } else {
                        Pair::new(map).is_stable()
                    }
                };
                first_failure(mode.rate(), upto, &stable)
            }
        };
        let limit = found.map_or(Limit::Unconditional, |found| {
            upto = upto.min(found);
            Limit::At(found)
        });
        let growth = growth(stages, damping, mode, h);
        let smooth = (!mode.oscillates()).then(|| smooth(stages, damping, mode, upto));
        let one = Verdict::of(limit, growth, smooth.flatten(), h, mode);
        all = Some(match all {
            Some(all) => all.and(one),
            None => one,
        });
    }
    all
}

/// A mode under damping alone: its velocity's factor is a product of the kicks' own.
fn decays(stages: &[Stage], damping: DampingTreatment, mode: Mode, h: f64) -> bool {
    damping == DampingTreatment::ExactFlow || {
        let factor = map(stages, damping, mode, h)[3];
        factor.abs() <= 1.0 + ROUNDING
    }
}

fn smooth(stages: &[Stage], damping: DampingTreatment, mode: Mode, upto: f64) -> Option<f64> {
    let holds = |h: f64| {
        if mode.stiffness == 0.0 {
            damping == DampingTreatment::ExactFlow || map(stages, damping, mode, h)[3] >= 0.0
        } else {
            Pair::new(map(stages, damping, mode, h)).is_smooth()
        }
    };
    let found = first_failure(mode.rate(), upto, &holds).unwrap_or(upto);
    // Whoever oscillates from the first cell on is not smooth up to anything worth saying.
    (found > NEAR / mode.rate() * 0.5).then_some(found)
}
