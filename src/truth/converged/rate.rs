//! The fastest rate of a system at one state: what decides how small steps must be.

use crate::physics::{State, System};
use crate::truth::farthest;

/// More iterations change little: a factor of two in the rate is one halving.
const ITERATIONS: usize = 20;

/// An estimate of the largest |eigenvalue| of the linearised motion, 1/s: with w² and c the largest
/// eigenvalues of the acceleration's slopes by position and by velocity,
/// c / 2 + sqrt(w² + c² / 4). 0 where nothing depends on the state; None where the acceleration is
/// not finite.
///
/// By power iteration on differences, from a fixed start. Not a bound: elsewhere on the path the
/// system may be faster.
pub(super) fn fastest_rate(system: &dyn System, start: &State, size: f64) -> Option<f64> {
    let dim = system.dim();
    let mut at_start = vec![0.0; dim];
    system.acceleration(start.t, &start.x, &start.v, &mut at_start);
    if !at_start.iter().all(|a| a.is_finite()) {
        return None;
    }
    let mut moved = vec![0.0; dim];
    let mut a = vec![0.0; dim];
    let free = |at: usize| system.inverse_mass()[at] > 0.0;

    // Small against the size, large against rounding.
    let step = 1e-7 * if size > 0.0 { size } else { 1.0 };
    let by_position = power_iteration(dim, free, |direction, image| {
        for at in 0..dim {
            moved[at] = start.x[at] + step * direction[at];
        }
        system.acceleration(start.t, &moved, &start.v, &mut a);
        for at in 0..dim {
            image[at] = (a[at] - at_start[at]) / step;
        }
    });
    let by_velocity = if system.kinds().depends_on_velocity() {
        power_iteration(dim, free, |direction, image| {
            system.damping(start.t, &start.x, direction, image);
        })
    } else {
        0.0
    };
    let half = by_velocity / 2.0;
    Some(half + (by_position + half * half).sqrt())
}

/// The largest growth of a vector under the map in the last iterations.
fn power_iteration(
    dim: usize,
    free: impl Fn(usize) -> bool,
    mut map: impl FnMut(&[f64], &mut [f64]),
) -> f64 {
    let mut direction: Vec<f64> = (0..dim)
        .map(|at| if free(at) { scatter(at) } else { 0.0 })
        .collect();
    let zero = vec![0.0; dim];
    let mut image = vec![0.0; dim];
    let mut largest = 0.0_f64;
    for _ in 0..ITERATIONS {
        let length = farthest(&direction, &zero);
        if length == 0.0 || !length.is_finite() {
            break;
        }
        for c in &mut direction {
            *c /= length;
        }
        map(&direction, &mut image);
        largest = farthest(&image, &zero);
        std::mem::swap(&mut direction, &mut image);
    }
    largest
}

/// A fixed number in [-1, 1) for each coordinate: fractional parts of multiples of the golden ratio,
/// which follow no pattern of a scene.
pub(super) fn scatter(at: usize) -> f64 {
    2.0 * ((at + 1) as f64 * 0.618_033_988_749_894_9).fract() - 1.0
}
