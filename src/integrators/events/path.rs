//! The path of a particle within a step, and where on it a gap closes.

use super::root::Due;
use crate::physics::State;
use crate::physics::constraints::contact::{Against, Near, Obstacles};
use crate::space::{norm, three};
use std::sync::Arc;

/// The cubic through both ends of a particle's path, over the part s of a step.
pub(super) struct Path {
    h: f64,
    x: [[f64; 3]; 2],
    v: [[f64; 3]; 2],
}

impl Path {
    pub fn new(particle: usize, h: f64, start: &State, end: &State) -> Self {
        let both = |all: [&[f64]; 2]| all.map(|all| three(all, particle));
        Self {
            h,
            x: both([&start.x, &end.x]),
            v: both([&start.v, &end.v]),
        }
    }

    pub fn at(&self, s: f64) -> [f64; 3] {
        let r = 1.0 - s;
        [0, 1, 2].map(|c| {
            let way = self.x[1][c] - self.x[0][c];
            let bend = r * (self.h * self.v[0][c] - way) - s * (self.h * self.v[1][c] - way);
            self.x[0][c] + s * (way + r * bend)
        })
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

    /// A ball that it keeps within: its centre, and its radius, m.
    pub fn ball(&self) -> ([f64; 3], f64) {
        let center = [0, 1, 2].map(|c| 0.5 * (self.x[0][c] + self.x[1][c]));
        (center, 0.5 * self.length())
    }

    /// It is not longer, m.
    pub fn length(&self) -> f64 {
        let way = [0, 1, 2].map(|c| self.x[1][c] - self.x[0][c]);
        let off = |v: [f64; 3]| norm([0, 1, 2].map(|c| self.h * v[c] - way[c]));
        norm(way) + off(self.v[0]) + off(self.v[1])
    }
}

/// What may touch on the paths of all through a sub-step of `h` seconds.
pub(super) fn near(obstacles: &Obstacles, h: f64, start: &State, end: &State) -> Arc<Near> {
    obstacles.near([start.t, start.t + h], |particle| {
        Path::new(particle, h, start, end).ball()
    })
}

/// When the gap of a particle closes on the paths through both ends of a sub-step of `h` seconds; with a `side` of -1 when
/// the depth does.
pub(super) fn meeting<E>(
    obstacles: &Obstacles,
    (particle, against): (usize, Against),
    (event, side): (E, f64),
    h: f64,
    [start, end]: [&State; 2],
) -> Option<Due<E>> {
    let path = |particle| Path::new(particle, h, start, end);
    let own = path(particle);
    let other = match against {
        Against::Particle(other) => Some((other, path(other))),
        Against::Obstacle(_) => None,
    };
    let left = |s: f64| {
        let at = |which: usize| match &other {
            Some((other, path)) if *other == which => path.at(s),
            _ => own.at(s),
        };
        side * obstacles.gap(particle, against, start.t + s * h, at)
    };
    let others = other.as_ref().map_or(0.0, |(_, path)| path.length());
    let reach = obstacles.reach(against, start.t, start.t + h);
    let bound = own.length() + reach + others;
    if left(1.0) > bound {
        return None;
    }
    let ([clear, due], level) = crossing(left, bound, obstacles.close(own.at(0.0)))?;
    Some(Due {
        event,
        clear: clear * h,
        due: due * h,
        level,
    })
}

/// Where a gap first becomes negative, as parts of a step, before and after; and the level it falls below. `bound` is the
/// most that it changes over the whole step. A gap that starts within `close` of 0, after a bounce, and never rises above
/// that has to fall clearly below 0.
fn crossing(gap: impl Fn(f64) -> f64, bound: f64, close: f64) -> Option<([f64; 2], f64)> {
    const SHORT: f64 = 1e-6;
    let (mut clear, mut s, mut short) = (0.0, 0.0, SHORT);
    let mut level = -2.0 * close;
    loop {
        let now = gap(s);
        if now > close {
            level = 0.0;
        }
        if now < level {
            return Some(([clear, s], level));
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
            s += safe;
            short = SHORT;
        } else {
            s += short;
            short *= 1.5;
        }
        s = s.min(1.0);
    }
}
