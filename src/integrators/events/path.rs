//! The path of a particle within a step, and where on it a gap closes.

use super::root::Due;
use crate::physics::State;
use crate::physics::constraints::contact::{Against, Near, Obstacles};
use crate::space::{minus, norm, three};
use std::borrow::Borrow;
use std::sync::Arc;

/// The cubic through both ends of a particle's path, over the part s of a step.
#[derive(Debug, Clone)]
pub(super) struct Path {
    h: f64,
    x: [[f64; 3]; 2],
    v: [[f64; 3]; 2],
}

impl Path {
    #[inline]
    pub fn new(particle: usize, h: f64, start: &State, end: &State) -> Self {
        Self {
            h,
            x: [three(&start.x, particle), three(&end.x, particle)],
            v: [three(&start.v, particle), three(&end.v, particle)],
        }
    }

    #[inline]
    pub fn at(&self, s: f64) -> [f64; 3] {
        let r = 1.0 - s;
        let along = |c: usize| {
            let way = self.x[1][c] - self.x[0][c];
            let bend = r * (self.h * self.v[0][c] - way) - s * (self.h * self.v[1][c] - way);
            self.x[0][c] + s * (way + r * bend)
        };
        [along(0), along(1), along(2)]
    }

    pub fn velocity(&self, s: f64) -> [f64; 3] {
        let r = 1.0 - s;
        [0, 1, 2].map(|c| {
            let mean = (self.x[1][c] - self.x[0][c]) / self.h;
            let (from, to) = (self.v[0][c] - mean, self.v[1][c] - mean);
            mean + from * r * (1.0 - 3.0 * s) - to * s * (2.0 - 3.0 * s)
        })
    }

    /// Puts the particle where it is at s, in a state of all.
    pub fn put(&self, particle: usize, s: f64, state: &mut State) {
        let own = 3 * particle..3 * particle + 3;
        state.x[own.clone()].copy_from_slice(&self.at(s));
        state.v[own].copy_from_slice(&self.velocity(s));
    }

    /// Adds a change of velocity from s on.
    pub fn bend(&mut self, s: f64, change: [f64; 3]) {
        for (axis, change) in change.into_iter().enumerate() {
            self.x[0][axis] -= change * s * self.h;
            self.x[1][axis] += change * (1.0 - s) * self.h;
            self.v[0][axis] += change;
            self.v[1][axis] += change;
        }
    }

    /// A cube that it keeps within: its centre, and half a side, m.
    #[inline]
    pub fn cube(&self) -> ([f64; 3], f64) {
        let center = |c: usize| 0.5 * (self.x[0][c] + self.x[1][c]);
        let long = |c: usize| {
            let way = self.x[1][c] - self.x[0][c];
            let off = |v: [f64; 3]| (self.h * v[c] - way).abs();
            way.abs() + off(self.v[0]) + off(self.v[1])
        };
        let half = 0.5 * long(0).max(long(1)).max(long(2));
        ([center(0), center(1), center(2)], half)
    }

    /// It is not longer, m.
    #[inline]
    pub fn length(&self) -> f64 {
        let way = minus(self.x[1], self.x[0]);
        let off = |v: [f64; 3]| norm(minus([self.h * v[0], self.h * v[1], self.h * v[2]], way));
        norm(way) + off(self.v[0]) + off(self.v[1])
    }
}

/// What may touch on the paths of all through a sub-step of `h` seconds.
pub(super) fn near(obstacles: &Obstacles, h: f64, start: &State, end: &State) -> Arc<Near> {
    obstacles.near([start.t, start.t + h], |particle| {
        Path::new(particle, h, start, end).cube()
    })
}

/// When the gap of a pair closes on the paths of a step from `t` on of `h` seconds, after a part s of it; with a `side` of
/// -1 when the depth does.
pub(super) fn meeting<P: Borrow<Path>>(
    obstacles: &Obstacles,
    (particle, against): (usize, Against),
    (s, side): (f64, f64),
    [t, h]: [f64; 2],
    path: impl Fn(usize) -> P,
) -> Option<Due<(usize, Against)>> {
    let own = path(particle);
    let own: &Path = own.borrow();
    let other = match against {
        Against::Particle(other) => Some((other, path(other))),
        Against::Obstacle(_) => None,
    };
    let left = |s: f64| {
        let at = |which: usize| match &other {
            Some((other, path)) if *other == which => path.borrow().at(s),
            _ => own.at(s),
        };
        side * obstacles.gap(particle, against, t + s * h, at)
    };
    let others = other
        .as_ref()
        .map_or(0.0, |(_, path)| path.borrow().length());
    let reach = obstacles.reach(against, t, t + h);
    let bound = own.length() + reach + others;
    if left(1.0) > bound {
        return None;
    }
    let ([clear, due], level) = crossing(left, s, bound, obstacles.close(own.at(s)))?;
    Some(Due {
        event: (particle, against),
        clear: clear * h,
        due: due * h,
        level,
    })
}

/// Where a gap first becomes negative after a part `from` of a step, as parts of it, before and after; and the level it
/// falls below. `bound` is the most that it changes over the whole step. A gap that starts within `close` of 0, after a
/// bounce, and never rises above that has to fall clearly below 0.
fn crossing(
    gap: impl Fn(f64) -> f64,
    from: f64,
    bound: f64,
    close: f64,
) -> Option<([f64; 2], f64)> {
    const SHORT: f64 = 1e-6;
    const RISEN: f64 = 1e-2;
    let (mut clear, mut s, mut short) = (from, from, SHORT);
    let mut level = -2.0 * close;
    let mut now = gap(s);
    loop {
        if now > close {
            level = 0.0;
        }
        if now < level {
            // A bounce may be over before it was seen to rise.
            let mut halves = (1..=40).map(|k| from + (s - from) * 0.5_f64.powi(k));
            return match halves.find(|s| level < 0.0 && gap(*s) > RISEN * close) {
                Some(risen) => Some(([risen, s], 0.0)),
                None => Some(([clear, s], level)),
            };
        }
        if now > level {
            clear = s;
        }
        if s >= 1.0 {
            return None;
        }
        // The gap changes by no more than the path is long.
        let safe = now.max(0.0) / bound;
        if safe > short {
            (s, short) = ((s + safe).min(1.0), SHORT);
            now = gap(s);
            continue;
        }
        let (to, before) = ((s + short).min(1.0), now);
        now = gap(to);
        if now >= level
            && before >= level
            && let Some(inside) = dip(&gap, [s, to], [before, now], level)
        {
            return Some(([s.max(clear), inside], level));
        }
        (s, short) = (to, 1.5 * short);
    }
}

/// Where between two parts of a step, with these gaps, a gap falls below a level and rises again: along a straight line
/// the distance from a convex body has one minimum.
fn dip(gap: impl Fn(f64) -> f64, [from, to]: [f64; 2], ends: [f64; 2], level: f64) -> Option<f64> {
    let (mut low, mut high, mut middle) = (from, to, 0.5 * (from + to));
    let ([mut before, mut after], mut least) = (ends, gap(middle));
    for _ in 0..100 {
        if least < level {
            return Some(middle);
        }
        // No convex function through these three is lower on either side.
        let lowest = (2.0 * least - before).min(2.0 * least - after);
        if lowest >= level || high - low <= 1e-15 {
            return None;
        }
        let sides = [0.5 * (low + middle), 0.5 * (middle + high)];
        let [left, right] = sides.map(&gap);
        if left <= least && left <= right {
            (high, after, middle, least) = (middle, least, sides[0], left);
        } else if right <= least {
            (low, before, middle, least) = (middle, least, sides[1], right);
        } else {
            (low, before, high, after) = (sides[0], left, sides[1], right);
        }
    }
    None
}
