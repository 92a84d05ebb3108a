//! Where |R(hλ)| <= 1, along the ray that a growing step moves hλ on.
//!
//! With hλ = u e^(iθ), E(u) = |Q|² - |P|² is a polynomial in u whose lowest coefficients cancel exactly
//! where a method is exact to that order: no scan could see that midpoint's 1 + z⁴/4 exceeds 1 at
//! z = 1e-4, its coefficient shows it.

use nalgebra::Complex;

/// R = P / Q by ascending coefficients.
#[derive(Debug, Clone, Copy)]
pub(super) struct Region {
    pub numerator: &'static [f64],
    pub denominator: &'static [f64],
}

/// How far along a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Reach {
    /// Unstable from the start.
    Nowhere,
    /// Up to this u = h |λ|.
    To(f64),
    Everywhere,
}

impl Region {
    /// The largest u such that |R| <= 1 for all smaller ones, on the ray of λ, which is not 0.
    pub(super) fn reach(&self, root: Complex<f64>) -> Reach {
        let excess = self.excess(root);
        let Some(lowest) = excess.iter().position(|e| *e != 0.0) else {
            return Reach::Everywhere;
        };
        if excess[lowest] < 0.0 {
            return Reach::Nowhere;
        }
        first_negative(&excess[lowest..]).map_or(Reach::Everywhere, Reach::To)
    }

    /// ln |R(hλ)|, without cancellation near 1.
    pub(super) fn log_modulus(&self, root: Complex<f64>, h: f64) -> f64 {
        let u = h * root.norm();
        let over = value(&self.excess(root), u) / value(&modulus(self.denominator, root).0, u);
        // |R| = 0 has no logarithm: as small as doubles go.
        0.5 * (-over).max(-1.0 + f64::MIN_POSITIVE.sqrt()).ln_1p()
    }

    /// The largest u up to which R(-u) has not changed its sign; infinite where it never does.
    pub(super) fn sign_change(&self) -> f64 {
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

    /// The largest ρ such that the left half of the disc of radius ρ is stable: on the half plane's
    /// rays, the least reach. Infinite for A-stable methods, 0 for those unstable on the imaginary
    /// axis.
    pub(super) fn half_disc(&self) -> f64 {
        // |R| is largest on the boundary, so the imaginary axis and the arc decide; rays of a
        // hundredth of a right angle sample the arc.
        (0..=RAYS)
            .map(|ray| {
                let angle = std::f64::consts::FRAC_PI_2 * f64::from(ray) / f64::from(RAYS);
                let direction = if ray == 0 {
                    Complex::new(0.0, 1.0)
                } else {
                    Complex::new(-angle.sin(), angle.cos())
                };
                match self.reach(direction) {
                    Reach::Nowhere => 0.0,
                    Reach::To(u) => u,
                    Reach::Everywhere => f64::INFINITY,
                }
            })
            .fold(f64::INFINITY, f64::min)
    }

    /// Coefficients of E(u); what is only rounding is 0.
    fn excess(&self, root: Complex<f64>) -> Vec<f64> {
        let (q, q_size) = modulus(self.denominator, root);
        let (p, p_size) = modulus(self.numerator, root);
        let at = |c: &[f64], i: usize| c.get(i).copied().unwrap_or(0.0);
        (0..q.len().max(p.len()))
            .map(|i| {
                let difference = at(&q, i) - at(&p, i);
                let rounding = 4.0 * f64::EPSILON * (at(&q_size, i) + at(&p_size, i));
                if i == 1 {
                    // 2 Re λ / |λ| times a number: as small as the damping is.
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

const RAYS: u32 = 100;

/// Coefficients in u of |Σ c_j (u e^(iθ))^j|², and of the same sum of magnitudes.
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

/// Horner.
fn value(coefficients: &[f64], u: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * u + c)
}

/// The smallest u > 0 at which a polynomial, positive at 0, becomes negative.
fn first_negative(coefficients: &[f64]) -> Option<f64> {
    turns(coefficients)
        .into_iter()
        .find_map(|(u, falls)| falls.then_some(u))
}

/// All u > 0 where a polynomial changes its sign, ascending, and whether it becomes negative there.
/// Between two turns of its derivative it is monotone.
fn turns(coefficients: &[f64]) -> Vec<(f64, bool)> {
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
    // Cauchy: no root is farther out.
    let leading = coefficients[degree].abs();
    let others = coefficients[..degree].iter();
    let bound = 1.0 + others.fold(0.0, |m: f64, c| m.max(c.abs())) / leading;
    let mut ends: Vec<f64> = turns(&derivative).into_iter().map(|(u, _)| u).collect();
    ends.push(bound);
    let mut from = 0.0;
    let mut found = Vec::new();
    for end in ends {
        let (before, after) = (value(coefficients, from), value(coefficients, end));
        if before * after < 0.0 {
            let (mut low, mut high) = (from, end);
            loop {
                let middle = 0.5 * (low + high);
                if middle <= low || middle >= high {
                    break;
                }
                if value(coefficients, middle) * before > 0.0 {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            found.push((low, after < 0.0));
        }
        from = end;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    const RK4: Region = Region {
        numerator: &[1.0, 1.0, 0.5, 1.0 / 6.0, 1.0 / 24.0],
        denominator: &[1.0],
    };

    #[test]
    fn classical_intervals_are_found() {
        // Hairer, Wanner, Solving ODEs II, IV.2: 2.785293563405282 on the negative axis, 2 sqrt(2) on
        // the imaginary one.
        let reach = |re, im| RK4.reach(Complex::new(re, im));
        let Reach::To(real) = reach(-3.0, 0.0) else {
            panic!()
        };
        assert!((real - 2.785_293_563_405_282).abs() < 1e-14, "{real}");
        let Reach::To(imaginary) = reach(0.0, 3.0) else {
            panic!()
        };
        assert!((imaginary - 8.0_f64.sqrt()).abs() < 1e-14, "{imaginary}");
        assert_eq!(reach(1.0, 0.0), Reach::Nowhere);
        // Every coefficient of midpoint's gain but z⁴/4 cancels; a wrong one does not.
        let heun = |z2: &'static [f64]| Region {
            numerator: z2,
            denominator: &[1.0],
        };
        let undamped = Complex::new(0.0, 1.0);
        let small = heun(&[1.0, 1.0, 0.5]).log_modulus(undamped, 1e-5);
        assert!((small / (1e-20 / 8.0) - 1.0).abs() < 1e-12, "{small}");
        assert_eq!(heun(&[1.0, 1.0, 0.5]).reach(undamped), Reach::Nowhere);
        assert_ne!(heun(&[1.0, 1.0, 1.0]).reach(undamped), Reach::Nowhere);
    }
}
