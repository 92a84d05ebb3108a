//! The modes of one part of a linearised scene.

use super::Effort;
use super::assembly::{Component, Part};
use super::krylov;
use super::mode::Mode;
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
    /// A large part's outermost eigenvalues, the farthest first; the others lie within the last.
    Outermost(Vec<Complex<f64>>),
    /// Of a large part whose outermost eigenvalues are too close together to be found: the stiffest
    /// vector, as a mode, and a radius within which all eigenvalues lie, 1/s.
    Bounded { stiffest: Mode, radius: f64 },
}

/// A part and its modes.
#[derive(Debug, Clone)]
pub(super) struct Solved {
    pub part: Part,
    pub spectrum: Spectrum,
    /// Modes without restoring force; None where nobody counted.
    pub at_rest: Option<usize>,
    /// Modes that grow in truth; None where nobody counted.
    pub unstable: Option<usize>,
    /// Largest frequency of what oscillates, rad/s.
    pub omega_max: Option<f64>,
    /// None above says nothing.
    pub unsure: bool,
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
    let component = &part.component;
    let n = component.n();
    let modal = part.symmetric.then(|| combination(component)).flatten();
    match modal {
        Some((a, b)) if n <= effort.symmetric => modes(part, a, b),
        Some((a, b)) => sampled(part, a, b, effort),
        None if n <= effort.unsymmetric => roots(part),
        None => outermost(part, effort),
    }
}

/// (a, b) with C = a K + b 1, if there are such: then each mode of K has a damping of its own.
fn combination(component: &Component) -> Option<(f64, f64)> {
    let (k, c) = (&component.stiffness, &component.damping);
    let size = c.norm();
    if size == 0.0 {
        return Some((0.0, 0.0));
    }
    if component.n() == 1 {
        return Some((0.0, c.at(0, 0)));
    }
    // The largest off-diagonal entry gives a, the first diagonal one b.
    let off = k.entries().filter(|(i, j, _)| i != j);
    let largest = off.max_by(|a, b| a.2.abs().total_cmp(&b.2.abs()));
    let a = largest.map_or(0.0, |(i, j, value)| c.at(i, j) / value);
    let b = c.at(0, 0) - a * k.at(0, 0);
    let identity = super::matrix::Matrix::new(k.n(), (0..k.n()).map(|i| (i, i, 1.0)).collect());
    let left = c.combined(1.0, k, -a).combined(1.0, &identity, -b);
    (left.norm() <= 1e-12 * (size + a.abs() * k.norm())).then_some((a, b))
}

/// Eigenvalues of a symmetric matrix that are rounding of 0.
fn zero(n: usize, norm: f64) -> f64 {
    8.0 * n as f64 * f64::EPSILON * norm
}

/// Ascending.
fn stiffnesses(component: &Component) -> Option<Vec<f64>> {
    if component.n() == 1 {
        return Some(vec![component.stiffness.at(0, 0)]);
    }
    let dense = component.stiffness.symmetric_part().dense();
    dense.self_adjoint_eigenvalues(Side::Lower).ok()
}

fn modes(part: Part, a: f64, b: f64) -> Option<Solved> {
    let component = &part.component;
    let zero = zero(component.n(), component.stiffness.norm());
    let (mut at_rest, mut unstable) = (0, 0);
    let mut modes = Vec::new();
    for stiffness in stiffnesses(component)? {
        if stiffness < -zero {
            unstable += 1;
            continue;
        }
        let stiffness = if stiffness <= zero { 0.0 } else { stiffness };
        at_rest += usize::from(stiffness == 0.0);
        let mode = Mode {
            stiffness,
            damping: a * stiffness + b,
        };
        // Without either there is nothing a step could enlarge; with damping there is its decay.
        if mode.damping < 0.0 {
            unstable += 1;
        } else if mode.stiffness > 0.0 || mode.damping > 0.0 {
            modes.push(mode);
        }
    }
    Some(Solved {
        omega_max: fastest(&modes),
        spectrum: Spectrum::Modes(modes),
        at_rest: Some(at_rest),
        unstable: Some(unstable),
        unsure: false,
        part,
    })
}

fn sampled(part: Part, a: f64, b: f64, effort: &Effort) -> Option<Solved> {
    let component = &part.component;
    let (stiffest, _) = krylov::top(
        component.n(),
        &|x, y| {
            y.fill(0.0);
            component.stiffness.add_product(1.0, x, y);
        },
        effort,
    )?;
    let modes: Vec<Mode> = (1..=SAMPLES)
        .map(|i| {
            let stiffness = stiffest.max(0.0) * i as f64 / SAMPLES as f64;
            Mode {
                stiffness,
                damping: a * stiffness + b,
            }
        })
        .collect();
    Some(Solved {
        omega_max: fastest(&modes),
        spectrum: Spectrum::Sampled(modes),
        at_rest: None,
        unstable: None,
        unsure: false,
        part,
    })
}

fn fastest(modes: &[Mode]) -> Option<f64> {
    let oscillating = modes.iter().filter(|mode| mode.oscillates());
    oscillating.map(|mode| mode.omega()).max_by(f64::total_cmp)
}

/// Of (s x, v): s balances the two halves.
fn balance(component: &Component) -> f64 {
    let (k, c) = (component.stiffness.norm(), component.damping.norm());
    if k > 0.0 { k.sqrt() } else { c }
}

fn roots(part: Part) -> Option<Solved> {
    let component = &part.component;
    let n = component.n();
    let s = balance(component);
    let mut first_order = Mat::<f64>::zeros(2 * n, 2 * n);
    for i in 0..n {
        first_order[(i, n + i)] = s;
    }
    for (i, j, value) in component.stiffness.entries() {
        first_order[(n + i, j)] = -value / s;
    }
    for (i, j, value) in component.damping.entries() {
        first_order[(n + i, n + j)] = -value;
    }
    let all = first_order.eigenvalues().ok()?;
    let all = all.into_iter().map(|z| Complex::new(z.re, z.im));
    let stiffnesses = stiffnesses(component)?;
    let zero = zero(n, component.stiffness.norm());
    let at_rest = stiffnesses.iter().filter(|k| k.abs() <= zero).count();
    let largest = all.clone().map(|z| z.norm()).fold(0.0, f64::max);
    let mut unstable = 0;
    let mut roots = Vec::new();
    for root in all {
        if at_rest > 0 && root.norm() <= DOUBLE_ZERO * largest {
            continue;
        }
        if let Some(root) = settled(root, largest) {
            if root.re > 0.0 {
                unstable += 1;
            } else {
                roots.push(root);
            }
        }
    }
    Some(Solved {
        omega_max: fastest_root(&roots),
        spectrum: Spectrum::Roots(roots),
        at_rest: Some(at_rest),
        unstable: Some(unstable),
        unsure: false,
        part,
    })
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

fn fastest_root(roots: &[Complex<f64>]) -> Option<f64> {
    let oscillating = roots.iter().filter(|root| root.im > 0.0);
    oscillating.map(|root| root.norm()).max_by(f64::total_cmp)
}

/// Outermost eigenvalues are looked for down to this part of the largest: within it every ray of
/// RK4's region is as long as its longest, 2.83, but for a twelfth.
const INNER: f64 = 0.9;

fn outermost(part: Part, effort: &Effort) -> Option<Solved> {
    let component = &part.component;
    let n = component.n();
    let s = balance(component);
    let product = |x: &[f64], y: &mut [f64]| {
        let (position, velocity) = x.split_at(n);
        let (drift, kick) = y.split_at_mut(n);
        for (drift, velocity) in drift.iter_mut().zip(velocity) {
            *drift = s * velocity;
        }
        kick.fill(0.0);
        component.stiffness.add_product(-1.0 / s, position, kick);
        component.damping.add_product(-1.0, velocity, kick);
    };
    let all = if n <= effort.outermost {
        krylov::outermost(2 * n, &product, INNER, effort)
    } else {
        Vec::new()
    };
    let largest = all.first().map_or(0.0, |root| root.norm());
    let roots: Vec<_> = all
        .into_iter()
        .filter_map(|root| settled(root, largest))
        .filter(|root| root.re <= 0.0)
        .collect();
    let bounded = bounded(component, effort);
    // Roots may be decays only, while others within them oscillate.
    let omega_max = fastest_root(&roots).or_else(|| {
        let (stiffest, _) = bounded?;
        stiffest.oscillates().then(|| stiffest.omega())
    });
    let spectrum = match bounded {
        Some((stiffest, radius)) if roots.is_empty() => Spectrum::Bounded { stiffest, radius },
        _ => Spectrum::Outermost(roots),
    };
    Some(Solved {
        omega_max,
        spectrum,
        at_rest: None,
        unstable: None,
        unsure: true,
        part,
    })
}

/// The stiffest vector q as a mode (qᵀ K q, qᵀ C q), and a radius that holds all eigenvalues: one with
/// the unit vector x is a root of λ² + (x* C x) λ + x* K x. Of symmetric K and C both forms are real,
/// so |λ| is the root of x* K x where it oscillates and at most x* C x where it does not.
fn bounded(component: &Component, effort: &Effort) -> Option<(Mode, f64)> {
    let n = component.n();
    let top = |matrix: &super::matrix::Matrix| {
        krylov::top_estimate(
            n,
            &|x, y| {
                y.fill(0.0);
                matrix.add_product(1.0, x, y);
            },
            effort,
        )
    };
    let k = component.stiffness.symmetric_part();
    let (stiffness, q) = top(&k)?;
    if stiffness <= 0.0 {
        return None;
    }
    let stiffest = Mode {
        stiffness,
        damping: component.damping.form(&q).max(0.0),
    };
    let symmetric = component.stiffness.skewness() == 0.0 && component.damping.skewness() == 0.0;
    // Row sums bound what a Krylov space only comes close to.
    let (k, c) = (component.stiffness.norm(), component.damping.norm());
    let radius = if symmetric {
        k.sqrt().max(c)
    } else {
        0.5 * (c + (c * c + 4.0 * k).sqrt())
    };
    Some((stiffest, radius))
}
