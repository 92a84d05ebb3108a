//! How long the next step is, from the error of the last.

/// Errors aim at somewhat less than allowed.
const SAFETY: f64 = 0.9;
/// By what a step may change at once.
const CHANGE: [f64; 2] = [0.2, 10.0];
/// Errors below this are no reason for more.
const LEAST: f64 = 1e-4;
/// The proportional part, as in DOPRI5. DOP853 comes without by default, but has fewer steps rejected
/// and smaller errors for its evaluations with it.
const BETA: f64 = 0.04;

/// Gustafsson's PI controller as in DOPRI5 (Gustafsson 1991, ACM TOMS 17; Hairer, Nørsett, Wanner,
/// Solving ODEs II, IV.2, and I, II.4): h times 0.9 e^-(1/k - 3 β / 4) e'^β, with e' the error of the
/// step before; errors are in units of what is allowed.
#[derive(Debug, Clone)]
pub(super) struct Controller {
    alpha: f64,
    /// Of the last accepted step.
    before: f64,
    /// The last attempt failed.
    failed: bool,
}

impl Controller {
    /// For an estimate that falls as h^k.
    pub fn new(k: u32) -> Self {
        Self {
            alpha: 1.0 / f64::from(k) - 0.75 * BETA,
            before: LEAST,
            failed: false,
        }
    }

    /// The step after one of `h` that was accepted with this error.
    pub fn accepted(&mut self, h: f64, error: f64) -> f64 {
        let factor = SAFETY * error.powf(-self.alpha) * self.before.powf(BETA);
        self.before = error.max(LEAST);
        // What has just failed is not tried again.
        let most = if self.failed { 1.0 } else { CHANGE[1] };
        self.failed = false;
        h * factor.max(CHANGE[0]).min(most)
    }

    /// What to try after `h` was rejected with this error, which may be NaN.
    pub fn rejected(&mut self, h: f64, error: f64) -> f64 {
        self.failed = true;
        let factor = SAFETY * error.powf(-self.alpha);
        let factor = if factor.is_nan() { CHANGE[0] } else { factor };
        h * factor.clamp(CHANGE[0], SAFETY)
    }
}
