//! Proof that springs on a line keep their length above 0, up to which they are linear.

use super::mode::Mode;
use super::modes::Modes;
use super::part::Axis;

/// A length may shrink to this share of itself in one step of the proof.
const SHRINK: f64 = 0.75;

/// Products of modes and springs after which the proof gives up.
const EFFORT: usize = 10_000_000;

/// A spring's length over time: l0 plus a sum over the modes.
struct Length {
    start: f64,
    /// Of each mode.
    stretch: Vec<f64>,
}

/// Bounds that hold from t = 0 to the end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bounds {
    /// Lengths, m.
    pub shortest: f64,
    pub longest: f64,
    /// Rate of change, m/s, either way.
    pub fastest: f64,
}

/// Bounds for each of these springs, of which the ends, in their order along the axis, and the length at the
/// start are given. None if a length may come to `closest` or below before `until`.
///
/// Marches in time. At each instant the energies of the modes bound every later length, which ends
/// the proof as soon as it is enough; until then the length, its rate and a bound on its
/// acceleration give the next step in which no length shrinks below [`SHRINK`] of itself.
pub(super) fn bounds(
    modes: &Modes,
    axis: &Axis,
    springs: &[([Option<usize>; 2], f64)],
    until: f64,
    closest: f64,
) -> Option<Vec<Bounds>> {
    let lengths: Vec<Length> = springs
        .iter()
        .map(|&(ends, start)| Length {
            start,
            stretch: (0..modes.modes.len())
                .map(|j| modes.stretch(j, ends))
                .collect(),
        })
        .collect();
    let mut bounds: Vec<Bounds> = lengths
        .iter()
        .map(|l| l.outer(modes, axis, until))
        .collect();
    let mut t = 0.0;
    let work = (lengths.len() * modes.modes.len()).max(1);
    for _ in 0..EFFORT / work {
        let now = Instant::at(t, modes, axis);
        let left = until - t;
        let mut step = left;
        let mut proven = true;
        for (length, bounds) in lengths.iter().zip(&mut bounds) {
            let l = length.start + length.sum(|j| now.position[j]);
            bounds.shortest = bounds.shortest.min(l);
            if l <= closest {
                return None;
            }
            let lowest = l + length.lowest(modes, &now, left);
            if lowest > SHRINK * l {
                bounds.shortest = bounds.shortest.min(lowest);
                continue;
            }
            proven = false;
            let speed = length.sum(|j| now.velocity[j]);
            let most = |j: usize| {
                let (mode, s) = (modes.modes[j], length.stretch[j]);
                s.abs() * mode.acceleration_bound(now.velocity[j], now.pull[j], left)
            };
            let most: f64 = (0..modes.modes.len()).map(most).sum();
            step = step.min(safe(speed, most, (1.0 - SHRINK) * l));
            bounds.shortest = bounds.shortest.min(SHRINK * l);
        }
        if proven || t + step >= until {
            return Some(bounds);
        }
        // Too short to move the clock: no proof.
        if t + step == t {
            return None;
        }
        t += step;
    }
    None
}

/// How long it takes at least to lose `room` at this speed and no more than this acceleration.
fn safe(speed: f64, most: f64, room: f64) -> f64 {
    let root = speed.hypot((2.0 * most * room).sqrt());
    // The positive root of most s² / 2 - speed s - room, without cancellation.
    if speed > 0.0 {
        (speed + root) / most
    } else {
        2.0 * room / (root - speed)
    }
}

/// All modes at one time.
struct Instant {
    position: Vec<f64>,
    velocity: Vec<f64>,
    /// Acceleration without damping.
    pull: Vec<f64>,
}

impl Instant {
    fn at(t: f64, modes: &Modes, axis: &Axis) -> Self {
        let n = modes.modes.len();
        let mut now = Self {
            position: Vec::with_capacity(n),
            velocity: Vec::with_capacity(n),
            pull: Vec::with_capacity(n),
        };
        for (j, mode) in modes.modes.iter().enumerate() {
            let response = mode.response(t);
            let position = response.position(axis.velocity[j], axis.pull[j]);
            let gained = response.gained(axis.velocity[j], axis.pull[j]);
            now.position.push(position);
            now.velocity.push(axis.velocity[j] + gained);
            now.pull.push(axis.pull[j] - mode.w * mode.w * position);
        }
        now
    }
}

impl Length {
    fn sum(&self, of: impl Fn(usize) -> f64) -> f64 {
        self.stretch
            .iter()
            .enumerate()
            .map(|(j, s)| s * of(j))
            .sum()
    }

    /// What the length may lose at most from `now` on, as a negative number.
    fn lowest(&self, modes: &Modes, now: &Instant, left: f64) -> f64 {
        let of = |(j, s): (usize, &f64)| {
            let sign = s.signum();
            let mode: Mode = modes.modes[j];
            s.abs() * mode.lowest(sign * now.velocity[j], sign * now.pull[j], left)
        };
        self.stretch.iter().enumerate().map(of).sum()
    }

    /// Bounds from the modes' energies alone; the shortest is not one yet.
    fn outer(&self, modes: &Modes, axis: &Axis, until: f64) -> Bounds {
        let mut bounds = Bounds {
            shortest: self.start,
            longest: self.start,
            fastest: 0.0,
        };
        for (j, mode) in modes.modes.iter().enumerate() {
            let (velocity, pull) = (axis.velocity[j], axis.pull[j]);
            let s = self.stretch[j].abs();
            bounds.longest += s * mode.travel_bound(velocity, pull, until);
            bounds.fastest += s * mode.speed_bound(velocity, pull, until);
        }
        bounds
    }
}
