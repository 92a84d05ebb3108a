//! One mode: x'' = -κ x - c x'.

use nalgebra::Complex;

/// Its two eigenvalues are the roots of λ² + c λ + κ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Mode {
    /// κ = ω², 1/s².
    pub stiffness: f64,
    /// c, 1/s.
    pub damping: f64,
}

impl Mode {
    /// The one an eigenvalue belongs to, or, of a real one, that decays as it does.
    pub(super) fn of(root: Complex<f64>) -> Self {
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

    /// Its eigenvalues other than 0 with Im >= 0: two real ones, or one of a pair.
    pub(super) fn roots(self) -> Vec<Complex<f64>> {
        let (k, half) = (self.stiffness, 0.5 * self.damping);
        if self.oscillates() {
            return vec![Complex::new(-half, (k - half * half).max(0.0).sqrt())];
        }
        let far = -(half + (half * half - k).max(0.0).sqrt());
        let near = if far == 0.0 { 0.0 } else { k / far };
        [far, near]
            .into_iter()
            .filter(|root| *root != 0.0)
            .map(|root| Complex::new(root, 0.0))
            .collect()
    }

    /// Less than critically damped, by more than rounding.
    pub(super) fn oscillates(self) -> bool {
        let half = 0.5 * self.damping;
        self.stiffness > half * half * (1.0 + 1e-12)
    }

    /// Undamped angular frequency, rad/s.
    pub(super) fn omega(self) -> f64 {
        self.stiffness.max(0.0).sqrt()
    }

    /// The larger of its two rates, 1/s.
    pub(super) fn rate(self) -> f64 {
        self.omega().max(self.damping.abs())
    }

    /// `mode of 7.07 rad/s, damping ratio 0.1` or `decay at 2 1/s`.
    pub(super) fn words(self) -> String {
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
