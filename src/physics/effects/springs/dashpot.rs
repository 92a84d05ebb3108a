//! The force law of one spring and its damper.

use super::{AXIAL, ISOTROPIC, SHORTEST, dot};

/// What a spring knows of its ends.
pub(super) struct Pair {
    /// From the first end to the second, m.
    pub between: [f64; 3],
    /// Relative velocity times `between`, m²/s; with axial dampers.
    pub closing: f64,
    /// Relative velocity, m/s; with isotropic dampers.
    pub relative: [f64; 3],
}

/// The force on the first end of a spring of stiffness, rest length and damping, N, and the power it
/// dissipates, W.
#[inline(always)]
pub(super) fn one<const MODEL: u8, const ELASTIC: bool>(
    pair: Pair,
    [stiffness, rest_length, damping]: [f64; 3],
) -> ([f64; 3], f64) {
    let Pair {
        between,
        closing,
        relative,
    } = pair;
    let length = dot(between, between).sqrt();
    // As f64::max: of NaN and a number the number.
    let length = if length > SHORTEST { length } else { SHORTEST };
    let mut pull = 0.0;
    if ELASTIC {
        pull = stiffness * (length - rest_length);
    }
    let mut loss = 0.0;
    let along = if MODEL == AXIAL {
        // One division for two: a division costs as much as all the rest.
        let inverse = 1.0 / length;
        let rate = closing * inverse;
        let resistance = damping * rate;
        loss = resistance * rate;
        (pull + resistance) * inverse
    } else {
        pull / length
    };
    let mut force = [along * between[0], along * between[1], along * between[2]];
    if MODEL == ISOTROPIC {
        for axis in 0..3 {
            let resistance = damping * relative[axis];
            force[axis] = if ELASTIC {
                force[axis] + resistance
            } else {
                resistance
            };
        }
        loss = damping * dot(relative, relative);
    }
    (force, loss)
}
