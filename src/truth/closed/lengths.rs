//! Proof that springs on a line keep their length above 0, up to which they are linear.

use super::forced::{End, Forcing};
use super::mode::{Mode, Start};

/// A length may shrink to this fraction of itself in one step of the proof.
const SHRINK: f64 = 0.75;

/// Products of modes and springs after which the proof gives up.
const EFFORT: usize = 10_000_000;

/// A spring's length over time: its start plus a sum over the modes.
pub(super) struct Length {
    /// At the start, m.
    pub start: f64,
    /// Change of the length per unit of each mode.
    pub stretch: Vec<f64>,
    /// Driven ends, and which way they change the length.
    pub ends: Vec<(f64, End)>,
}

/// The motion of a mode.
pub(super) struct Moved {
    pub mode: Mode,
    pub start: Start,
    pub forcing: Forcing,
}

/// Bounds that hold from t = 0 to the end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bounds {
    /// Lengths, m.
    pub shortest: f64,
    pub longest: f64,
    /// Largest rate of change, m/s, either way.
    pub fastest: f64,
}

/// A mode at one time.
struct Instant {
    mode: Mode,
    position: f64,
    velocity: f64,
    /// The start of its motion from here on, where nothing is driven.
    start: Start,
}

/// What holds of a length at all times.
struct Outer {
    bounds: Bounds,
    driven: Option<Driven>,
}

/// The same where something is driven.
struct Driven {
    /// m.
    shortest: f64,
    /// Of its rate of change, m/s².
    acceleration: f64,
}

/// Bounds for each of these lengths, or None if one may come to `closest` or below before `until`.
///
/// Marches in time. At each instant the energies of the modes bound every later length, which ends
/// the proof as soon as it is enough; until then the length, its rate and a bound on its
/// acceleration give the next step in which no length shrinks below [`SHRINK`] of itself.
pub(super) fn bounds(
    modes: &[Moved],
    lengths: &[Length],
    until: f64,
    closest: f64,
) -> Option<Vec<Bounds>> {
    let outer: Vec<Outer> = lengths.iter().map(|l| l.outer(modes, until)).collect();
    let mut bounds: Vec<Bounds> = outer.iter().map(|outer| outer.bounds).collect();
    let mut t = 0.0;
    let work = (lengths.len() * modes.len()).max(1);
    for _ in 0..EFFORT / work {
        let now: Vec<Instant> = modes.iter().map(|moved| Instant::new(t, moved)).collect();
        let left = until - t;
        let mut step = left;
        let mut proven = true;
        for ((length, bounds), outer) in lengths.iter().zip(&mut bounds).zip(&outer) {
            let [apart, parting] = length.ends_at(t);
            let l = length.start + length.sum(&now, |s, now| s * now.position) + apart;
            bounds.shortest = bounds.shortest.min(l);
            if l <= closest {
                return None;
            }
            // The most it may lose from now on, as a negative number.
            let lost = length.sum(&now, |s, now| {
                s.abs() * now.mode.lowest(now.start.times(s.signum()), left)
            });
            // What is driven has its energy from outside: only bounds for all time hold.
            let lowest = match &outer.driven {
                Some(driven) => driven.shortest,
                None => l + lost,
            };
            if lowest > SHRINK * l {
                bounds.shortest = bounds.shortest.min(lowest);
                continue;
            }
            proven = false;
            let speed = length.sum(&now, |s, now| s * now.velocity) + parting;
            let most = match &outer.driven {
                Some(driven) => driven.acceleration,
                None => length.sum(&now, |s, now| {
                    s.abs() * now.mode.acceleration_bound(now.start, left)
                }),
            };
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

/// The least time, s, to lose `room`, m, at this speed and at most this acceleration.
fn safe(speed: f64, most: f64, room: f64) -> f64 {
    let root = speed.hypot((2.0 * most * room).sqrt());
    // The positive root of most s² / 2 - speed s - room, without cancellation.
    if speed > 0.0 {
        (speed + root) / most
    } else {
        2.0 * room / (root - speed)
    }
}

impl Instant {
    fn new(t: f64, moved: &Moved) -> Self {
        let Moved {
            mode,
            start,
            forcing,
        } = moved;
        let (mode, start) = (*mode, *start);
        let response = mode.response(t);
        let [forced, faster] = forcing.moved(&mode, &response, t);
        let position = response.position(start) + forced;
        let velocity = start.velocity + response.gained(start) + faster;
        Self {
            mode,
            position,
            velocity,
            start: Start {
                velocity,
                pull: start.pull - mode.w * mode.w * position,
            },
        }
    }
}

impl Length {
    /// The sum over the modes of `of`, which takes the stretch per unit of a mode.
    fn sum(&self, now: &[Instant], of: impl Fn(f64, &Instant) -> f64) -> f64 {
        let terms = self.stretch.iter().zip(now);
        terms.map(|(&s, now)| of(s, now)).sum()
    }

    /// Bounds from the modes' energies alone; `shortest` is still the length at the start.
    fn outer(&self, modes: &[Moved], until: f64) -> Outer {
        let mut sums = [0.0; 3];
        let mut driven = !self.ends.is_empty();
        for (moved, s) in modes.iter().zip(&self.stretch) {
            let Moved { mode, start, .. } = moved;
            driven |= moved.forcing != Forcing::default();
            let own = [
                mode.travel_bound(*start, until),
                mode.speed_bound(*start, until),
                mode.acceleration_bound(*start, until),
            ];
            let forced = moved.forcing.bounds(mode, until);
            for ((sum, own), forced) in sums.iter_mut().zip(own).zip(forced) {
                *sum += s.abs() * (own + forced);
            }
        }
        for (_, end) in &self.ends {
            for (sum, own) in sums.iter_mut().zip(end.bounds(until)) {
                *sum += own;
            }
        }
        let [way, speed, acceleration] = sums;
        Outer {
            bounds: Bounds {
                shortest: self.start,
                longest: self.start + way,
                fastest: speed,
            },
            driven: driven.then_some(Driven {
                shortest: self.start - way,
                acceleration,
            }),
        }
    }

    /// How much driven ends have changed the length, m, and how fast they do, m/s.
    fn ends_at(&self, t: f64) -> [f64; 2] {
        let mut sum = [0.0; 2];
        for (sign, end) in &self.ends {
            let [moved, speed] = end.at(t);
            sum[0] += sign * moved;
            sum[1] += sign * speed;
        }
        sum
    }
}
