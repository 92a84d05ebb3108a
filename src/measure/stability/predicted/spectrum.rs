//! The modes of one part of a linearised scene.

use super::Effort;
use super::krylov;
use super::mode::Mode;
use super::parts::Part;
use crate::measure::stability::matrix::Matrix;
use faer::{Mat, Side};
use nalgebra::Complex;

/// What is known of a part's modes; those at rest and those unstable in truth are left out.
#[derive(Debug, Clone)]
pub(super) enum Spectrum {
    /// All, where damping acts on each mode by itself (C a combination of K and 1).
    Modes(Vec<Mode>),
    /// All eigenvalues with Im >= 0 of (x, v)' = (v, -K x - C v).
    Roots(Vec<Complex<f64>>),
    /// A sample of a large part's modes, damped by themselves, the last the stiffest.
    Sampled(Vec<Mode>),
    /// A large part's outermost eigenvalues, the farthest first; the others lie within the last. None
    /// where they are too close together to be found.
    Outermost {
        roots: Vec<Complex<f64>>,
        bound: Option<Bound>,
    },
}

/// What is known without any eigenvalue.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bound {
    /// The stiffest vector, as a mode.
    pub stiffest: Mode,
    /// Within it all eigenvalues lie, 1/s.
    pub radius: f64,
}

impl Spectrum {
    /// The largest frequency of what oscillates, rad/s.
    pub(super) fn omega_max(&self) -> Option<f64> {
        let fastest = |modes: &[Mode]| {
            let oscillating = modes.iter().filter(|mode| mode.oscillates());
            oscillating.map(|mode| mode.omega()).max_by(f64::total_cmp)
        };
        let fastest_root = |roots: &[Complex<f64>]| {
            let oscillating = roots.iter().filter(|root| root.im > 0.0);
            oscillating.map(|root| root.norm()).max_by(f64::total_cmp)
        };
        match self {
            Self::Modes(modes) | Self::Sampled(modes) => fastest(modes),
            Self::Roots(roots) => fastest_root(roots),
            // Roots may be decays only, while others within them oscillate.
            Self::Outermost { roots, bound } => {
                fastest_root(roots).or_else(|| fastest(&[bound.as_ref()?.stiffest]))
            }
        }
    }
}

/// Modes that are left out.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct LeftOut {
    /// Without restoring force.
    pub at_rest: usize,
    /// Growing in truth.
    pub unstable: usize,
}

/// A part and its modes.
#[derive(Debug, Clone)]
pub(super) struct Solved {
    pub part: Part,
    pub spectrum: Spectrum,
    /// None where nobody counted.
    pub left_out: Option<LeftOut>,
}

/// Rates below this part of the largest cannot be told from 0 in the eigenvalues of an unsymmetric
/// matrix with a double 0 in it: about the root of rounding.
const DOUBLE_ZERO: f64 = 1e-6;
/// Growth or decay of an unsymmetric matrix's eigenvalue below this part of the largest is rounding.
const NEUTRAL: f64 = 1e-11;
/// Real but for rounding: the root of it where two eigenvalues coincide.
const REAL: f64 = 1e-7;
/// Modes a large part is sampled at.
const SAMPLES: usize = 200;

/// None where an eigensolver does not converge.
pub(super) fn solve(part: Part, effort: &Effort) -> Option<Solved> {
    let n = part.n();
    let modal = part.symmetric.then(|| combination(&part)).flatten();
    let (spectrum, left_out) = match modal {
        Some(damping) if n <= effort.symmetric => modes(&part, damping)?,
        Some(damping) => (sampled(&part, damping, effort)?, None),
        None if n <= effort.unsymmetric => roots(&part)?,
        None => (outermost(&part, effort), None),
    };
    Some(Solved {
        part,
        spectrum,
        left_out,
    })
}

/// (a, b) with C = a K + b 1, if there are such: then each mode of K has a damping of its own.
fn combination(part: &Part) -> Option<(f64, f64)> {
    let (k, c) = (&part.stiffness, &part.damping);
    let size = c.norm();
    if size == 0.0 {
        return Some((0.0, 0.0));
    }
    if part.n() == 1 {
        return Some((0.0, c.at(0, 0)));
    }
    // The largest off-diagonal entry gives a, the first diagonal one b.
    let off = k.entries().filter(|(i, j, _)| i != j);
    let largest = off.max_by(|a, b| a.2.abs().total_cmp(&b.2.abs()));
    let a = largest.map_or(0.0, |(i, j, value)| c.at(i, j) / value);
    let b = c.at(0, 0) - a * k.at(0, 0);
    let identity = Matrix::new(k.n(), (0..k.n()).map(|i| (i, i, 1.0)).collect());
    let left = c.combined(1.0, k, -a).combined(1.0, &identity, -b);
    (left.norm() <= 1e-12 * (size + a.abs() * k.norm())).then_some((a, b))
}

/// Eigenvalues of a symmetric matrix that are rounding of 0.
fn zero(n: usize, norm: f64) -> f64 {
    8.0 * n as f64 * f64::EPSILON * norm
}

/// Ascending.
fn stiffnesses(part: &Part) -> Option<Vec<f64>> {
    if part.n() == 1 {
        return Some(vec![part.stiffness.at(0, 0)]);
    }
    let dense = part.stiffness.symmetric_part().dense();
    dense.self_adjoint_eigenvalues(Side::Lower).ok()
}

fn damped(stiffness: f64, (a, b): (f64, f64)) -> Mode {
    Mode {
        stiffness,
        damping: a * stiffness + b,
    }
}

fn modes(part: &Part, damping: (f64, f64)) -> Option<(Spectrum, Option<LeftOut>)> {
    let zero = zero(part.n(), part.stiffness.norm());
    let mut left_out = LeftOut::default();
    let mut modes = Vec::new();
    for stiffness in stiffnesses(part)? {
        if stiffness < -zero {
            left_out.unstable += 1;
            continue;
        }
        let stiffness = if stiffness <= zero { 0.0 } else { stiffness };
        left_out.at_rest += usize::from(stiffness == 0.0);
        let mode = damped(stiffness, damping);
        // Without either there is nothing a step could enlarge; with damping there is its decay.
        if mode.damping < 0.0 {
            left_out.unstable += 1;
        } else if mode.stiffness > 0.0 || mode.damping > 0.0 {
            modes.push(mode);
        }
    }
    Some((Spectrum::Modes(modes), Some(left_out)))
}

fn sampled(part: &Part, damping: (f64, f64), effort: &Effort) -> Option<Spectrum> {
    let product = |x: &[f64], y: &mut [f64]| part.stiffness.product(x, y);
    let (stiffest, _) = krylov::top(part.n(), &product, effort)?;
    let sample = |i| damped(stiffest.max(0.0) * i as f64 / SAMPLES as f64, damping);
    Some(Spectrum::Sampled((1..=SAMPLES).map(sample).collect()))
}

/// Of (s x, v): s balances the two halves.
fn balance(part: &Part) -> f64 {
    let (k, c) = (part.stiffness.norm(), part.damping.norm());
    if k > 0.0 { k.sqrt() } else { c }
}

fn roots(part: &Part) -> Option<(Spectrum, Option<LeftOut>)> {
    let n = part.n();
    let s = balance(part);
    let mut first_order = Mat::<f64>::zeros(2 * n, 2 * n);
    for i in 0..n {
        first_order[(i, n + i)] = s;
    }
    for (i, j, value) in part.stiffness.entries() {
        first_order[(n + i, j)] = -value / s;
    }
    for (i, j, value) in part.damping.entries() {
        first_order[(n + i, n + j)] = -value;
    }
    let all = first_order.eigenvalues().ok()?;
    let all = all.into_iter().map(|z| Complex::new(z.re, z.im));
    let zero = zero(n, part.stiffness.norm());
    let at_rest = stiffnesses(part)?
        .iter()
        .filter(|k| k.abs() <= zero)
        .count();
    let largest = all.clone().map(|z| z.norm()).fold(0.0, f64::max);
    let moving = all.filter(|root| at_rest == 0 || root.norm() > DOUBLE_ZERO * largest);
    let settled = moving.filter_map(|root| settled(root, largest));
    let (unstable, roots): (Vec<_>, _) = settled.partition(|root| root.re > 0.0);
    let left_out = LeftOut {
        at_rest,
        unstable: unstable.len(),
    };
    Some((Spectrum::Roots(roots), Some(left_out)))
}

/// An eigenvalue without its rounding; None of the lower one of a pair.
fn settled(root: Complex<f64>, largest: f64) -> Option<Complex<f64>> {
    let re = if root.re.abs() <= NEUTRAL * largest {
        0.0
    } else {
        root.re
    };
    if root.im.abs() <= REAL * root.norm() {
        return (re != 0.0).then(|| Complex::new(re, 0.0));
    }
    (root.im > 0.0).then(|| Complex::new(re, root.im))
}

/// Outermost eigenvalues are looked for down to this part of the largest: within it every ray of
/// RK4's region is as long as its longest, 2.83, but for a twelfth.
const INNER: f64 = 0.9;

fn outermost(part: &Part, effort: &Effort) -> Spectrum {
    let n = part.n();
    let s = balance(part);
    let product = |x: &[f64], y: &mut [f64]| {
        let (position, velocity) = x.split_at(n);
        let (drift, kick) = y.split_at_mut(n);
        for (drift, velocity) in drift.iter_mut().zip(velocity) {
            *drift = s * velocity;
        }
        kick.fill(0.0);
        part.stiffness.add_product(-1.0 / s, position, kick);
        part.damping.add_product(-1.0, velocity, kick);
    };
    let all = if n <= effort.outermost {
        krylov::outermost(2 * n, &product, INNER, effort)
    } else {
        Vec::new()
    };
    let largest = all.first().map_or(0.0, |root| root.norm());
    let settled = all.into_iter().filter_map(|root| settled(root, largest));
    Spectrum::Outermost {
        roots: settled.filter(|root| root.re <= 0.0).collect(),
        bound: bound(part, effort),
    }
}

/// The stiffest vector q as a mode (qᵀ K q, qᵀ C q), and a radius that holds all eigenvalues: one with
/// the unit vector x is a root of λ² + (x* C x) λ + x* K x. Of symmetric K and C both forms are real,
/// so |λ| is the root of x* K x where it oscillates and at most x* C x where it does not.
fn bound(part: &Part, effort: &Effort) -> Option<Bound> {
    let stiff = part.stiffness.symmetric_part();
    let product = |x: &[f64], y: &mut [f64]| stiff.product(x, y);
    let (stiffness, q) = krylov::top_estimate(part.n(), &product, effort)?;
    if stiffness <= 0.0 {
        return None;
    }
    let stiffest = Mode {
        stiffness,
        damping: part.damping.form(&q).max(0.0),
    };
    let symmetric = part.stiffness.skewness() == 0.0 && part.damping.skewness() == 0.0;
    // Row sums bound what a Krylov space only comes close to.
    let (k, c) = (part.stiffness.norm(), part.damping.norm());
    let radius = if symmetric {
        k.sqrt().max(c)
    } else {
        0.5 * (c + (c * c + 4.0 * k).sqrt())
    };
    Some(Bound { stiffest, radius })
}
