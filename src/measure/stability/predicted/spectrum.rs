//! The modes of one part of a linearised scene: x'' = -κ x - c x' of each.

use super::Effort;
use super::krylov;
use super::part::{Matrix, Part};
use faer::{Mat, Side};
use nalgebra::Complex;

/// A part and what is known of its modes; those at rest and those unstable in truth are left out.
#[derive(Debug, Clone)]
pub(super) struct Spectrum {
    pub part: Part,
    /// Whether damping acts on each mode by itself (C a combination of K and 1).
    pub proportional: bool,
    /// With proportional damping all modes, ascending in stiffness; else one for each eigenvalue.
    pub modes: Vec<Mode>,
    /// Eigenvalues with Im >= 0 of (x, v)' = (v, -K x - C v), 1/s, and the mode each belongs to.
    pub eigenvalues: Vec<(Complex<f64>, Mode)>,
    pub coverage: Coverage,
    /// None where they were not counted.
    pub left_out: Option<LeftOut>,
}

/// How much of a spectrum is known.
#[derive(Debug, Clone, Copy)]
pub(super) enum Coverage {
    All,
    /// A sample of a large part's modes, the last the stiffest: its frequency's relative error.
    Sampled(f64),
    /// A large part's outermost eigenvalues, the farthest first; the others lie within the last. None
    /// where they are too close together to be found.
    Outermost(Option<Bound>),
}

/// Bounds that are known without any eigenvalue.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bound {
    /// The stiffest vector, as a mode.
    pub stiffest: Mode,
    /// Radius within which all eigenvalues lie, 1/s.
    pub radius: f64,
}

/// Modes that are left out.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct LeftOut {
    /// Number of modes without restoring force.
    pub at_rest: usize,
    /// Number of modes that grow in truth, with one growing eigenvalue each.
    pub unstable: usize,
}

impl Spectrum {
    fn of_modes(
        part: Part,
        modes: Vec<Mode>,
        coverage: Coverage,
        left_out: Option<LeftOut>,
    ) -> Self {
        Self {
            part,
            proportional: true,
            eigenvalues: modes.iter().flat_map(|mode| mode.eigenvalues()).collect(),
            modes,
            coverage,
            left_out,
        }
    }

    fn of_eigenvalues(
        part: Part,
        values: impl Iterator<Item = Complex<f64>>,
        coverage: Coverage,
        left_out: Option<LeftOut>,
    ) -> Self {
        let eigenvalues: Vec<_> = values.map(|value| (value, Mode::of(value))).collect();
        Self {
            part,
            proportional: false,
            modes: eigenvalues.iter().map(|(_, mode)| *mode).collect(),
            eigenvalues,
            coverage,
            left_out,
        }
    }

    /// The largest frequency of what oscillates, rad/s.
    pub fn omega_max(&self) -> Option<f64> {
        let oscillating = self.eigenvalues.iter().filter(|(value, _)| value.im > 0.0);
        let fastest = oscillating.map(|(_, mode)| mode.omega());
        let fastest = fastest.max_by(f64::total_cmp);
        match self.coverage {
            // Eigenvalues may be decays only, while others within them oscillate.
            Coverage::Outermost(Some(Bound { stiffest, .. })) if stiffest.oscillates() => {
                fastest.or(Some(stiffest.omega()))
            }
            _ => fastest,
        }
    }
}

/// An unsymmetric matrix's eigenvalue, and its growth or decay, below this part of the largest is rounding.
const NEUTRAL: f64 = 1e-11;
/// An eigenvalue is real if its imaginary part is a smaller part of it than this: where two
/// eigenvalues coincide, the root of rounding.
const REAL: f64 = 1e-7;
/// Modes a large part is sampled at.
const SAMPLES: usize = 200;

/// None where an eigensolver does not converge.
pub(super) fn solve(part: Part, effort: &Effort) -> Option<Spectrum> {
    let n = part.n();
    let proportional = part.symmetric.then(|| proportional(&part)).flatten();
    match proportional {
        Some(damping) if n <= effort.symmetric => modes(part, damping),
        Some(damping) => sampled(part, damping, effort),
        None if n <= effort.unsymmetric => match part.forced() {
            None => eigenvalues(part),
            Some((left, at_rest)) => {
                let mut spectrum = solve(left, effort)?;
                if let Some(left_out) = &mut spectrum.left_out {
                    left_out.at_rest += at_rest;
                }
                Some(spectrum)
            }
        },
        None => Some(outermost(part, effort)),
    }
}

/// (a, b) with C = a K + b 1, if there are such: then each mode of K has a damping of its own.
fn proportional(part: &Part) -> Option<(f64, f64)> {
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
    let identity = Matrix::new(k.n(), (0..k.n()).map(|i| (i, i, 1.0)));
    let left = c.combined(1.0, k, -a).combined(1.0, &identity, -b);
    let rounding = 1e-12 * (size + a.abs() * k.norm());
    // A b that is only rounding would damp what nothing damps.
    let b = if b.abs() <= rounding { 0.0 } else { b };
    (left.norm() <= rounding).then_some((a, b))
}

/// Stiffnesses of the modes, 1/s², ascending.
fn stiffnesses(part: &Part) -> Option<Vec<f64>> {
    if part.n() == 1 {
        return Some(vec![part.stiffness.at(0, 0)]);
    }
    let dense = part.stiffness.symmetric_part().dense();
    dense.self_adjoint_eigenvalues(Side::Lower).ok()
}

/// The mode of this stiffness; damping below `rounding` is that of a stiffness that a and b cancel.
fn damped(stiffness: f64, (a, b): (f64, f64), rounding: f64) -> Mode {
    let damping = a * stiffness + b;
    Mode {
        stiffness,
        damping: if damping.abs() <= rounding {
            0.0
        } else {
            damping
        },
    }
}

fn modes(part: Part, damping: (f64, f64)) -> Option<Spectrum> {
    let zero = part.zero();
    let mut left_out = LeftOut::default();
    let mut modes = Vec::new();
    let rounding = damping.0.abs() * zero;
    for stiffness in stiffnesses(&part)? {
        if stiffness < -zero {
            left_out.unstable += 1;
            continue;
        }
        let stiffness = if stiffness <= zero { 0.0 } else { stiffness };
        left_out.at_rest += usize::from(stiffness == 0.0);
        let mode = damped(stiffness, damping, rounding);
        // Without either there is nothing a step could enlarge; with damping there is its decay.
        if mode.damping < 0.0 {
            left_out.unstable += 1;
        } else if mode.stiffness > 0.0 || mode.damping > 0.0 {
            modes.push(mode);
        }
    }
    Some(Spectrum::of_modes(
        part,
        modes,
        Coverage::All,
        Some(left_out),
    ))
}

fn sampled(part: Part, damping: (f64, f64), effort: &Effort) -> Option<Spectrum> {
    let product = |x: &[f64], y: &mut [f64]| part.stiffness.product(x, y);
    let (stiffest, _) = krylov::top(part.n(), &product, effort)?;
    let sample = |i| damped(stiffest.max(0.0) * i as f64 / SAMPLES as f64, damping, 0.0);
    let modes = (1..=SAMPLES).map(sample).collect();
    let coverage = Coverage::Sampled(krylov::error(part.n(), effort));
    Some(Spectrum::of_modes(part, modes, coverage, None))
}

/// The factor s of (s x, v) that balances the two halves.
fn balance(part: &Part) -> f64 {
    let (k, c) = (part.stiffness.norm(), part.damping.norm());
    if k > 0.0 { k.sqrt() } else { c }
}

/// The eigenvalues other than 0, from (s ξ, v), ξ being the displacements that change some force.
fn eigenvalues(part: Part) -> Option<Spectrum> {
    let n = part.n();
    let s = balance(&part);
    let felt = part.felt()?;
    let rank = felt.ncols();
    let force = part.stiffness.dense() * &felt;
    let mut first_order = Mat::<f64>::zeros(rank + n, rank + n);
    for i in 0..n {
        for j in 0..rank {
            first_order[(j, rank + i)] = s * felt[(i, j)];
            first_order[(rank + i, j)] = -force[(i, j)] / s;
        }
    }
    for (i, j, value) in part.damping.entries() {
        first_order[(rank + i, rank + j)] = -value;
    }
    let all = first_order.eigenvalues().ok()?;
    let all = all.into_iter().map(|z| Complex::new(z.re, z.im));
    let largest = all.clone().map(|z| z.norm()).fold(0.0, f64::max);
    let settled = all.filter_map(|root| settled(root, largest));
    let (unstable, stable): (Vec<_>, Vec<_>) = settled.partition(|root| root.re > 0.0);
    let left_out = LeftOut {
        at_rest: n - rank,
        // What swings and grows is a pair.
        unstable: unstable
            .iter()
            .map(|root| 1 + usize::from(root.im > 0.0))
            .sum(),
    };
    let stable = stable.into_iter();
    Some(Spectrum::of_eigenvalues(
        part,
        stable,
        Coverage::All,
        Some(left_out),
    ))
}

/// An eigenvalue without its rounding; None for 0 and for the lower one of a pair.
fn settled(root: Complex<f64>, largest: f64) -> Option<Complex<f64>> {
    if root.norm() <= NEUTRAL * largest {
        return None;
    }
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

fn outermost(part: Part, effort: &Effort) -> Spectrum {
    let n = part.n();
    let s = balance(&part);
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
        krylov::outermost(2 * n, &product, INNER, effort).unwrap_or_default()
    } else {
        Vec::new()
    };
    let largest = all.first().map_or(0.0, |root| root.norm());
    let settled = all.into_iter().filter_map(|root| settled(root, largest));
    let coverage = Coverage::Outermost(bound(&part, effort));
    Spectrum::of_eigenvalues(part, settled.filter(|root| root.re <= 0.0), coverage, None)
}

/// Residual at which the stiffest vector will do, relative to the spectrum; the eigenvalue is then good to
/// its square, times the gap.
const ESTIMATE: f64 = 1e-5;

/// The stiffest vector q as a mode (qᵀ K q, qᵀ C q), and a radius that holds all eigenvalues: one with
/// the unit vector x is a root of λ² + (x* C x) λ + x* K x. Of symmetric K and C both forms are real,
/// so |λ| is the root of x* K x where it oscillates and at most x* C x where it does not.
fn bound(part: &Part, effort: &Effort) -> Option<Bound> {
    let stiff = part.stiffness.symmetric_part();
    let product = |x: &[f64], y: &mut [f64]| stiff.product(x, y);
    let (stiffness, q, _) = krylov::best(part.n(), &product, effort, ESTIMATE)?;
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

/// Its two eigenvalues are the roots of λ² + c λ + κ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Mode {
    /// κ = ω², 1/s².
    pub stiffness: f64,
    /// c, 1/s.
    pub damping: f64,
}

impl Mode {
    /// The mode an eigenvalue belongs to; for a real one, the mode that decays as it does.
    pub fn of(root: Complex<f64>) -> Self {
        if root.im == 0.0 {
            Self {
                stiffness: 0.0,
                damping: -root.re,
            }
        } else {
            Self {
                stiffness: root.norm_sqr(),
                damping: -2.0 * root.re,
            }
        }
    }

    /// Its eigenvalues other than 0 with Im >= 0, two real ones or one of a pair, each with the mode.
    pub fn eigenvalues(self) -> Vec<(Complex<f64>, Self)> {
        let (k, half) = (self.stiffness, 0.5 * self.damping);
        if self.oscillates() {
            let value = Complex::new(-half, (k - half * half).max(0.0).sqrt());
            return vec![(value, self)];
        }
        let far = -(half + (half * half - k).max(0.0).sqrt());
        let near = if far == 0.0 { 0.0 } else { k / far };
        let moving = [far, near].into_iter().filter(|rate| *rate != 0.0);
        moving.map(|rate| (rate.into(), self)).collect()
    }

    /// Less than critically damped, by more than rounding.
    pub fn oscillates(self) -> bool {
        let half = 0.5 * self.damping;
        self.stiffness > half * half * (1.0 + 1e-12)
    }

    /// Undamped angular frequency, rad/s.
    pub fn omega(self) -> f64 {
        self.stiffness.max(0.0).sqrt()
    }

    /// The larger of its two rates, 1/s.
    pub fn rate(self) -> f64 {
        self.omega().max(self.damping.abs())
    }

    /// `mode of 7.07 rad/s, damping ratio 0.1` or `decay at 2 1/s`.
    pub fn words(self) -> String {
        let omega = self.omega();
        if omega == 0.0 {
            return format!("decay at {} 1/s", shown(self.damping));
        }
        if self.damping == 0.0 {
            return format!("undamped mode of {} rad/s", shown(omega));
        }
        let ratio = self.damping / (2.0 * omega);
        format!(
            "mode of {} rad/s, damping ratio {}",
            shown(omega),
            shown(ratio)
        )
    }
}

/// Three digits, without an exponent where that stays short.
pub(super) fn shown(value: f64) -> String {
    let magnitude = value.abs();
    if magnitude != 0.0 && !(1e-3..1e5).contains(&magnitude) {
        return format!("{value:.2e}");
    }
    let before = if magnitude > 0.0 {
        magnitude.log10().floor() as i32 + 1
    } else {
        1
    };
    let decimals = (3 - before).max(0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}
