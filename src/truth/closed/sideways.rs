//! How far rounding may push particles off a line they are meant to stay on.

use super::line::Off;

/// Growth of small offsets across a line of springs.
///
/// Across the line a spring under tension N acts like one of stiffness N / l, which changes as the
/// spring works, so that offsets may grow: by compression, or as the swing of a pendulum of springs
/// is pumped. With all stiffness over mass between `low` and `high`, and any reference c > 0,
/// |y'|² + c |y|² grows no faster than at twice max(high - c, c - low) / 2 √c.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sideways {
    off: Off,
    /// Largest over smallest mass norm of a unit offset.
    spread: f64,
    low: f64,
    high: f64,
}

impl Sideways {
    /// `low` and `high` bound the stiffness across the line over the mass, 1/s².
    pub fn new(off: Off, masses: &[f64], low: f64, high: f64) -> Self {
        let lightest = masses.iter().copied().fold(f64::INFINITY, f64::min);
        let spread = (masses.iter().sum::<f64>() / lightest).sqrt();
        Self {
            off,
            spread,
            low,
            high,
        }
    }

    /// No particle is farther off the line in [0, t], m.
    pub fn bound(&self, t: f64) -> f64 {
        let Self { low, high, off, .. } = *self;
        if t == 0.0 {
            return self.spread * off.position;
        }
        let c = (0.5 * (low + high)).max(-low).max(1.0 / (t * t));
        let rate = (high - c).max(c - low) / (2.0 * c.sqrt());
        let start = off.position.hypot((off.velocity + off.pull * t) / c.sqrt());
        // Twice, for terms of second order in the offset.
        2.0 * self.spread * start * (rate * t).exp()
    }
}
