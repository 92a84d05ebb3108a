//! What a tolerance is relative to.

use crate::integrators::largest;

/// A length for errors in position and a speed for errors in velocity. Both scale with the units, so
/// that a tolerance means the same in any.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scale {
    /// m.
    pub length: f64,
    /// m/s; grows with the largest speed so far.
    pub speed: f64,
}

impl Scale {
    /// At the start of a run of `time` seconds with these velocities and accelerations, in a scene of
    /// `size` metres; where it has no size, the way a free particle would go.
    ///
    /// The speed is the largest of: the speeds; what the largest acceleration gives over the length,
    /// sqrt(L a), which for an oscillator from rest is its top speed; and L / time, slower than which
    /// nothing gets anywhere.
    pub fn new(size: f64, time: f64, v: &[f64], a: &[f64]) -> Self {
        let (speed, acceleration) = (largest(v), largest(a));
        let flight = speed * time + 0.5 * acceleration * time * time;
        let length = [size, flight]
            .into_iter()
            .find(|l| *l > 0.0 && l.is_finite());
        let length = length.unwrap_or(1.0);
        let gained = length.sqrt() * acceleration.sqrt();
        let least = length / time;
        Self {
            length,
            speed: speed.max(gained).max(least),
        }
    }
}
