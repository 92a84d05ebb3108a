//! The largest step at which nothing changes sign from one step to the next.

use super::experiment::Experiment;
use super::perturbation::Perturbation;
use super::search::{WIDTH, bisect};
use crate::measure::stability::{Effort, Linearised};
use crate::physics::{ForceKinds, ParticleSystem, System};
use crate::scene::Scene;

/// Differences taken of the run: the k-th multiplies each mode by (R - 1)^k, which leaves the mode
/// whose R is farthest below 1, the first to turn negative, and costs 2^k roundings.
const DIFFERENCES: usize = 16;
/// Times the differences are taken anew from where they led.
const ROUNDS: usize = 6;
/// Roundings in a velocity.
const ROUNDINGS: f64 = 16.0;
/// How far above rounding a difference is believed.
const MARGIN: f64 = 1e3;
/// Squared sine from which differences are not parallel, and the rounding that it leaves in factors.
const APART: f64 = 1e-8;
const NOISE: f64 = 1e-6;
/// Coordinates beyond which the true motion's spectrum is not looked at.
const LARGEST: usize = 300;
/// Steps beyond this many shortest time scales are not tried.
const FAR: f64 = 1e3;

/// The largest step, s, at which every decaying motion decays without changing sign from step to
/// step, on a linear map, searched up to its limit `upto`; None where something oscillates in truth,
/// nothing decays, the scene is too large, or, without a limit, no step up to a thousand of the
/// shortest time scales changes sign.
pub(super) fn below(experiment: &mut Experiment, upto: Option<f64>) -> Option<f64> {
    let decays = experiment.system.kinds().has(ForceKinds::DISSIPATIVE);
    if !decays || may_oscillate(experiment.scene, experiment.system) {
        return None;
    }
    let unit = experiment.unit;
    let mut smooth = |h: f64| -> Option<bool> {
        experiment
            .budget
            .spend((2 * ROUNDS * (DIFFERENCES + 2)) as u64, 0);
        sign_kept(experiment, h)
    };
    let end = upto.unwrap_or(FAR * unit);
    let mut low = (unit / 16.0).min(0.5 * end);
    if !smooth(low)? {
        return None;
    }
    let mut high = low;
    loop {
        if high >= end {
            // Nothing decays beyond the limit.
            return upto;
        }
        high = (2.0 * high).min(end);
        if !smooth(high)? {
            break;
        }
        low = high;
    }
    bisect(low, high, WIDTH, |h| smooth(h).ok_or(())).ok()
}

/// Whether the mode that decays fastest keeps its sign in a step: whether its factor, told from
/// successive differences of high order, is real and not negative.
fn sign_kept(experiment: &Experiment, h: f64) -> Option<bool> {
    let system = experiment.system;
    let mut shape = experiment.perturbation.clone();
    let size = norm(system, &shape);
    let mut kept = None;
    for _ in 0..ROUNDS {
        let differences = differences(experiment, &shape, h)?;
        let Some(Differences { rows, rounding }) = differences else {
            // A run that is not finite does not decay.
            return Some(false);
        };
        let [first, second, third] = &rows;
        let length = norm(system, first);
        let of = |a: &Perturbation, b: &Perturbation| product(system, a, b);
        let (aa, ab, bb) = (of(first, first), of(first, second), of(second, second));
        // Two modes are left where the rows are not parallel: third = sum second - product first, sum
        // and product being those of their factors.
        let det = aa * bb - ab * ab;
        kept = Some(if det > APART * aa * bb {
            let (ac, bc) = (of(first, third), of(second, third));
            let half = 0.5 * (bc * aa - ac * ab) / det;
            let apart = half * half - (bc * ab - ac * bb) / det;
            let noise = NOISE * half * half;
            apart >= -noise && half - apart.max(0.0).sqrt() >= -NOISE
        } else {
            // A mode that one step brings to nothing has no sign.
            ab >= -rounding * length
        });
        if length <= 0.0 {
            break;
        }
        shape = first.scaled(size / length);
    }
    kept
}

/// Three successive differences of one order, and their rounding.
struct Differences {
    rows: [Perturbation; 3],
    rounding: f64,
}

/// The differences of the perturbation `shape`; the inner None where it leaves the finite numbers.
fn differences(
    experiment: &Experiment,
    shape: &Perturbation,
    h: f64,
) -> Option<Option<Differences>> {
    let system = experiment.system;
    let mut runs = experiment.pair(h, shape).ok()?;
    let mut rows: Vec<Perturbation> = Vec::with_capacity(DIFFERENCES + 3);
    let mut largest = 0.0_f64;
    for step in 0..DIFFERENCES + 3 {
        if step > 0 {
            runs.step().ok()?;
        }
        if !runs.state(0).is_finite() || !runs.state(1).is_finite() {
            return Some(None);
        }
        largest = largest.max(system.kinetic(&runs.state(1).v).sqrt());
        rows.push(runs.difference(1));
    }
    let mut rounding = largest * f64::EPSILON * ROUNDINGS;
    for _ in 0..DIFFERENCES {
        rounding *= 2.0;
        let pairs = rows.iter().zip(&rows[1..]);
        let next: Vec<_> = pairs.map(|(a, b)| b.minus(a)).collect();
        // What is left near 1 is differenced away long before any sign is in question.
        let lost = |row: &Perturbation| norm(system, row) <= MARGIN * rounding;
        if next.first().is_none_or(lost) {
            break;
        }
        rows = next;
    }
    let mut rows = rows.into_iter();
    let rows = [rows.next()?, rows.next()?, rows.next()?];
    Some(Some(Differences { rows, rounding }))
}

/// The product of velocities weighted by mass, in which modes are orthogonal where they are at all.
fn product(system: &ParticleSystem, a: &Perturbation, b: &Perturbation) -> f64 {
    let weights = system.inverse_mass();
    let pairs = a.v.iter().zip(&b.v).zip(weights);
    pairs
        .filter(|(_, w)| **w > 0.0)
        .map(|((a, b), w)| a * b / w)
        .sum()
}

fn norm(system: &ParticleSystem, shape: &Perturbation) -> f64 {
    product(system, shape, shape).sqrt()
}

/// Whether the linearised scene has an eigenvalue that is not real, or is too large for that to be
/// computed.
fn may_oscillate(scene: &Scene, system: &ParticleSystem) -> bool {
    let free = system.inverse_mass().iter().filter(|w| **w > 0.0).count();
    if free == 0 || free > LARGEST {
        return true;
    }
    let start = ParticleSystem::initial_state(scene);
    let linearised = Linearised::new(system, &start, Effort::FULL);
    linearised.is_unsure() || linearised.omega_max().is_some()
}
