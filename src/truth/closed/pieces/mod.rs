//! A particle by itself among planes: free motion, sliding and rest, joined at impacts, landings and turns.
//!
//! On every piece x'' = r - 2 g x' - w² (x - x0), the same along all axes. So a velocity along a fixed direction changes its
//! sign once in half a swing at most, and a gap is monotone in between: no event is missed. The laws are written here
//! once more, so that a fault of the contact code would show.

mod spread;
mod walls;

use super::group::Group;
use super::mode::{Mode, Start};
use super::part::GroupMotion;
use super::vector::{across, norm, unit};
use nalgebra::Vector3;
use spread::Spread;
pub(super) use walls::{Wall, walls};

/// More pieces than this are left to the converged reference.
const MOST: usize = 4_000;
/// A path that passes a plane at less than this part of the scene's size may touch it or not, for all that rounding says.
const GRAZING: f64 = 1e-12;
/// Numbers within this part of each other are the same.
const SAME: f64 = 64.0 * f64::EPSILON;

/// The motion of one particle.
#[derive(Debug)]
pub(super) struct Pieces {
    /// Index in the scene.
    particle: usize,
    pieces: Vec<Piece>,
    pub method: String,
    pub reason: String,
}

/// Motion from `from` on, s.
#[derive(Debug, Clone, Copy)]
struct Piece {
    from: f64,
    mode: Mode,
    /// At its start.
    x: Vector3<f64>,
    v: Vector3<f64>,
    /// r, m/s².
    pull: Vector3<f64>,
    /// Bound on the distance of any position up to its end from the true one, m.
    bar: f64,
}

/// What ends a piece, and how often it has.
#[derive(Debug, Clone, Copy, Default)]
struct Joints {
    impacts: usize,
    landings: usize,
    turns: usize,
}

/// Where a particle is, and how far from each plane: 0 where it touches.
#[derive(Debug, Clone)]
struct Now {
    t: f64,
    x: Vector3<f64>,
    v: Vector3<f64>,
    gaps: Vec<f64>,
    /// The largest speed there was, m/s: velocities within its rounding of each other are one.
    fastest: f64,
}

/// How a particle goes on.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Phase {
    Free,
    /// On a plane, with friction against this direction, where there is any.
    Sliding(usize, Option<Vector3<f64>>),
    /// With a plane.
    Stuck(usize),
}

impl Pieces {
    /// None unless the group is one particle, on springs to fixed ends or on none, whose pieces have closed forms.
    pub fn of(group: &Group, walls: &[Wall]) -> Option<Self> {
        let ([body], []) = (&group.bodies[..], &group.rods[..]) else {
            return None;
        };
        let plain = body.quadratic == 0.0 && body.turning == Vector3::zeros();
        if !plain || group.is_driven() {
            return None;
        }
        let lone = Lone::new(group, walls)?;
        let mut now = lone.start()?;
        let mut spread = Spread::new(lone.spread());
        let (mut pieces, mut joints) = (Vec::new(), Joints::default());
        let (mut phase, mut piece) = lone.piece(&mut now)?;
        loop {
            if pieces.len() == MOST {
                return None;
            }
            let left = group.until - now.t;
            let end = lone.end(phase, &piece, &now, left)?;
            let lasts = end.map_or(left, |end| end.0);
            lone.holds(&piece, lasts).then_some(())?;
            let (x, v) = piece.after(lasts);
            spread.fly(&piece, lasts);
            if let Phase::Sliding(at, _) = phase {
                spread.press(walls[at].normal);
            }
            piece.bar = spread.bar();
            pieces.push(piece);
            let Some((_, wall)) = end else { break };
            let moved = piece.moved(lasts);
            let mut gaps = now.gaps.clone();
            for (gap, wall) in gaps.iter_mut().zip(walls) {
                *gap += wall.normal.dot(&(moved - wall.velocity * lasts));
            }
            let from = std::mem::replace(&mut now.gaps, gaps);
            (now.t, now.x) = (now.t + lasts, x);
            now.fastest = now.fastest.max(norm(v));
            let before = piece.acceleration(lasts);
            match (phase, wall) {
                (Phase::Free, Some(at)) => {
                    now.gaps[at] = 0.0;
                    let wall = &walls[at];
                    now.v = wall.struck(v);
                    let (then, next) = lone.piece(&mut now)?;
                    let stays = then != Phase::Free;
                    joints.impacts += 1;
                    joints.landings += usize::from(stays);
                    spread.strike(wall, from[at], [v, now.v], [before, next.acceleration(0.0)]);
                    if stays {
                        spread.press(wall.normal);
                    }
                    spread.stop(then);
                    (phase, piece) = (then, next);
                }
                (Phase::Sliding(at, Some(along)), None) => {
                    now.gaps[at] = 0.0;
                    now.v = v - along * along.dot(&(v - walls[at].velocity));
                    joints.turns += 1;
                    let (then, next) = lone.piece(&mut now)?;
                    spread.turn(along, [before, next.acceleration(0.0)]);
                    spread.stop(then);
                    (phase, piece) = (then, next);
                }
                _ => return None,
            }
        }
        Some(Self {
            particle: body.id,
            pieces,
            method: format!("{} in pieces", lone.word()),
            reason: joints.told(),
        })
    }

    /// Overwrites the particle's position and velocity with those at `t`.
    pub fn put(&self, t: f64, x: &mut [f64], v: &mut [f64]) {
        let piece = self.at(t);
        let (position, velocity) = piece.after(t - piece.from);
        let own = 3 * self.particle..3 * self.particle + 3;
        x[own.clone()].copy_from_slice(position.as_slice());
        v[own].copy_from_slice(velocity.as_slice());
    }

    /// Bound on the distance of any computed position in [0, t] from the exact one, m: see [`Spread`].
    pub fn error_bar(&self, t: f64) -> f64 {
        self.at(t).bar
    }

    fn at(&self, t: f64) -> &Piece {
        let begun = self.pieces.partition_point(|piece| piece.from <= t);
        &self.pieces[begun.saturating_sub(1)]
    }
}

impl Joints {
    fn told(self) -> String {
        let word = |n: usize, word: &str| match n {
            0 => None,
            1 => Some(format!("1 {word}")),
            n => Some(format!("{n} {word}s")),
        };
        let joints = [
            word(self.impacts, "impact"),
            word(self.landings, "landing"),
            word(self.turns, "turn"),
        ];
        let joints: Vec<_> = joints.into_iter().flatten().collect();
        let (last, before) = match &joints[..] {
            [] => return "one particle among planes, which it does not meet anew".to_owned(),
            [before @ .., last] => (last, before.join(", ")),
        };
        let all = match before.is_empty() {
            true => last.clone(),
            false => format!("{before} and {last}"),
        };
        format!("one particle among planes: closed forms joined at {all}")
    }
}

impl Piece {
    /// Position and velocity after `t` seconds of it.
    fn after(&self, t: f64) -> (Vector3<f64>, Vector3<f64>) {
        let response = self.mode.response(t);
        let along = |axis: usize| {
            let start = Start {
                velocity: self.v[axis],
                pull: self.pull[axis],
            };
            [response.position(start), response.gained(start)]
        };
        let gained = [0, 1, 2].map(along);
        let vector = |of: usize| Vector3::from(gained.map(|axis| axis[of]));
        (self.x + vector(0), self.v + vector(1))
    }

    /// The way gone after `t` seconds, without the rounding of a place, m.
    fn moved(&self, t: f64) -> Vector3<f64> {
        let from_zero = Self {
            x: Vector3::zeros(),
            ..*self
        };
        from_zero.after(t).0
    }

    /// After `t` seconds of it, m/s².
    fn acceleration(&self, t: f64) -> Vector3<f64> {
        let Mode { w, g } = self.mode;
        self.pull - 2.0 * g * self.after(t).1 - w * w * self.moved(t)
    }
}

/// One particle, what pulls at it, and the planes around it.
struct Lone<'a> {
    group: &'a Group<'a>,
    walls: &'a [Wall],
    mode: Mode,
}

impl<'a> Lone<'a> {
    fn new(group: &'a Group<'a>, walls: &'a [Wall]) -> Option<Self> {
        let body = &group.bodies[0];
        let sum = |of: fn(&super::group::Link) -> f64| group.links.iter().map(of).sum::<f64>();
        let mode = Mode {
            w: (sum(|link| link.spring.stiffness) / body.mass).sqrt(),
            g: 0.5 * (body.drag + sum(|link| link.spring.damping)) / body.mass,
        };
        // What moves past a particle on a spring has no closed form here.
        let moved = walls.iter().any(|wall| wall.velocity != Vector3::zeros());
        (mode.w == 0.0 || !moved).then_some(Self { group, walls, mode })
    }

    fn word(&self) -> &'static str {
        match self.mode {
            Mode { w, .. } if w > 0.0 => "oscillator",
            Mode { g, .. } if g > 0.0 => "fall with linear drag",
            _ => "parabola",
        }
    }

    /// Rounding of a place, m.
    fn spread(&self) -> f64 {
        f64::EPSILON * self.group.size.max(norm(self.group.bodies[0].position))
    }

    fn start(&self) -> Option<Now> {
        let body = &self.group.bodies[0];
        let gap = |wall: &Wall| {
            let (gap, from) = wall.gap(body.radius, body.position);
            let touches = gap.abs() <= SAME * from;
            (touches || gap > 0.0).then_some(if touches { 0.0 } else { gap })
        };
        Some(Now {
            t: 0.0,
            x: body.position,
            v: body.velocity,
            gaps: self.walls.iter().map(gap).collect::<Option<_>>()?,
            fastest: self
                .walls
                .iter()
                .map(|wall| norm(wall.velocity))
                .fold(norm(body.velocity), f64::max),
        })
    }

    /// r where a particle is, m/s².
    fn pull(&self, x: Vector3<f64>) -> Vector3<f64> {
        let body = &self.group.bodies[0];
        let springs = self.group.links.iter().map(|link| {
            let anchor = link.at[usize::from(link.ends[0].is_some())] - x;
            let spring = link.spring;
            let rest = match unit(anchor) {
                Some(along) if spring.rest_length > 0.0 => along * spring.rest_length,
                _ => Vector3::zeros(),
            };
            (anchor - rest) * (spring.stiffness / body.mass)
        });
        springs.sum::<Vector3<f64>>() + body.constant
    }

    /// How the particle goes on, and on which piece; an impact that is due at once is taken. None where this is undecidable.
    fn piece(&self, now: &mut Now) -> Option<(Phase, Piece)> {
        let rounding = SAME * now.fastest;
        let touched = || (0..self.walls.len()).filter(|&at| now.gaps[at] == 0.0);
        let close: Vec<usize> = touched()
            .filter(|&at| self.walls[at].parting(now.v) <= rounding)
            .collect();
        let free = self.free(now);
        match close[..] {
            [] => Some((Phase::Free, free)),
            [at] => {
                let wall = &self.walls[at];
                if wall.parting(now.v) < -rounding {
                    now.v = wall.struck(now.v);
                    return self.piece(now);
                }
                self.pressed(now, at, free)
            }
            _ => None,
        }
    }

    fn free(&self, now: &Now) -> Piece {
        Piece {
            from: now.t,
            mode: self.mode,
            x: now.x,
            v: now.v,
            pull: self.pull(now.x),
            bar: 0.0,
        }
    }

    /// How a particle goes on that is on a plane and does not part from it by its velocity.
    fn pressed(&self, now: &mut Now, at: usize, free: Piece) -> Option<(Phase, Piece)> {
        let wall = &self.walls[at];
        let n = wall.normal;
        now.v -= n * wall.parting(now.v);
        let mut relative = now.v - wall.velocity;
        relative -= n * n.dot(&relative);
        if norm(relative) <= SAME * now.fastest {
            relative = Vector3::zeros();
            now.v = wall.velocity;
        }
        let free = Piece { v: now.v, ..free };
        let acceleration = free.acceleration(0.0);
        let normal = n.dot(&acceleration);
        if normal == 0.0 || normal > SAME * norm(acceleration) {
            return Some((Phase::Free, free));
        }
        if normal > -SAME * norm(acceleration) {
            return None;
        }
        let along = acceleration - n * normal;
        let [sliding, sticking] = wall.friction.map(|friction| -friction * normal);
        let (driven, rests) = (norm(along), relative == Vector3::zeros());
        if rests && driven <= (1.0 - 1e-12) * sticking {
            return Some((Phase::Stuck(at), self.stuck(now, wall)));
        }
        if rests && sticking > 0.0 && driven <= (1.0 + 1e-12) * sticking {
            return None;
        }
        let held = Piece {
            pull: free.pull - n * normal,
            ..free
        };
        if sliding == 0.0 {
            return Some((Phase::Sliding(at, None), held));
        }
        let direction = unit(if rests { along } else { relative })?;
        // Friction keeps its direction where all motion is along it.
        if across(along, direction) > SAME * (driven + sliding) {
            return None;
        }
        let rubbed = Piece {
            pull: held.pull - direction * sliding,
            ..held
        };
        Some((Phase::Sliding(at, Some(direction)), rubbed))
    }

    fn stuck(&self, now: &Now, wall: &Wall) -> Piece {
        Piece {
            from: now.t,
            mode: Mode::default(),
            x: now.x,
            v: wall.velocity,
            pull: Vector3::zeros(),
            bar: 0.0,
        }
    }

    /// When a piece of at most `left` seconds ends: at this plane, or by a turn. The outer None: undecidable.
    #[allow(clippy::option_option, reason = "whether it ends, where that is known")]
    fn end(
        &self,
        phase: Phase,
        piece: &Piece,
        now: &Now,
        left: f64,
    ) -> Option<Option<(f64, Option<usize>)>> {
        if matches!(phase, Phase::Stuck(_)) && self.walls.len() == 1 {
            return Some(None);
        }
        let part = 0.5 * half_swing(piece.mode).min(2.0 * left);
        if left > part * MOST as f64 {
            return None;
        }
        let mut end = None;
        let earlier = |end: &Option<(f64, Option<usize>)>, t: f64| end.is_none_or(|end| t < end.0);
        if let Phase::Sliding(at, Some(along)) = phase {
            let speed = |t: f64| along.dot(&(piece.after(t).1 - self.walls[at].velocity));
            end = turns(speed, part, left).first().map(|&t| (t, None));
        }
        for (at, wall) in self.walls.iter().enumerate() {
            if let Phase::Sliding(on, _) | Phase::Stuck(on) = phase
                && on == at
            {
                continue;
            }
            let gap = |t: f64| {
                let moved = piece.moved(t) - wall.velocity * t;
                now.gaps[at] + wall.normal.dot(&moved)
            };
            let until = end.map_or(left, |end| end.0);
            if let Some(closes) =
                self.closes(gap, |t| wall.parting(piece.after(t).1), part, until)?
                && earlier(&end, closes)
            {
                end = Some((closes, Some(at)));
            }
        }
        if let Some((t, Some(at))) = end {
            // Two at a time have no order.
            let (moved, size) = (piece.moved(t), self.group.size);
            let others = self.walls.iter().zip(&now.gaps).enumerate();
            let mut others = others.filter(|(other, _)| *other != at);
            let close = |(wall, gap): (&Wall, &f64)| {
                gap + wall.normal.dot(&(moved - wall.velocity * t)) <= GRAZING * size
            };
            if others.any(|(_, other)| close(other)) {
                return None;
            }
        }
        Some(end)
    }

    /// When a gap closes within `until` seconds, if it does. The outer None: it is only grazed.
    #[allow(
        clippy::option_option,
        reason = "whether it closes, where that is known"
    )]
    fn closes(
        &self,
        gap: impl Fn(f64) -> f64,
        parting: impl Fn(f64) -> f64,
        part: f64,
        until: f64,
    ) -> Option<Option<f64>> {
        let mut from = 0.0;
        for turn in turns(&parting, part, until).into_iter().chain([until]) {
            let left = gap(turn);
            let least = turn < until && parting(0.5 * (from + turn)) < 0.0;
            if least && left.abs() <= GRAZING * self.group.size {
                return None;
            }
            if left < 0.0 {
                return Some(Some(bisect(gap, [from, turn])));
            }
            from = turn;
        }
        Some(None)
    }

    /// Whether the forces stay linear on a piece of so many seconds: springs with a rest length do not pass their ends.
    fn holds(&self, piece: &Piece, lasts: f64) -> bool {
        if self.group.is_linear() || piece.mode.w == 0.0 {
            return true;
        }
        let mut group = self.group.clone();
        group.until = lasts;
        let own = self.pull(piece.x) - piece.pull;
        let body = &mut group.bodies[0];
        (body.position, body.velocity) = (piece.x, piece.v);
        body.constant -= own;
        for link in &mut group.links {
            let moving = usize::from(link.ends[1].is_some());
            link.at[moving] = piece.x;
        }
        GroupMotion::of(&group).is_some()
    }
}

/// Half of the time of a swing, s; infinite where a mode does not swing.
fn half_swing(mode: Mode) -> f64 {
    let turn = (mode.w - mode.g) * (mode.w + mode.g);
    if turn > 0.0 {
        std::f64::consts::PI / turn.sqrt()
    } else {
        f64::INFINITY
    }
}

/// Where a function changes its sign in (0, until], which it does at most once in each `part`; not where it starts at 0.
fn turns(of: impl Fn(f64) -> f64, part: f64, until: f64) -> Vec<f64> {
    let mut found = Vec::new();
    let (mut from, mut was) = (0.0, of(0.0));
    for k in 1.. {
        let to = (f64::from(k) * part).min(until);
        let is = of(to);
        if was == 0.0 {
            was = is;
        } else if is != 0.0 && (is < 0.0) != (was < 0.0) {
            found.push(bisect(|t| of(t) * was.signum(), [from, to]));
            was = is;
        }
        if to >= until {
            return found;
        }
        from = to;
    }
    found
}

/// Where a function falls below 0, to the last bit.
fn bisect(of: impl Fn(f64) -> f64, [mut above, mut below]: [f64; 2]) -> f64 {
    loop {
        let middle = 0.5 * (above + below);
        if middle <= above || middle >= below {
            return above;
        }
        if of(middle) < 0.0 {
            below = middle;
        } else {
            above = middle;
        }
    }
}
