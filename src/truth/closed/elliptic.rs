//! Jacobi's elliptic functions by the arithmetic-geometric mean.

/// A modulus k with its complement k' = sqrt(1 - k²), both in [0, 1].
///
/// Not the parameter m = k². The complement is given, since near k = 1 it is lost in k.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Modulus {
    pub k: f64,
    pub complement: f64,
}

/// The three functions at one argument.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Jacobi {
    pub sn: f64,
    pub cn: f64,
    pub dn: f64,
}

impl Modulus {
    /// The quarter period K, infinite at k = 1.
    pub fn quarter_period(&self) -> f64 {
        let mean = self.means().last().map_or(1.0, |(a, _)| a);
        if self.complement > 0.0 {
            std::f64::consts::FRAC_PI_2 / mean
        } else {
            f64::INFINITY
        }
    }

    /// sn, cn and dn at `u` (Abramowitz and Stegun 16.4).
    pub fn at(&self, u: f64) -> Jacobi {
        if self.complement == 0.0 {
            let fall = 1.0 / u.cosh();
            return Jacobi {
                sn: u.tanh(),
                cn: fall,
                dn: fall,
            };
        }
        let means: Vec<(f64, f64)> = self.means().collect();
        let last = means.last().map_or(1.0, |(a, _)| *a);
        let mut amplitude = last * u * 2f64.powi(means.len() as i32);
        for (a, c) in means.iter().rev() {
            amplitude = 0.5 * (amplitude + (c / a * amplitude.sin()).asin());
        }
        let (sn, cn) = amplitude.sin_cos();
        let dn = self.complement.hypot(self.k * cn);
        Jacobi { sn, cn, dn }
    }

    /// The means a_n of 1 and k', each with c_n, from n = 1 until c_n is below rounding.
    fn means(&self) -> impl Iterator<Item = (f64, f64)> {
        let (mut a, mut b, mut c) = (1.0, self.complement, self.k);
        std::iter::from_fn(move || {
            if b == 0.0 || c <= f64::EPSILON * a {
                return None;
            }
            let next = 0.5 * (a + b);
            // (a - b) / 2 without its cancellation.
            c = 0.25 * c * c / next;
            b = (a * b).sqrt();
            a = next;
            Some((a, c))
        })
    }
}

impl Jacobi {
    /// The functions at the sum of two arguments. Its denominator 1 - k² sn² sn² is taken as a sum
    /// of squares.
    pub fn plus(&self, other: &Self, modulus: &Modulus) -> Self {
        let (p, q) = (self, other);
        let below = p.cn * p.cn + p.sn * p.sn * q.dn * q.dn;
        let k2 = modulus.k * modulus.k;
        Self {
            sn: (p.sn * q.cn * q.dn + q.sn * p.cn * p.dn) / below,
            cn: (p.cn * q.cn - p.sn * q.sn * p.dn * q.dn) / below,
            dn: (p.dn * q.dn - k2 * p.sn * q.sn * p.cn * q.cn) / below,
        }
    }
}
