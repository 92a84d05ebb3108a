//! Up to which step nothing changes sign from one step to the next.

use super::difference::Quadratic;
use super::limit::Make;
use super::probe::Budget;
use super::shake::Shake;
use crate::scene::Scene;
use crate::system::{ForceKinds, Jacobian, Linearization, ParticleSystem, System};
use nalgebra::{DMatrix, Schur};

/// Differences taken of the run: the k-th multiplies each mode by (R - 1)^k, which leaves the mode
/// whose R is farthest below 1, the first to turn negative, and costs 2^k roundings.
const DIFFERENCES: usize = 16;
/// Times this is repeated from where it led.
const ROUNDS: usize = 6;
/// Roundings in a velocity.
const ROUNDINGS: f64 = 16.0;
/// How far above rounding a difference is believed.
const MARGIN: f64 = 1e3;
/// Squared sine from which differences are not parallel, and what it leaves of rounding in factors.
const APART: f64 = 1e-8;
const NOISE: f64 = 1e-6;
/// Relative width of the answer.
const WIDTH: f64 = 5e-4;
/// Iterations after which the spectrum is given up.
const SWEEPS: usize = 100_000;
/// Coordinates beyond which the true motion's spectrum is not looked at.
const LARGEST: usize = 300;
/// Steps beyond this many shortest time scales are not tried.
const FAR: f64 = 1e3;

/// The largest step, s, at which every decaying motion decays without changing sign from step to
/// step, on a linear map, searched up to its limit `upto`; None where something oscillates in truth,
/// nothing decays, the scene is too large, or, without a limit, no step up to a thousand of the
/// shortest time scales `unit` changes sign.
pub(super) fn below(
    scene: &Scene,
    system: &ParticleSystem,
    make: &Make,
    unit: f64,
    upto: Option<f64>,
    budget: &mut Budget,
) -> Option<f64> {
    if !system.kinds().has(ForceKinds::DISSIPATIVE) || oscillates(scene, system)? {
        return None;
    }
    let mut quadratic = Quadratic::new(system);
    let start = Shake::large(scene, system, &mut |dx| quadratic.potential(dx));
    let mut smooth = |h: f64| -> Option<bool> {
        budget.spend((2 * ROUNDS * (DIFFERENCES + 2)) as u64);
        sign_kept(scene, system, make, &start, h)
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
    while high - low > WIDTH * low {
        let middle = 0.5 * (low + high);
        if smooth(middle)? {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(low)
}

/// Whether the mode that decays fastest keeps its sign in a step: whether its factor, told from
/// successive differences of high order, is real and not negative.
fn sign_kept(
    scene: &Scene,
    system: &ParticleSystem,
    make: &Make,
    start: &Shake,
    h: f64,
) -> Option<bool> {
    let size = norm(system, start);
    let mut shape = start.clone();
    let mut kept = None;
    for _ in 0..ROUNDS {
        let differences = differences(scene, system, make, &shape, h)?;
        let Some(Differences { rows, rounding }) = differences else {
            // Not finite: nothing decays.
            return Some(false);
        };
        let [first, second, third] = &rows;
        let length = norm(system, first);
        let of = |a: &Shake, b: &Shake| product(system, a, b);
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

/// Three successive differences of one order, and what of them is rounding.
struct Differences {
    rows: [Shake; 3],
    rounding: f64,
}

/// Of the motion's own disturbance `shape`; the inner None where it leaves the finite numbers.
fn differences(
    scene: &Scene,
    system: &ParticleSystem,
    make: &Make,
    shape: &Shake,
    h: f64,
) -> Option<Option<Differences>> {
    let mut from = make(scene, h).ok()?;
    let mut other = make(&shape.apply(scene), h).ok()?;
    let mut rows: Vec<Shake> = Vec::with_capacity(DIFFERENCES + 3);
    let mut largest = 0.0_f64;
    for step in 0..DIFFERENCES + 3 {
        if step > 0 {
            from.step().ok()?;
            other.step().ok()?;
        }
        let (a, b) = (from.state(), other.state());
        if !a.is_finite() || !b.is_finite() {
            return Some(None);
        }
        largest = largest.max(system.kinetic(&b.v).sqrt());
        rows.push(
            Shake {
                x: b.x.clone(),
                v: b.v.clone(),
            }
            .minus(&Shake {
                x: a.x.clone(),
                v: a.v.clone(),
            }),
        );
    }
    let mut rounding = largest * f64::EPSILON * ROUNDINGS;
    for _ in 0..DIFFERENCES {
        rounding *= 2.0;
        let next: Vec<Shake> = rows
            .windows(2)
            .filter_map(|pair| match pair {
                [a, b] => Some(b.minus(a)),
                _ => None,
            })
            .collect();
        // What is left near 1 is differenced away long before any sign is in question.
        let lost = |row: &Shake| norm(system, row) <= MARGIN * rounding;
        if next.first().is_none_or(lost) {
            break;
        }
        rows = next;
    }
    let mut rows = rows.into_iter();
    let rows = [rows.next()?, rows.next()?, rows.next()?];
    Some(Some(Differences { rows, rounding }))
}

/// Of velocities, weighted by mass, in which modes are orthogonal where they are at all.
fn product(system: &ParticleSystem, a: &Shake, b: &Shake) -> f64 {
    let weights = system.inverse_mass();
    let pairs = a.v.iter().zip(&b.v).zip(weights);
    pairs
        .filter(|(_, w)| **w > 0.0)
        .map(|((a, b), w)| a * b / w)
        .sum()
}

fn norm(system: &ParticleSystem, shape: &Shake) -> f64 {
    product(system, shape, shape).sqrt()
}

/// Whether the linearised scene has an eigenvalue that is not real. None where it is too large to
/// ask.
fn oscillates(scene: &Scene, system: &ParticleSystem) -> Option<bool> {
    let weights = system.inverse_mass();
    let free: Vec<usize> = (0..weights.len()).filter(|i| weights[*i] > 0.0).collect();
    let n = free.len();
    if n == 0 || n > LARGEST {
        return None;
    }
    let start = ParticleSystem::initial_state(scene);
    let mut jacobian = Jacobian::default();
    system.jacobian(0.0, &start.x, &start.v, Linearization::Exact, &mut jacobian);
    let mut place = vec![None; weights.len()];
    for (at, i) in free.iter().enumerate() {
        if let Some(place) = place.get_mut(*i) {
            *place = Some(at);
        }
    }
    let mut matrix = DMatrix::<f64>::zeros(2 * n, 2 * n);
    for i in 0..n {
        matrix[(i, n + i)] = 1.0;
    }
    for (offset, triplets) in [(0, &jacobian.position), (n, &jacobian.velocity)] {
        for (row, column, value) in triplets {
            let at = |i: &usize| place.get(*i).copied().flatten();
            if let (Some(r), Some(c), Some(w)) = (at(row), at(column), weights.get(*row)) {
                matrix[(n + r, offset + c)] += value * w;
            }
        }
    }
    if !matrix.iter().all(|entry| entry.is_finite()) {
        return None;
    }
    let eigenvalues = Schur::try_new(matrix, f64::EPSILON, SWEEPS)?.complex_eigenvalues();
    let largest = eigenvalues.iter().map(|e| e.norm()).fold(0.0, f64::max);
    // A double eigenvalue, as at critical damping, is known to the square root of rounding only.
    Some(eigenvalues.iter().any(|e| e.im.abs() > 1e-6 * largest))
}
