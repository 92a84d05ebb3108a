//! The amplification of a mode by one step on linear systems, from a method's coefficients.

use super::{DampingTreatment, Stable, Stage, Tableau};
use crate::physics::phi1;
use nalgebra::{Complex, DMatrix};

/// The one-step map on x'' = -K x - C v.
#[derive(Debug, Clone, Copy)]
pub enum Amplification {
    /// A step multiplies each eigenvector of the first-order system by R(hλ). This holds for all
    /// Runge-Kutta methods (Hairer, Wanner, Solving ODEs II, IV.2-3).
    Rational(Rational),
    /// A product of drifts and kicks. The eigenvalues alone do not decide, since damping acts in kicks and
    /// not in drifts.
    Composition(&'static [Stage], DampingTreatment),
    /// (I + h C + h² K') v1 = v0 - h K x0, x1 = x0 + h v1: linearly implicit Euler whose matrix has only
    /// the stiffness along springs, K'
    /// ([`Linearization::Material`](crate::physics::Linearization)).
    MaterialImplicit,
}

/// The stability function R = P / Q.
#[derive(Debug, Clone, Copy)]
pub struct Rational {
    /// Coefficients of P, ascending, the first 1.
    pub numerator: &'static [f64],
    /// Coefficients of Q, ascending, the first 1.
    pub denominator: &'static [f64],
}

/// The number of rays in a right angle that sample the arc of a half disc.
const RAYS: u32 = 100;

impl Rational {
    /// The stability function R = 1 + z bᵀ (1 - z A)⁻¹ 1 of a tableau that is explicit or has its implicit
    /// coefficients on the diagonal. `order` is the method's.
    pub(super) fn of(tableau: &Tableau, order: u32) -> Self {
        let stages = tableau.b.len();
        // The coefficients of R as a series are bᵀ Aᵏ⁻¹ 1, which are 1/k! up to the order.
        let mut series = vec![1.0];
        let mut slopes = vec![1.0; stages];
        let mut factorial = 1.0;
        for power in 1..=stages {
            factorial *= power as f64;
            series.push(if power <= order as usize {
                1.0 / factorial
            } else {
                tableau.b.iter().zip(&slopes).map(|(b, s)| b * s).sum()
            });
            slopes = tableau.through(&slopes);
        }
        // Q is the product of all 1 - a z, and P is Q times the series.
        let diagonal = tableau.a.iter().enumerate();
        let factors = diagonal.map(|(stage, row)| [1.0, -row.get(stage).unwrap_or(&0.0)]);
        let denominator = factors.fold(vec![1.0], |q, factor| product(&q, &factor));
        let size = |c: &[f64]| c.iter().map(|c| c.abs()).collect::<Vec<_>>();
        let sizes = product(&size(&denominator), &size(&series));
        let mut numerator = product(&denominator, &series);
        numerator.truncate(stages + 1);
        for (sum, size) in numerator.iter_mut().zip(sizes) {
            if sum.abs() <= 4.0 * f64::EPSILON * size {
                *sum = 0.0;
            }
        }
        Self {
            numerator: trimmed(numerator),
            denominator: trimmed(denominator),
        }
    }

    /// The u = h |λ| up to which |R| <= 1 on the ray of λ, which is not 0.
    ///
    /// With hλ = u e^(iθ), E(u) = |Q|² - |P|² is a polynomial in u, whose lowest coefficients cancel
    /// exactly where a method is exact to that order. No scan could see that midpoint's 1 + z⁴/4 exceeds 1
    /// at z = 1e-4, but the coefficient shows it.
    pub fn reach(&self, root: Complex<f64>) -> Stable {
        stable(&self.excess(root))
    }

    /// ln |R(hλ)|, without cancellation near 1.
    pub(crate) fn log_modulus(&self, root: Complex<f64>, h: f64) -> f64 {
        // |R| = 0 has no logarithm, so it is replaced by the smallest value that has one.
        0.5 * self
            .gain(root, h * root.norm())
            .max(-1.0 + f64::MIN_POSITIVE.sqrt())
            .ln_1p()
    }

    /// |R|² - 1 at u on the ray of λ.
    pub(super) fn gain(&self, root: Complex<f64>, u: f64) -> f64 {
        -(value(&self.excess(root), u) / value(&modulus(self.denominator, root).0, u))
    }

    /// The largest u up to which R(-u) has not changed its sign; infinite where it never does.
    pub(crate) fn sign_change(&self) -> f64 {
        [self.numerator, self.denominator]
            .iter()
            .filter_map(|coefficients| {
                let signs = [1.0, -1.0].into_iter().cycle();
                let mirrored: Vec<f64> =
                    coefficients.iter().zip(signs).map(|(c, s)| c * s).collect();
                first_negative(&mirrored)
            })
            .fold(f64::INFINITY, f64::min)
    }

    /// The largest ρ for which the left half of the disc of radius ρ is stable: the least reach over the
    /// rays of the left half plane. Infinite for A-stable methods, 0 for those unstable on the imaginary
    /// axis.
    pub(crate) fn half_disc(&self) -> f64 {
        // |R| is largest on the boundary, so the imaginary axis and the arc decide; rays a hundredth of a
        // right angle apart sample the arc.
        (0..=RAYS)
            .map(|ray| {
                let angle = std::f64::consts::FRAC_PI_2 * f64::from(ray) / f64::from(RAYS);
                let direction = if ray == 0 {
                    Complex::new(0.0, 1.0)
                } else {
                    Complex::new(-angle.sin(), angle.cos())
                };
                match self.reach(direction) {
                    Stable::Never => 0.0,
                    Stable::Below(u) => u,
                    Stable::Always | Stable::AlwaysAlong { .. } => f64::INFINITY,
                }
            })
            .fold(f64::INFINITY, f64::min)
    }

    /// The coefficients of E(u). Those that consist of rounding only are 0.
    fn excess(&self, root: Complex<f64>) -> Vec<f64> {
        let (q, q_size) = modulus(self.denominator, root);
        let (p, p_size) = modulus(self.numerator, root);
        let at = |c: &[f64], i: usize| c.get(i).copied().unwrap_or(0.0);
        (0..q.len().max(p.len()))
            .map(|i| {
                let difference = at(&q, i) - at(&p, i);
                let rounding = 4.0 * f64::EPSILON * (at(&q_size, i) + at(&p_size, i));
                if i == 1 {
                    // 2 Re λ / |λ| times a number, which is small where the damping is small.
                    difference
                } else if difference.abs() <= rounding {
                    0.0
                } else {
                    difference
                }
            })
            .collect()
    }
}

/// The coefficients without leading zeros. They are leaked: a method is made once, and its facts live as
/// long as the program.
fn trimmed(mut coefficients: Vec<f64>) -> &'static [f64] {
    let degree = coefficients.iter().rposition(|c| *c != 0.0).unwrap_or(0);
    coefficients.truncate(degree + 1);
    coefficients.leak()
}

/// The product of two polynomials.
fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut product = vec![0.0; a.len() + b.len() - 1];
    for (i, a) in a.iter().enumerate() {
        for (j, b) in b.iter().enumerate() {
            product[i + j] += a * b;
        }
    }
    product
}

/// The coefficients in u of |Σ c_j (u e^(iθ))^j|², and those of the same sum of magnitudes.
fn modulus(coefficients: &[f64], root: Complex<f64>) -> (Vec<f64>, Vec<f64>) {
    let direction = root / root.norm();
    let mut cosines = vec![1.0];
    let mut power = Complex::new(1.0, 0.0);
    for _ in 1..coefficients.len() {
        power *= direction;
        cosines.push(power.re);
    }
    let mut sum = vec![0.0; (2 * coefficients.len()).saturating_sub(1)];
    let mut size = sum.clone();
    for (j, a) in coefficients.iter().enumerate() {
        for (k, b) in coefficients.iter().enumerate() {
            sum[j + k] += a * b * cosines[j.abs_diff(k)];
            size[j + k] += (a * b).abs();
        }
    }
    (sum, size)
}

/// The u up to which a polynomial is not negative.
fn stable(excess: &[f64]) -> Stable {
    let Some(lowest) = excess.iter().position(|e| *e != 0.0) else {
        return Stable::Always;
    };
    if excess[lowest] < 0.0 {
        return Stable::Never;
    }
    first_negative(&excess[lowest..]).map_or(Stable::Always, Stable::Below)
}

/// The value of a polynomial, by Horner's rule.
fn value(coefficients: &[f64], u: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * u + c)
}

/// The smallest u > 0 at which a polynomial, positive at 0, becomes negative.
fn first_negative(coefficients: &[f64]) -> Option<f64> {
    sign_changes(coefficients)
        .into_iter()
        .find_map(|(u, falls)| falls.then_some(u))
}

/// All u > 0 at which a polynomial changes its sign, ascending, and whether it becomes negative there.
/// Between two sign changes of its derivative a polynomial is monotone.
fn sign_changes(coefficients: &[f64]) -> Vec<(f64, bool)> {
    let degree = coefficients.iter().rposition(|c| *c != 0.0).unwrap_or(0);
    let coefficients = &coefficients[..=degree.min(coefficients.len().saturating_sub(1))];
    if degree == 0 {
        return Vec::new();
    }
    let derivative: Vec<f64> = coefficients
        .iter()
        .enumerate()
        .skip(1)
        .map(|(power, c)| power as f64 * c)
        .collect();
    // Cauchy's bound: no root is larger.
    let leading = coefficients[degree].abs();
    let others = coefficients[..degree].iter();
    let bound = 1.0 + others.fold(0.0, |m: f64, c| m.max(c.abs())) / leading;
    let mut ends: Vec<f64> = sign_changes(&derivative)
        .into_iter()
        .map(|(u, _)| u)
        .collect();
    ends.push(bound);
    let mut from = 0.0;
    let mut found = Vec::new();
    for end in ends {
        let (before, after) = (value(coefficients, from), value(coefficients, end));
        if before * after < 0.0 {
            let same = |u: f64| value(coefficients, u) * before > 0.0;
            found.push((bisect(from, end, 0.0, same), after < 0.0));
        }
        from = end;
    }
    found
}

/// The largest u found at which a condition holds that holds at `low` and not at `high`, to a relative
/// `width` or to the last bit.
pub(crate) fn bisect(
    mut low: f64,
    mut high: f64,
    width: f64,
    mut holds: impl FnMut(f64) -> bool,
) -> f64 {
    while high - low > width * high {
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
    low
}

impl DampingTreatment {
    /// The two factors of a kick over `step` under damping c: it multiplies the velocity by the first and
    /// the acceleration by the second, and adds the two.
    pub(crate) fn kick(self, step: f64, c: f64) -> (f64, f64) {
        match self {
            Self::Explicit => (1.0 - step * c, step),
            // On one oscillator a sweep is the exact flow.
            Self::ExactFlow | Self::Sweeps => ((-step * c).exp(), step * phi1(-step * c)),
            Self::Boris => {
                let half = 0.5 * step * c;
                ((1.0 - half) / (1.0 + half), step / (1.0 + half))
            }
        }
    }
}

impl DampingTreatment {
    /// As [`kick`](Self::kick), under a damping matrix c, n x n, that need not be symmetric. NaN where they do not
    /// exist.
    pub(crate) fn kick_matrices(self, step: f64, c: &DMatrix<f64>) -> [DMatrix<f64>; 2] {
        let n = c.nrows();
        let one = DMatrix::<f64>::identity(n, n);
        match self {
            Self::Explicit => [&one - c * step, one * step],
            Self::ExactFlow | Self::Sweeps => {
                // The exponential of [-step c, step; 0, 0] has e^(-step c) and step φ1(-step c) in its upper half.
                let mut both = (c * -step).resize(2 * n, 2 * n, 0.0);
                both.view_mut((0, n), (n, n)).copy_from(&(one * step));
                let finite = both.iter().all(|entry| entry.is_finite());
                let flow = if finite { both.exp() } else { both * f64::NAN };
                [0, n].map(|from| flow.view((0, from), (n, n)).into_owned())
            }
            Self::Boris => {
                let half = c * (0.5 * step);
                let back = (&one + &half).try_inverse();
                let back = back.unwrap_or_else(|| DMatrix::from_element(n, n, f64::NAN));
                [&back * (&one - half), back * step]
            }
        }
    }
}

/// The matrix of a composition's step on (x, v) of x'' = -k x - c x', row-major.
pub(crate) fn map(
    stages: &[Stage],
    damping: DampingTreatment,
    [k, c]: [f64; 2],
    h: f64,
) -> [f64; 4] {
    stages
        .iter()
        .fold([1.0, 0.0, 0.0, 1.0], |[a, b, p, q], stage| match *stage {
            Stage::Drift(part) => {
                let step = part * h;
                [a + step * p, b + step * q, p, q]
            }
            Stage::Kick(part) => {
                let (kept, pushed) = damping.kick(part * h, c);
                [a, b, kept * p - pushed * k * a, kept * q - pushed * k * b]
            }
        })
}

/// The z = h w up to which a composition is stable on the undamped oscillator. Its determinant is 1, so it
/// is stable while its trace, a polynomial in z, stays within 2.
pub(super) fn oscillator_limit(stages: &[Stage]) -> Stable {
    let unit = |first: f64| {
        let mut constant = vec![0.0; stages.len() + 1];
        constant[0] = first;
        constant
    };
    // (x, v) from (1, 0) and from (0, 1), each a polynomial in z.
    let mut rows = [[unit(1.0), unit(0.0)], [unit(0.0), unit(1.0)]];
    for stage in stages {
        let (part, from, to) = match stage {
            Stage::Drift(part) => (*part, 1, 0),
            Stage::Kick(part) => (-part, 0, 1),
        };
        for row in &mut rows {
            for power in 1..=stages.len() {
                row[to][power] += part * row[from][power - 1];
            }
        }
    }
    let [[x, _], [_, v]] = rows;
    let trace: Vec<f64> = x.iter().zip(&v).map(|(x, v)| x + v).collect();
    let mut room: Vec<f64> = product(&trace, &trace).iter().map(|c| -c).collect();
    room[0] += 4.0;
    match stable(&room) {
        // Bisection ends just below a root that is itself a double.
        Stable::Below(z) if value(&room, z.next_up()) == 0.0 => Stable::Below(z.next_up()),
        stable => stable,
    }
}

/// The multiples of its initial value between which the oscillator's energy stays for ever, from rest, at z
/// below the limit. The orbit is the conic that the map leaves invariant, x² - 2 s x v + t v² = 1.
pub(super) fn band(stages: &[Stage], z: f64) -> (f64, f64) {
    let [a, b, c, d] = map(stages, DampingTreatment::Explicit, [1.0, 0.0], z);
    let (s, t) = (0.5 * (a - d) / c, -b / c);
    let (least, most) = if s == 0.0 {
        (t.min(1.0), t.max(1.0))
    } else {
        let (middle, half) = (0.5 * (1.0 + t), (0.5 * (1.0 - t)).hypot(s));
        (middle - half, middle + half)
    };
    (1.0 / most, 1.0 / least)
}
