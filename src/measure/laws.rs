//! How far a run is off the laws of contact, from its rows alone: our methods, rapier and other programs alike.
//!
//! Between two rows an impact is where the free motion from the first, x + v t + a t²/2, meets the surface. The velocities
//! before and after it are those of the rows, each taken there by its own acceleration. With forces that are constant this is
//! exact; what else forces may do within the two rows, |a| h, and rounding are the bound.

use crate::integrators::events::LOCATED;
use crate::joined::least_joined;
use crate::physics::constraints::contact::{Against, Beside, Obstacles};
use crate::physics::{ParticleSystem, State, System};
use crate::space::{dot, minus, norm, three};
use crate::trajectory::{Rows, Trajectory};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, VecDeque};
use std::rc::Rc;

/// How far a law of contact is missed. Of all that could be judged it is the case that is most beyond its bound.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Residual {
    /// The distance from the law, in the unit of the law: of the speed of approach, of the normal impulse or force, or J.
    pub off: f64,
    /// How much of it the forces within the rows may explain, and rounding.
    pub bound: f64,
    /// What the run has: the ratio of speeds or of forces, or J.
    pub found: f64,
    /// What the law asks for: e, µ, or 0 J; where it slides exactly that much friction, where it rests what holds it, elsewhere
    /// at most.
    pub asked: f64,
    /// How many impacts, or pairs of rows in contact, were judged.
    pub judged: u64,
    /// The particle that has it.
    pub particle: usize,
    /// When, s: the first of its two rows.
    pub t_s: f64,
}

impl Residual {
    /// Whether it is more than forces and rounding explain.
    pub fn broken(&self) -> bool {
        self.off > self.bound
    }

    fn beyond(&self) -> f64 {
        (self.off - self.bound).max(0.0)
    }
}

/// The laws of contact over the recorded rows. Not judged, and null where nothing else happened: an impact whose speed the
/// forces change by more than a quarter within its rows; one that takes several rows, as a program's penalty; what touches
/// more than one thing within two rows, triangles of a mesh counted one by one, or is joined by a spring or by rods to what
/// touches something; without velocities. With a penalty or a strain limit nothing is judged, and with rods no friction.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Laws {
    /// Newton's: |v_n' + e v_n| / |v_n| of impacts.
    pub separation: Option<Residual>,
    /// Coulomb's cone at impacts: how far friction is above µ times the normal impulse, in parts of that.
    pub impact_friction: Option<Residual>,
    /// Coulomb's law of what stays on a surface: the distance of friction from µ N against the sliding, or how far it is
    /// above the static µ N where it sticks, in parts of N.
    pub sliding_friction: Option<Residual>,
    /// The largest energy, J, that one impact or a row of sliding puts in, as the surface sees it: none should.
    pub energy_gain: Option<Residual>,
}

/// The laws that residuals are of, and what they are about, for `explain`: ids, and what each says.
pub static CONTACT_LAWS: &[(&str, &str)] = &[
    (
        "contact",
        "what touches pushes and does not pull: N ≥ 0, gap ≥ 0, one of them 0 (Signorini); impacts are impulses (`separation`, \
         `impact_friction`), what stays rubs (`sliding_friction`)",
    ),
    (
        "impulse",
        "an impact changes velocities at its instant, within the step, and positions not at all: as here, and as none of the \
         treatments of contact does",
    ),
    (
        "friction",
        "Coulomb's law: of an impact `impact_friction`, of what stays in contact `sliding_friction`",
    ),
    (
        "separation",
        "v_n' = -e v_n, relative to what is met (Newton); off by |v_n' + e v_n| / |v_n|",
    ),
    (
        "impact_friction",
        "an impact takes min(µ (1 + e) |v_n|, |v_t|) off the sliding velocity, in its direction (Coulomb, for the impulses); off \
         by what |Δv_t| is above µ |Δv_n|, in parts of |Δv_n|",
    ),
    (
        "sliding_friction",
        "what slides is held back by µ N, what sticks by what it takes, up to µ_s N (Coulomb); off by the distance from that, in \
         parts of N",
    ),
    (
        "energy_gain",
        "neither an impact nor friction puts energy in, as the surface sees it; off by the J that one impact, or a row of \
         sliding, puts in",
    ),
];

/// Two rows are judged where forces change the speed of an impact by no more than this part of it.
const UNDISTURBED: f64 = 0.25;
/// Of a normal force this part may be in doubt.
const DOUBT: f64 = 0.1;
/// What rests begins to slide if it gains more than this part of what forces give in a row.
const CREEP: f64 = 1e-3;
/// Roundings of a number that it may be off.
const ROUNDINGS: f64 = 16.0;
/// Places at which the way to an impact is looked at.
const LOOKS: u32 = 32;

impl Laws {
    /// Of a run.
    pub fn of(system: &ParticleSystem, run: &Trajectory) -> Self {
        let mut laws = Self::default();
        let rows = run.rows();
        let (Some(obstacles), Some(v)) = (system.obstacles(), &rows.v) else {
            return laws;
        };
        let steps = rows.steps.windows(2).map(|pair| pair[1] - pair[0]);
        let (Some(pitch), None, None) = (steps.min(), system.strain_limiter(), obstacles.penalty())
        else {
            return laws;
        };
        let obstacles = obstacles.copied();
        let mut seen = Seen {
            system,
            rows,
            pitch,
            rigid: {
                let ends = system.rods().map_or(&[][..], |rods| rods.ends());
                least_joined(system.dim() / 3, ends.iter().copied())
            },
            last: VecDeque::new(),
            mixed: None,
        };
        let finite = |all: &[f64]| all.iter().all(|c| c.is_finite());
        for k in 0..rows.len() - 1 {
            let two = k * rows.dim..(k + 2) * rows.dim;
            let known = finite(&rows.x[two.clone()]) && finite(&v[two]);
            if known && rows.steps[k + 1] - rows.steps[k] == pitch {
                laws.between(&obstacles, &mut seen, k);
            }
        }
        laws
    }

    /// All that is near between row k and the next.
    fn between(&mut self, obstacles: &Obstacles, seen: &mut Seen, k: usize) {
        let (rows, times) = (seen.rows, seen.times(k));
        let [v0, v1] = [k, k + 1].map(|row| rows.v(row).unwrap_or(&[]));
        let reach = |particle: usize| {
            let speed = |v: &[f64]| norm(three(v, particle));
            (times[1] - times[0]) * speed(v0).max(speed(v1))
        };
        let at = |particle: usize| three(rows.x(k), particle);
        let closed = obstacles.closed();
        let near = obstacles.near(times, |particle| (at(particle), closed + reach(particle)));
        let mut near: Vec<_> = near.pairs().collect();
        near.retain(|(particle, against)| {
            let way = match against {
                Against::Obstacle(_) => obstacles.reach(*against, times[0], times[1]),
                Against::Particle(other) => reach(*other),
            };
            let gap = obstacles.gap(*particle, *against, times[0], at);
            gap <= closed + way + reach(*particle)
        });
        let mut of: BTreeMap<usize, Vec<Against>> = BTreeMap::new();
        for (particle, against) in &near {
            of.entry(*particle).or_default().push(*against);
            if let Against::Particle(other) = *against {
                let back = Against::Particle(*particle);
                of.entry(other).or_default().push(back);
            }
        }
        for (particle, against) in near {
            // Triangles of one mesh are one surface.
            let alone = against.with(particle).into_iter().all(|one| {
                let all = &of[&one];
                let same = |other: &Against| {
                    let collider = obstacles.collider(*other);
                    collider.is_some() && collider == obstacles.collider(against)
                };
                // What springs join feels the impacts of the other, and all that rods join those of each.
                let with = against.with(particle);
                let joined = |two: &usize| {
                    let rigid = seen.rigid[*two] == seen.rigid[one] && !with.contains(two);
                    rigid || obstacles.joined_to(one).contains(two)
                };
                let undisturbed = !of.keys().any(joined);
                undisturbed && (all.len() == 1 || all.iter().all(same))
            });
            if alone {
                let pair = Pair::new(obstacles, seen, k, particle, against);
                let others = of[&particle].iter().filter(|other| **other != against);
                let others: Vec<Against> = others.copied().collect();
                if !self.impact(&pair, &others, seen) && others.is_empty() {
                    self.stay(&pair, seen);
                }
            }
        }
    }

    /// Judges an impact between the two rows; false where there is none, or it cannot be told.
    fn impact(&mut self, pair: &Pair, others: &[Against], seen: &mut Seen) -> bool {
        let (obstacles, h, a) = (pair.obstacles, pair.h, pair.pushes);
        let [first, second] = &pair.beside;
        let surface = obstacles.surface(pair.against);
        let e = surface.restitution;
        if second.parting() - first.parting() <= a * h {
            return false;
        }
        let Some(theta) = pair.meets() else {
            return false;
        };
        let stays = second.gap <= pair.closed() && second.parting().abs() <= pair.off_v;
        let [before, after] = pair.velocities(theta, stays);
        let (speed, parts) = (-before.parting(), after.parting());
        let disturbed = (1.0 + e) * a * h;
        let free = e == 0.0 || e * speed > a * h;
        // Inside a surface only motion that is free beside the two rows tells an impulse from a penalty.
        let inside = |beside: &Beside| beside.gap < -pair.closed();
        let k = pair.k;
        let told = (!inside(first) || k > 0 && pair.free(seen, k - 1))
            && (!inside(second) || pair.free(seen, k + 1));
        let turns = speed > 0.0 && parts >= -(a * h + pair.off_v);
        let clear = disturbed <= UNDISTURBED * speed;
        if !turns || !clear || !free || !told || !pair.is_alone(others, theta) {
            return false;
        }
        let normal = parts + speed;
        // The normal of a round surface turns on the way to where the impact is found.
        let late = LOCATED * h + first.close / speed;
        let turned = before.bend.curvature() * norm(before.velocity).powi(2) * late;
        let doubt = a * h + pair.off_v + turned;
        self.note(
            |laws| &mut laws.separation,
            pair,
            [
                (parts - e * speed).abs() / speed,
                (1.0 + e) * doubt / speed,
                parts / speed,
                e,
            ],
        );
        let [old, new] = [before.sliding(), after.sliding()];
        let across = norm(minus(new, old));
        let mu = surface.friction[0];
        if seen.system.rods().is_none() {
            self.note(
                |laws| &mut laws.impact_friction,
                pair,
                [
                    (across - mu * normal).max(0.0) / normal,
                    (1.0 + mu) * doubt / normal,
                    across / normal,
                    mu,
                ],
            );
        }
        let kinetic = |v: f64| 0.5 * pair.mass * v * v;
        let along = kinetic(parts) - kinetic(speed);
        // Rods turn what an impact takes along the normal into motion across it.
        let across = match seen.system.rods() {
            Some(_) => 0.0,
            None => kinetic(norm(new)) - kinetic(norm(old)),
        };
        let gained = along.max(across).max(0.0);
        let fast = speed + parts + norm(old) + norm(new);
        self.note(
            |laws| &mut laws.energy_gain,
            pair,
            [gained, pair.mass * fast * doubt, gained, 0.0],
        );
        true
    }

    /// Judges the friction of what is on a surface in both rows.
    fn stay(&mut self, pair: &Pair, seen: &mut Seen) {
        let (obstacles, h) = (pair.obstacles, pair.h);
        let slow = pair.pushes * h + pair.off_v;
        let on = |beside: &Beside| beside.gap <= pair.closed() && beside.parting().abs() <= slow;
        if !pair.beside.iter().all(on) || seen.system.rods().is_some() {
            return;
        }
        let [first, second] = &pair.beside;
        let [now, next] = &pair.rows;
        let of = |all: &[f64]| three(all, pair.particle);
        let [a0, a1] = [of(&now.a), of(&next.a)];
        let change = minus(of(&next.state.v), of(&now.state.v));
        let force = [0, 1, 2].map(|c| change[c] / h - 0.5 * (a0[c] + a1[c]));
        let n = first.normal;
        let pressed = dot(force, n);
        let rubs = [0, 1, 2].map(|c| force[c] - pressed * n[c]);
        let mixed = of(&pair.mixed);
        let middle = of(&seen.middle(pair.k));
        // The rule of the trapezoid beside the middle: a force that turns between the rows is the same at both.
        let bent = norm([0, 1, 2].map(|c| middle[c] - 0.5 * (a0[c] + a1[c])));
        let bend = norm(minus(second.normal, n));
        let speed = norm(of(&now.state.v));
        // On a surface that bends by this, methods may keep to the plane that touches it at the first row.
        let doubt = norm(minus(mixed, a0))
            + norm(minus(a1, mixed))
            + 2.0 * bent
            + pair.off_v / h
            // Times have rounding too.
            + norm(force) * f64::EPSILON * next.state.t / h
            + (norm(force) + speed / h * bend) * bend;
        if pressed <= 0.0 || doubt > DOUBT * pressed {
            return;
        }
        let [mu, most] = obstacles.surface(pair.against).friction;
        let [old, new] = [first.sliding(), second.sliding()];
        let both = [0, 1, 2].map(|c| old[c] + new[c]);
        let fast = norm(both);
        let stops = (pair.pushes + mu * pressed) * h + pair.off_v;
        let slides = norm(old) > stops && norm(new) > stops && dot(old, new) > 0.0;
        let along = |a: [f64; 3]| {
            let a = pair.relative(now.state.t, a);
            let out = dot(a, n);
            [0, 1, 2].map(|c| a[c] - out * n[c])
        };
        // What rests, and may be held by friction, stays; a creep is not to begin to slide.
        let load = along(a0);
        let begins = norm(old) <= pair.off_v && norm(new) > CREEP * pair.pushes * h;
        let held = begins && norm(load) + doubt <= most * pressed;
        let (off, turned, asked) = if held {
            let left = [0, 1, 2].map(|c| rubs[c] + load[c]);
            (norm(left), 0.0, norm(load) / pressed)
        } else if slides {
            let against = both.map(|c| mu * pressed * c / fast);
            let left = [0, 1, 2].map(|c| rubs[c] + against[c]);
            let turned = minus(new.map(|c| c / norm(new)), old.map(|c| c / norm(old)));
            (norm(left), mu * norm(turned), mu)
        } else {
            ((norm(rubs) - most * pressed).max(0.0), 0.0, most)
        };
        self.note(
            |laws| &mut laws.sliding_friction,
            pair,
            [
                off / pressed,
                (1.0 + most) * doubt / pressed + turned,
                norm(rubs) / pressed,
                asked,
            ],
        );
        if slides {
            let mass = 1.0 / obstacles.weight(pair.particle);
            let gained = (0.5 * mass * h * dot(rubs, both)).max(0.0);
            let bound = mass * h * fast * doubt;
            self.note(
                |laws| &mut laws.energy_gain,
                pair,
                [gained, bound, gained, 0.0],
            );
        }
    }

    fn note(
        &mut self,
        law: fn(&mut Self) -> &mut Option<Residual>,
        pair: &Pair,
        [off, bound, found, asked]: [f64; 4],
    ) {
        let place = law(self);
        let judged = place.map_or(0, |one| one.judged) + 1;
        let new = Residual {
            off,
            bound,
            found,
            asked,
            judged,
            particle: pair.particle,
            t_s: pair.rows[0].state.t,
        };
        let rank = |one: &Residual| (one.beyond(), one.off);
        match place {
            Some(old) if rank(old) >= rank(&new) => old.judged = judged,
            _ if off.is_finite() && bound.is_finite() => *place = Some(new),
            _ => (),
        }
    }
}

/// A row, and the acceleration without contact there, m/s².
struct Row {
    k: usize,
    state: State,
    a: Vec<f64>,
}

/// The rows, and the last few that were looked at.
struct Seen<'a> {
    system: &'a ParticleSystem,
    rows: &'a Rows,
    /// Steps between rows that follow each other.
    pitch: u64,
    /// Of each particle, the least that rods join to it, over any number of them: it feels the impacts of all these.
    rigid: Vec<usize>,
    last: VecDeque<Rc<Row>>,
    /// See [`Pair::mixed`], of the last row.
    mixed: Option<(usize, Rc<Vec<f64>>)>,
}

impl Seen<'_> {
    fn times(&self, k: usize) -> [f64; 2] {
        [k, k + 1].map(|row| self.rows.time(row))
    }

    fn mixed(&mut self, k: usize) -> Rc<Vec<f64>> {
        if let Some((_, a)) = self.mixed.as_ref().filter(|(last, _)| *last == k) {
            return Rc::clone(a);
        }
        let [now, next] = [k, k + 1].map(|row| self.row(row));
        let mut a = vec![0.0; next.a.len()];
        let (x, v) = (&next.state.x, &now.state.v);
        self.system.acceleration(next.state.t, x, v, &mut a);
        let a = Rc::new(a);
        self.mixed = Some((k, Rc::clone(&a)));
        a
    }

    /// The acceleration in the middle between row k and the next, m/s².
    fn middle(&mut self, k: usize) -> Vec<f64> {
        let [now, next] = [k, k + 1].map(|row| self.row(row));
        let (start, end) = (&now.state, &next.state);
        let middle = start.middle(end, end.t - start.t);
        let mut a = vec![0.0; middle.x.len()];
        self.system
            .acceleration(middle.t, &middle.x, &middle.v, &mut a);
        a
    }

    fn row(&mut self, k: usize) -> Rc<Row> {
        if let Some(row) = self.last.iter().find(|row| row.k == k) {
            return Rc::clone(row);
        }
        let [x, v] = [self.rows.x(k), self.rows.v(k).unwrap_or(&[])].map(<[f64]>::to_vec);
        let state = State {
            t: self.rows.time(k),
            ..State::new(x, v)
        };
        let mut a = vec![0.0; state.x.len()];
        self.system
            .acceleration(state.t, &state.x, &state.v, &mut a);
        let row = Rc::new(Row { k, state, a });
        self.last.push_front(Rc::clone(&row));
        self.last.truncate(4);
        row
    }
}

/// A particle and what it is near, over two rows.
struct Pair<'a> {
    obstacles: &'a Obstacles,
    k: usize,
    particle: usize,
    against: Against,
    rows: [Rc<Row>; 2],
    beside: [Beside; 2],
    /// The acceleration at the positions of the second and the velocities of the first, m/s²: with those of the two rows it
    /// bounds what a method may take.
    mixed: Rc<Vec<f64>>,
    /// Seconds between the rows.
    h: f64,
    /// The largest acceleration relative to the other, m/s².
    pushes: f64,
    /// How far velocities are off by rounding, also of positions and times, and by the digits they are given to, m/s.
    off_v: f64,
    /// The mass that the impact sees, kg.
    mass: f64,
}

impl<'a> Pair<'a> {
    fn new(
        obstacles: &'a Obstacles,
        seen: &mut Seen,
        k: usize,
        particle: usize,
        against: Against,
    ) -> Self {
        let rows = [k, k + 1].map(|row| seen.row(row));
        let [first, second] = &rows;
        let beside = [first, second].map(|row| obstacles.beside(particle, against, &row.state));
        let with = against.with(particle);
        let dim = seen.rows.dim;
        let h = second.state.t - first.state.t;
        let mut off_v: f64 = 0.0;
        for row in &rows {
            for i in with.iter().flat_map(|one| 3 * one..3 * one + 3) {
                let (x, v, a) = (row.state.x[i], row.state.v[i], row.a[i]);
                let sums = ROUNDINGS * (v.abs() + h * a.abs());
                let rounding = f64::EPSILON * (sums + x.abs() / h + row.state.t * a.abs());
                off_v = off_v.max(2.0 * seen.rows.half_unit(dim + i, v) + rounding);
            }
        }
        let mut pair = Self {
            obstacles,
            k,
            particle,
            against,
            beside,
            mixed: seen.mixed(k),
            h,
            pushes: 0.0,
            off_v,
            mass: 1.0 / with.iter().map(|one| obstacles.weight(*one)).sum::<f64>(),
            rows,
        };
        let [first, second] = &pair.rows;
        let (now, later) = (first.state.t, second.state.t);
        let all = [(now, &first.a), (later, &second.a), (later, &*pair.mixed)];
        let pushes = all.map(|(t, a)| norm(pair.pushed(t, a)));
        pair.pushes = pushes.into_iter().fold(0.0, f64::max);
        pair
    }

    /// Gaps within this are closed, m.
    fn closed(&self) -> f64 {
        self.obstacles.closed() + self.beside[0].close
    }

    /// The acceleration relative to the other, m/s².
    fn pushed(&self, t: f64, a: &[f64]) -> [f64; 3] {
        match self.against {
            Against::Particle(other) => minus(three(a, self.particle), three(a, other)),
            Against::Obstacle(_) => self.relative(t, three(a, self.particle)),
        }
    }

    /// An acceleration relative to that of the obstacle, m/s².
    fn relative(&self, t: f64, a: [f64; 3]) -> [f64; 3] {
        minus(a, self.obstacles.moved(self.against, t)[2])
    }

    /// A particle in free motion from the first row.
    fn falls(&self, particle: usize, time: f64) -> [f64; 3] {
        let Row { state, a, .. } = &*self.rows[0];
        let [x, v, a] = [&state.x, &state.v, a].map(|all| three(all, particle));
        [0, 1, 2].map(|c| x[c] + time * (v[c] + 0.5 * time * a[c]))
    }

    /// When free motion from the first row meets the other, s after it, at most the second; None where it passes by.
    fn meets(&self) -> Option<f64> {
        let t = self.rows[0].state.t;
        let gap = |time: f64| {
            let at = |particle| self.falls(particle, time);
            self.obstacles
                .gap(self.particle, self.against, t + time, at)
        };
        if gap(0.0) <= 0.0 {
            return Some(0.0);
        }
        // rapier acts one step ahead.
        let looks = (1..=LOOKS).map(|look| 2.0 * self.h * f64::from(look) / f64::from(LOOKS));
        let (mut free, mut hit) = (0.0, None);
        for time in looks {
            if gap(time) <= 0.0 {
                hit = Some(time);
                break;
            }
            free = time;
        }
        let mut hit = hit?;
        for _ in 0..60 {
            let middle = 0.5 * (free + hit);
            if gap(middle) <= 0.0 {
                hit = middle;
            } else {
                free = middle;
            }
        }
        Some(hit.min(self.h))
    }

    /// The two before and after an impact at a time, s after the first row; `stays` where it is at rest after it.
    fn velocities(&self, theta: f64, stays: bool) -> [Beside; 2] {
        let [now, next] = &self.rows;
        let mut state = State {
            t: now.state.t + theta,
            ..now.state.clone()
        };
        let with = self.against.with(self.particle);
        for particle in &with {
            let at = 3 * particle..3 * particle + 3;
            state.x[at].copy_from_slice(&self.falls(*particle, theta));
        }
        let left = if stays { 0.0 } else { theta - self.h };
        [(now, theta), (next, left)].map(|(row, time)| {
            for at in with.iter().flat_map(|one| 3 * one..3 * one + 3) {
                state.v[at] = row.state.v[at] + time * row.a[at];
            }
            self.obstacles.beside(self.particle, self.against, &state)
        })
    }

    /// A particle in free motion to the second row, s after the first.
    fn came(&self, particle: usize, time: f64) -> [f64; 3] {
        let Row { state, a, .. } = &*self.rows[1];
        let [x, v, a] = [&state.x, &state.v, a].map(|all| three(all, particle));
        let since = time - self.h;
        [0, 1, 2].map(|c| x[c] + since * (v[c] + 0.5 * since * a[c]))
    }

    /// Whether it touches none of these on its way to the impact and on.
    fn is_alone(&self, others: &[Against], theta: f64) -> bool {
        let speed = |row: &Row| norm(three(&row.state.v, self.particle));
        let fastest = speed(&self.rows[0]).max(speed(&self.rows[1])) + self.pushes * self.h;
        let t = self.rows[0].state.t;
        (0..=2 * LOOKS).all(|look| {
            let part = f64::from(look % (LOOKS + 1)) / f64::from(LOOKS);
            let before = look <= LOOKS;
            let leg = if before { theta } else { self.h - theta };
            let time = if before {
                part * leg
            } else {
                theta + part * leg
            };
            // Gaps change by no more than the way between two looks.
            let within = self.closed() + 0.5 * leg / f64::from(LOOKS) * fastest;
            others.iter().all(|other| {
                let at = |particle| match before {
                    true => self.falls(particle, time),
                    false => self.came(particle, time),
                };
                self.obstacles.gap(self.particle, *other, t + time, at) > within
            })
        })
    }

    /// Whether its normal velocity changes by forces alone from row k to the next; false where there are no such rows.
    fn free(&self, seen: &mut Seen, k: usize) -> bool {
        let steps = &seen.rows.steps;
        if k + 1 >= steps.len() || steps[k + 1] - steps[k] != seen.pitch {
            return false;
        }
        let [now, next] = [k, k + 1].map(|row| seen.row(row));
        let n = self.beside[0].normal;
        let forces = [&now, &next].map(|row| dot(self.pushed(row.state.t, &row.a), n));
        let parting = |row: &Row| {
            let beside = self
                .obstacles
                .beside(self.particle, self.against, &row.state);
            dot(beside.velocity, n)
        };
        let forces = 0.5 * (forces[0] + forces[1]);
        let unexplained = parting(&next) - parting(&now) - self.h * forces;
        unexplained.abs() <= 0.5 * self.pushes * self.h + self.off_v
    }
}
