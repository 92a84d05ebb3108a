//! What theory says of a method on linear systems: how far one step carries a mode.

use super::{DampingTreatment, Stage};

/// The one-step map on x'' = -K x - C v.
#[derive(Debug, Clone, Copy)]
pub enum Amplification {
    /// A step multiplies each eigenvector of the first-order system by R(hλ), R = P / Q. So for all
    /// Runge-Kutta methods (Hairer, Wanner, Solving ODEs II, IV.2-3).
    Rational {
        /// Coefficients of P, ascending, the first 1.
        numerator: &'static [f64],
        /// Coefficients of Q, ascending, the first 1.
        denominator: &'static [f64],
    },
    /// A product of drifts and kicks: more than the eigenvalues decides, since kicks see the damping
    /// and drifts do not.
    Composition(&'static [Stage], DampingTreatment),
    /// (I + h C + h² K') v1 = v0 - h K x0, x1 = x0 + h v1: linearly implicit Euler whose matrix holds
    /// the stiffness along springs, K', only
    /// ([`Linearization::Material`](crate::system::Linearization)).
    MaterialImplicit,
}

impl Amplification {
    /// Of an explicit method with as many stages as its order p: the exponential series to z^p / p!.
    pub(super) const EXPLICIT_1: Self = polynomial(&[1.0, 1.0]);
    pub(super) const EXPLICIT_2: Self = polynomial(&[1.0, 1.0, 0.5]);
    pub(super) const EXPLICIT_4: Self = polynomial(&[1.0, 1.0, 0.5, 1.0 / 6.0, 1.0 / 24.0]);
    /// 1 / (1 - z).
    pub(super) const BACKWARD_EULER: Self = Self::Rational {
        numerator: &[1.0],
        denominator: &[1.0, -1.0],
    };
    /// (1 + z/2) / (1 - z/2).
    pub(super) const CAYLEY: Self = Self::Rational {
        numerator: &[1.0, 0.5],
        denominator: &[1.0, -0.5],
    };
}

const fn polynomial(numerator: &'static [f64]) -> Amplification {
    Amplification::Rational {
        numerator,
        denominator: &[1.0],
    }
}
