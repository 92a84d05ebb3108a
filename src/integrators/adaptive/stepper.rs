//! The stepper that all pairs share: it tries a step, and accepts it or tries a shorter one.

use super::Pair;
use super::trial::{Scale, Trial};
use crate::integrators::StepError;
use crate::physics::{State, System};

/// The tightest tolerance, given rounding.
const TIGHTEST: f64 = 4.0 * f64::EPSILON;
/// Steps shorter than this fraction of the time they start at are refused.
const SPACING: f64 = 10.0 * f64::EPSILON;

/// The controller aims at an error somewhat below the tolerance.
const SAFETY: f64 = 0.9;
/// The smallest and largest factor by which the step may change at once.
const CHANGE: [f64; 2] = [0.2, 10.0];
/// The least error the controller remembers, as in DOPRI5.
const LEAST: f64 = 1e-4;
/// The exponent of the proportional part, as in DOPRI5. DOP853 has none by default, but with it fewer steps
/// are rejected and errors are smaller for the same evaluations.
const BETA: f64 = 0.04;

/// Gustafsson's PI controller as in DOPRI5 (Gustafsson 1991, ACM TOMS 17; Hairer, Nørsett, Wanner,
/// Solving ODEs II, IV.2, and I, II.4): h times 0.9 e^-(1/k - 3 β / 4) e'^β, with e' the error of the
/// step before. Errors are in units of the tolerance.
#[derive(Debug, Clone)]
struct Controller {
    alpha: f64,
    /// The error of the last accepted step.
    before: f64,
    /// Whether the last attempt was rejected.
    failed: bool,
}

impl Controller {
    /// For an estimate that falls as h^k.
    fn new(k: u32) -> Self {
        Self {
            alpha: 1.0 / f64::from(k) - 0.75 * BETA,
            before: LEAST,
            failed: false,
        }
    }

    /// The next step after one of `h` that was accepted with this error.
    fn accepted(&mut self, h: f64, error: f64) -> f64 {
        let factor = SAFETY * error.powf(-self.alpha) * self.before.powf(BETA);
        self.before = error.max(LEAST);
        // A length that was just rejected is not tried again.
        let most = if self.failed { 1.0 } else { CHANGE[1] };
        self.failed = false;
        h * factor.max(CHANGE[0]).min(most)
    }

    /// The step to try after `h` was rejected with this error, which may be NaN.
    fn rejected(&mut self, h: f64, error: f64) -> f64 {
        self.failed = true;
        let factor = SAFETY * error.powf(-self.alpha);
        let factor = if factor.is_nan() { CHANGE[0] } else { factor };
        h * factor.clamp(CHANGE[0], SAFETY)
    }
}

/// The adaptive stepper: a pair with a tolerance.
///
/// The tolerance bounds the error that a step adds to any coordinate, as the pair estimates it. Positions
/// are in units of the scene's size L, and velocities in units of V, the largest of: the speeds so far,
/// sqrt(L a) with the largest acceleration a at the start, and L over the duration. The error at the end of
/// a run is proportional to the tolerance, not equal to it: errors of many steps add up, grow with the
/// motion, and are overestimated. Work integrals are not controlled.
///
/// It serves one system, remembers only the last step's end, and accepts any state.
pub struct Adaptive {
    trial: Trial,
    controller: Controller,
    tolerance: f64,
    size: f64,
    /// The scale of errors and the step to try next, s; set from the first step on.
    started: Option<(Scale, f64)>,
    k: u32,
    rejected: u64,
}

impl Adaptive {
    /// `size` is the scene's in metres, 0 where it has none. `tolerance` is clamped to [4 eps, 1]; NaN
    /// becomes 4 eps.
    pub fn new(pair: &Pair, tolerance: f64, size: f64) -> Self {
        let k = pair.estimate.order();
        let tolerance = if tolerance.is_nan() {
            TIGHTEST
        } else {
            tolerance
        };
        Self {
            trial: Trial::new(pair),
            controller: Controller::new(k),
            tolerance: tolerance.clamp(TIGHTEST, 1.0),
            size,
            started: None,
            k,
            rejected: 0,
        }
    }

    /// The number of rejected attempts so far.
    pub fn rejected(&self) -> u64 {
        self.rejected
    }

    /// Advances a state by one step that the stepper chooses. The last step ends exactly at `until`; a state
    /// that is already there stays as it is. On an error the state is left as it was.
    ///
    /// # Errors
    /// [`StepError::TooShort`] where no step is short enough for the tolerance,
    /// [`StepError::NotFinite`] where forces are not finite.
    pub fn step(
        &mut self,
        system: &dyn System,
        until: f64,
        state: &mut State,
    ) -> Result<(), StepError> {
        let left = until - state.t;
        // A NaN in either time leaves nothing to do.
        if !(left > 0.0 && left.is_finite()) {
            return Ok(());
        }
        self.trial.begin(system, state);
        let (mut scale, mut h) = self.started(system, state.t, left)?;
        loop {
            let unlimited = h;
            if h >= left / 1.01 {
                h = left;
            } else if h > 0.5 * left {
                // Two equal steps are better than a long one and a short one.
                h = 0.5 * left;
            }
            let end = if h == left { until } else { state.t + h };
            // h is the difference of the two times, so that steps add up to the time.
            h = end - state.t;
            if h <= SPACING * state.t || h <= 0.0 {
                return Err(self.too_short(state.t));
            }
            let error = self.trial.attempt(system, state.t, h, &scale) / self.tolerance;
            if error <= 1.0 {
                let Some(speed) = self.trial.accept(h, end, state) else {
                    return Err(self.not_finite());
                };
                let next = self.controller.accepted(h, error);
                // A step that was shortened to meet the end does not shorten the next one.
                let next = if h < unlimited {
                    next.max(unlimited)
                } else {
                    next
                };
                scale.speed = scale.speed.max(speed);
                self.started = Some((scale, next));
                return Ok(());
            }
            self.rejected += 1;
            h = self.controller.rejected(h, error);
        }
    }

    /// The scale and the step to try. At the first call they follow from the state, `left` seconds before
    /// the end.
    ///
    /// The first step is (tolerance / 100)^(1/k) / rate. This is Hairer's rule (Solving ODEs I, II.4) with a
    /// rate from the first and second derivative, so it does not depend on the unit of time.
    fn started(
        &mut self,
        system: &dyn System,
        t: f64,
        left: f64,
    ) -> Result<(Scale, f64), StepError> {
        if !self.trial.is_finite() {
            return Err(self.not_finite());
        }
        if let Some(started) = self.started {
            return Ok(started);
        }
        let scale = self.trial.scale(self.size, left);
        let rate = self.trial.rate(system, t, left, &scale);
        let fraction = (0.01 * self.tolerance).powf(1.0 / f64::from(self.k));
        let h = fraction / rate;
        let h = if h < left { h } else { left };
        self.started = Some((scale, h));
        Ok((scale, h))
    }

    fn too_short(&self, t: f64) -> StepError {
        match self.trial.not_finite() {
            Some(particle) => StepError::NotFinite { particle },
            None => StepError::TooShort {
                t,
                particle: self.trial.worst(),
            },
        }
    }

    fn not_finite(&self) -> StepError {
        let particle = self.trial.not_finite().unwrap_or(0);
        StepError::NotFinite { particle }
    }
}
