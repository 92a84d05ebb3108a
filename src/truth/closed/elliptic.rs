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

/// The means agree to this fraction: their limit is then known to its square.
const AGREE: f64 = 1e-8;

impl Modulus {
    /// The quarter period K, infinite at k = 1.
    pub fn quarter_period(&self) -> f64 {
        if self.complement > 0.0 {
            std::f64::consts::FRAC_PI_2 / self.means().1
        } else {
            f64::INFINITY
        }
    }

    /// sn, cn and dn at `u`, each to its own last digits also where k' is tiny: Landen's transformation on cotangents,
    /// all of whose sums are of positive terms (Bulirsch 1965, Numer. Math. 7).
    pub fn at(&self, u: f64) -> Jacobi {
        if self.complement == 0.0 {
            let fall = 1.0 / u.cosh();
            return Jacobi {
                sn: u.tanh(),
                cn: fall,
                dn: fall,
            };
        }
        let (means, mean) = self.means();
        let (sin, cos) = (mean * u).sin_cos();
        // The square of the cotangent has to be finite.
        if sin.abs() < 1e-100 {
            return Jacobi {
                sn: u,
                cn: cos,
                dn: 1.0,
            };
        }
        let mut dn = 1.0;
        let mut ratio = cos / sin;
        let mut cot = mean * ratio;
        for (a, b) in means.iter().rev() {
            let square = cot * ratio;
            cot *= dn;
            dn = (b + square) / (a + square);
            ratio = cot / a;
        }
        let sn = 1.0_f64.copysign(sin) / cot.hypot(1.0);
        Jacobi {
            sn,
            cn: cot * sn,
            dn,
        }
    }

    /// The arithmetic and geometric means from 1 and k' on until they agree, and their limit.
    fn means(&self) -> (Vec<(f64, f64)>, f64) {
        let (mut a, mut b) = (1.0, self.complement);
        let mut means = vec![(a, b)];
        while a - b > AGREE * a {
            (a, b) = (0.5 * (a + b), (a * b).sqrt());
            means.push((a, b));
        }
        (means, 0.5 * (a + b))
    }
}

impl Jacobi {
    /// The functions at the sum of two arguments. Its denominator 1 - k² sn² sn² is taken as a sum
    /// of squares, of which `most` is divided out: where k' is tiny they leave the range of a double.
    pub fn plus(&self, other: &Self, modulus: &Modulus) -> Self {
        let (p, q) = (self, other);
        let most = p.cn.abs().max((p.sn * q.dn).abs());
        if most == 0.0 {
            // At the top for ever.
            return *p;
        }
        let [a, b] = [p.cn, p.sn * q.dn].map(|c| c / most);
        let [p_dn, q_cn, q_dn] = [p.dn, q.cn, q.dn].map(|c| c / most);
        let below = a * a + b * b;
        let k2 = modulus.k * modulus.k;
        Self {
            sn: (b * q_cn + a * q.sn * p_dn) / below,
            cn: (a * q_cn - b * q.sn * p_dn) / below,
            dn: (p_dn * q_dn - k2 * p.sn * q_cn * q.sn * a) / below,
        }
    }
}
