//! The path of a particle within a step, and where on it a gap closes.

use crate::physics::State;

/// The cubic through both ends of a particle's path, over the part s of a step.
pub(super) struct Path {
    h: f64,
    x: [[f64; 3]; 2],
    v: [[f64; 3]; 2],
}

impl Path {
    pub fn new(particle: usize, h: f64, start: &State, end: &State) -> Self {
        let three = |all: &[f64]| [0, 1, 2].map(|axis| all[3 * particle + axis]);
        Self {
            h,
            x: [three(&start.x), three(&end.x)],
            v: [three(&start.v), three(&end.v)],
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

    /// A ball that it keeps within: its centre, and its radius, m.
    pub fn ball(&self) -> ([f64; 3], f64) {
        let center = [0, 1, 2].map(|c| 0.5 * (self.x[0][c] + self.x[1][c]));
        (center, 0.5 * self.length())
    }

    /// It is not longer, m.
    pub fn length(&self) -> f64 {
        let norm = |v: [f64; 3]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
        let way = [0, 1, 2].map(|c| self.x[1][c] - self.x[0][c]);
        let off = |v: [f64; 3]| norm([0, 1, 2].map(|c| self.h * v[c] - way[c]));
        norm(way) + off(self.v[0]) + off(self.v[1])
    }
}

/// Where a gap first becomes negative, as parts of a step, before and after; and the level it falls below. `bound` is the
/// most that it changes over the whole step. A gap that starts within `close` of 0, after a bounce, and never rises above
/// that has to fall clearly below 0.
pub(super) fn crossing(
    gap: impl Fn(f64) -> f64,
    bound: f64,
    close: f64,
) -> Option<([f64; 2], f64)> {
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
