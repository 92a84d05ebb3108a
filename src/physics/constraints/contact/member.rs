//! One particle that stays in contact: its axes, what presses it, and how it rubs.

use super::{Beside, Obstacles};
use crate::physics::State;
use crate::shape::Bend;
use crate::space::{cross, dot, minus, norm, three};
use smallvec::{SmallVec, smallvec};
use std::borrow::Cow;
use std::ops::Deref;

/// Newton's steps onto a surface.
const ITERATIONS: usize = 20;

/// One particle that stays.
#[derive(Debug, Clone)]
pub(super) struct Member {
    pub(super) particle: usize,
    pub(super) contacts: Pressing,
    /// Rows: unit vectors, the given ones first.
    pub(super) axes: [[f64; 3]; 3],
    /// How many coordinates are given: those along normals, or all where it sticks.
    pub(super) given: usize,
    /// The given coordinates at the beginning, m.
    pub(super) start: [f64; 3],
    /// It slides along the axis `given`, against friction.
    pub(super) slides: bool,
    /// Whether it keeps to that direction.
    pub(super) straight: bool,
    /// Whether it follows a surface that bends.
    pub(super) follows: bool,
}

/// A contact that presses.
#[derive(Debug, Clone, Copy)]
pub(super) struct Contact {
    pub(super) beside: Beside,
    pub(super) friction: [f64; 2],
    /// What the bend of the surface adds to the normal acceleration, m/s², as it was at the beginning.
    pub(super) turning: f64,
}

/// Coordinates in a particle's own axes, each with its factor.
pub(super) type Reach = SmallVec<[(usize, f64); 3]>;

/// N/m of each contact, m/s².
pub(super) type Forces = SmallVec<[f64; 3]>;

/// The contacts of one particle that press; at least one. Most have one, and are many.
#[derive(Debug, Clone)]
pub(super) struct Pressing(SmallVec<[Contact; 1]>);

impl Contact {
    pub(super) fn new(obstacles: &Obstacles, beside: Beside) -> Self {
        Self {
            beside,
            friction: obstacles.surface(beside.against).friction,
            turning: beside.bend.turning(beside.normal, beside.velocity),
        }
    }

    /// The same contact at another state.
    pub(super) fn now(&self, obstacles: &Obstacles, state: &State) -> Self {
        let Beside {
            particle, against, ..
        } = self.beside;
        Self::new(obstacles, obstacles.beside(particle, against, state))
    }
}

impl Deref for Pressing {
    type Target = [Contact];

    fn deref(&self) -> &[Contact] {
        &self.0
    }
}

impl Pressing {
    /// The same contacts at another state, where surfaces bend.
    pub(super) fn now(&self, obstacles: &Obstacles, state: &State) -> Cow<'_, Self> {
        if self.iter().all(|one| one.beside.bend == Bend::Flat) {
            return Cow::Borrowed(self);
        }
        Cow::Owned(Self(
            self.iter().map(|one| one.now(obstacles, state)).collect(),
        ))
    }

    /// The part of a vector along all surfaces it touches.
    pub(super) fn along(&self, vector: [f64; 3]) -> [f64; 3] {
        match &self[..] {
            [one] => {
                let n = one.beside.normal;
                let part = dot(n, vector);
                [0, 1, 2].map(|c| vector[c] - part * n[c])
            }
            [one, other] => {
                let edge = unit(cross(one.beside.normal, other.beside.normal));
                edge.map_or([0.0; 3], |edge| {
                    let part = dot(edge, vector);
                    edge.map(|c| part * c)
                })
            }
            _ => [0.0; 3],
        }
    }

    /// Along the surfaces, in the axes of space, relative to the obstacle.
    pub(super) fn outer_sliding(&self, obstacles: &Obstacles, state: &State) -> [f64; 3] {
        self.along(self.relative(obstacles, state))
    }

    /// The velocity relative to the obstacle.
    pub(super) fn relative(&self, obstacles: &Obstacles, state: &State) -> [f64; 3] {
        let moved = obstacles.moved(self[0].beside.against, state.t)[1];
        minus(three(&state.v, self[0].beside.particle), moved)
    }

    /// N/m of each contact, m/s²; negative where it would have to pull.
    pub(super) fn pressed(&self, obstacles: &Obstacles, t: f64, a: [f64; 3]) -> Forces {
        multipliers(obstacles, self, t, a)
    }

    /// The acceleration along the surfaces, relative to the obstacle, m/s², that friction has to hold.
    pub(super) fn pull(&self, obstacles: &Obstacles, t: f64, a: [f64; 3]) -> [f64; 3] {
        let pushed = obstacles.moved(self[0].beside.against, t)[2];
        self.along(minus(a, pushed))
    }

    /// The deceleration by friction, m/s²: of what slides (0) or the most of what sticks (1).
    pub(super) fn resistance(&self, pressed: &[f64], which: usize) -> f64 {
        let each = pressed.iter().zip(&self.0);
        each.map(|(n, contact)| contact.friction[which] * n.max(0.0))
            .sum()
    }
}

impl Member {
    /// None where nothing presses. `a` is the acceleration without contact, m/s².
    pub(super) fn new(
        obstacles: &Obstacles,
        resting: &[Beside],
        t: f64,
        [x, a]: [[f64; 3]; 2],
        follow: bool,
    ) -> Option<Self> {
        let contacts = resting.iter();
        let contacts: SmallVec<[Contact; 1]> = contacts
            .map(|beside| Contact::new(obstacles, *beside))
            .collect();
        let contacts = pressing(obstacles, contacts, t, a)?;
        let mut axes: SmallVec<[[f64; 3]; 3]> = SmallVec::new();
        for contact in contacts.iter() {
            let n = contact.beside.normal;
            let along = axes.iter().fold(n, |left, axis| {
                let part = dot(*axis, n);
                [0, 1, 2].map(|c| left[c] - part * axis[c])
            });
            axes.push(unit(along)?);
        }
        let normals = axes.len();
        let particle = contacts[0].beside.particle;
        let mut member = Self {
            particle,
            contacts,
            axes: [[0.0; 3]; 3],
            given: normals,
            start: [0.0; 3],
            slides: false,
            straight: true,
            follows: false,
        };
        let first = &member.contacts[0];
        let sliding = member.contacts.along(first.beside.velocity);
        let mut direction = None;
        if normals < 3 && norm(sliding) > first.beside.slow {
            direction = unit(sliding);
        } else if normals < 3 {
            let pull = member.contacts.pull(obstacles, t, a);
            let pressed = member.contacts.pressed(obstacles, t, a);
            let rubs = member
                .contacts
                .iter()
                .any(|contact| contact.friction[1] > 0.0);
            // At the instant at which it begins to slip it slides.
            if rubs && norm(pull) < member.contacts.resistance(&pressed, 1) {
                member.given = 3;
            } else {
                direction = unit(pull);
            }
        }
        member.slides = member.given < 3 && member.contacts.iter().any(|c| c.friction[0] > 0.0);
        if let (true, Some(direction)) = (normals < 3, direction) {
            axes.push(direction);
            let pull = member.contacts.pull(obstacles, t, a);
            let aside = norm(cross(direction, member.contacts.along(pull)));
            member.straight = normals == 2 || aside <= 1e-12 * norm(a).max(f64::MIN_POSITIVE);
        }
        complete(&mut axes);
        member.axes = [axes[0], axes[1], axes[2]];
        if let ([one], true, false) = (&member.contacts[..], follow, member.sticks())
            && one.beside.bend != Bend::Flat
        {
            (member.follows, member.given, member.straight) = (true, 0, false);
        }
        member.start = member.inward(x);
        Some(member)
    }

    /// Whether all coordinates are given by friction.
    pub(super) fn sticks(&self) -> bool {
        self.given > self.contacts.len()
    }

    /// The axis that it slides along at the beginning.
    pub(super) fn forward(&self) -> [f64; 3] {
        self.axes[self.contacts.len().min(2)]
    }

    /// The direction that friction acts against at this velocity along the surfaces, where that may turn. Beyond a
    /// standstill it stays as it was.
    pub(super) fn rubbed(&self, sliding: [f64; 3]) -> [f64; 3] {
        let forward = self.forward();
        let turns = !self.straight && dot(forward, sliding) > 0.0;
        unit(sliding).filter(|_| turns).unwrap_or(forward)
    }

    #[inline]
    pub(super) fn inward(&self, out: [f64; 3]) -> [f64; 3] {
        let [a, b, c] = self.axes;
        [dot(a, out), dot(b, out), dot(c, out)]
    }

    #[inline]
    pub(super) fn outward(&self, own: [f64; 3]) -> [f64; 3] {
        let [a, b, c] = self.axes;
        let along = |axis| own[0] * a[axis] + own[1] * b[axis] + own[2] * c[axis];
        [along(0), along(1), along(2)]
    }

    /// The direction of sliding in the plane of the last two axes, at velocities in its own axes. Beyond a standstill it
    /// stays as it was: that is where the step will end.
    pub(super) fn direction(&self, obstacles: &Obstacles, t: f64, v: &[f64]) -> [f64; 2] {
        if self.straight || self.given != 1 {
            return [1.0, 0.0];
        }
        let moved = obstacles.moved(self.contacts[0].beside.against, t)[1];
        let own = minus(three(v, self.particle), self.inward(moved));
        let fast = own[1].hypot(own[2]);
        if own[1] > 0.0 && fast > 0.0 {
            [own[1] / fast, own[2] / fast]
        } else {
            [1.0, 0.0]
        }
    }

    /// Given coordinates, and their velocities, at a time.
    pub(super) fn placed(&self, obstacles: &Obstacles, since: f64, t: f64) -> [[f64; 3]; 2] {
        let moved = |contact: &Contact| {
            let moved = |t| obstacles.moved(contact.beside.against, t);
            let ([before, ..], [now, speed, _]) = (moved(since), moved(t));
            [minus(now, before), speed]
        };
        let first = moved(&self.contacts[0]);
        let mut all = first.map(|vector| self.inward(vector));
        // Along a second normal the second obstacle decides.
        for at in 1..self.contacts.len() {
            let vectors = moved(&self.contacts[at]);
            let n = self.inward(self.contacts[at].beside.normal);
            for (own, vector) in all.iter_mut().zip(vectors) {
                let before: f64 = (0..at).map(|axis| n[axis] * own[axis]).sum();
                own[at] = (dot(self.contacts[at].beside.normal, vector) - before) / n[at];
            }
        }
        let [way, speed] = all;
        [[0, 1, 2].map(|axis| self.start[axis] + way[axis]), speed]
    }

    /// Moves a particle back onto surfaces that bend, and takes its normal velocity away. Where the plane of before stood
    /// for the surface, it moves along the normal of before, `h` seconds ago, velocities alike, and so does half a step of
    /// the force that was held back, for the acceleration `begins` without contact, m/s²: the motion is RATTLE's.
    pub(super) fn project(
        &self,
        obstacles: &Obstacles,
        (h, begins): (f64, [f64; 3]),
        state: &mut State,
    ) {
        let flat = |contact: &Contact| contact.beside.bend == Bend::Flat;
        if self.sticks() || self.contacts.iter().all(flat) {
            return;
        }
        let beside = |contact: &Contact, state: &State| {
            obstacles.beside(self.particle, contact.beside.against, state)
        };
        let onto = |now: &Beside, parting: f64, state: &mut State| {
            for (axis, n) in now.normal.into_iter().enumerate() {
                state.x[3 * self.particle + axis] -= now.gap * n;
                state.v[3 * self.particle + axis] -= parting * n;
            }
        };
        let ([one], false) = (&self.contacts[..], self.follows || h <= 0.0) else {
            for contact in self.contacts.iter() {
                let now = beside(contact, state);
                onto(&now, now.parting(), state);
            }
            return;
        };
        let n = one.beside.normal;
        let mut moved = 0.0;
        let mut now = beside(one, state);
        for _ in 0..ITERATIONS {
            let along = dot(n, now.normal);
            if now.gap.abs() <= now.close || along <= 0.0 {
                break;
            }
            let step = -now.gap / along;
            moved += step;
            for axis in 0..3 {
                state.x[3 * self.particle + axis] += step * n[axis];
            }
            now = beside(one, state);
        }
        let pushed = obstacles.moved(one.beside.against, state.t - h)[2];
        let back = moved / h + 0.5 * h * dot(n, minus(begins, pushed));
        for axis in 0..3 {
            state.v[3 * self.particle + axis] += back * n[axis];
        }
        onto(&now, now.parting() + back * dot(n, now.normal), state);
    }

    /// The rows in its own axes that a row in the axes of space goes into, each with its factor; with friction where it
    /// slides straight on.
    pub(super) fn rows(&self, row: usize, friction: bool) -> Reach {
        let (at, axis) = (3 * self.particle, row % 3);
        let mut rows: Reach = (0..3).map(|own| (at + own, self.axes[own][axis])).collect();
        if friction && self.slides && self.contacts.len() == 1 {
            // N = m a_s - n·f, so that -µ N gains µ n·f.
            rows[1].1 += self.contacts[0].friction[0] * self.axes[0][axis];
        }
        rows
    }

    pub(super) fn columns(&self, column: usize) -> Reach {
        let (at, axis) = (3 * self.particle, column % 3);
        (0..3).map(|own| (at + own, self.axes[own][axis])).collect()
    }
}

/// The contacts of one particle that press, of those it touches: the ones whose normal forces are positive while no other
/// is pressed into. None where none does.
fn pressing(
    obstacles: &Obstacles,
    touching: SmallVec<[Contact; 1]>,
    t: f64,
    a: [f64; 3],
) -> Option<Pressing> {
    if let [one] = &touching[..] {
        return (approach(obstacles, one, t, a) < 0.0).then_some(Pressing(touching));
    }
    let count = touching.len().min(8);
    let mut best: Option<(f64, SmallVec<[Contact; 1]>)> = None;
    for set in 1_u32..1 << count {
        let members: SmallVec<[Contact; 1]> = (0..count)
            .filter(|at| set & (1 << at) != 0)
            .map(|at| touching[at])
            .collect();
        if members.len() > 3 {
            continue;
        }
        let pressed = multipliers(obstacles, &members, t, a);
        if !pressed.iter().all(|n| *n >= 0.0) {
            continue;
        }
        let held = [0, 1, 2].map(|axis| {
            let each = members.iter().zip(&pressed);
            a[axis] + each.map(|(c, n)| n * c.beside.normal[axis]).sum::<f64>()
        });
        // How far the others are pressed into.
        let into = touching.iter().map(|c| -approach(obstacles, c, t, held));
        let into = into.fold(0.0, f64::max);
        let better = best.as_ref().is_none_or(|(least, _)| into < *least);
        if better {
            best = Some((into, members));
        }
    }
    // Free where no contact would be pressed into; at the instant at which one leaves nothing presses.
    let free = touching.iter().all(|c| approach(obstacles, c, t, a) >= 0.0);
    if free {
        return None;
    }
    best.map(|(_, set)| Pressing(set))
}

/// How a contact would open, m/s², under an acceleration.
pub(super) fn approach(obstacles: &Obstacles, contact: &Contact, t: f64, a: [f64; 3]) -> f64 {
    let pushed = obstacles.moved(contact.beside.against, t)[2];
    dot(contact.beside.normal, minus(a, pushed)) - contact.turning
}

/// N/m of contacts that keep all of them closed, m/s²: (n_i·n_j) N = -(n·a - n·a_s); not numbers where normals depend
/// on each other.
pub(super) fn multipliers(
    obstacles: &Obstacles,
    contacts: &[Contact],
    t: f64,
    a: [f64; 3],
) -> Forces {
    let right: Forces = contacts
        .iter()
        .map(|contact| -approach(obstacles, contact, t, a))
        .collect();
    let n = |at: usize| contacts[at].beside.normal;
    match contacts.len() {
        1 => right,
        2 => {
            let c = dot(n(0), n(1));
            let det = (1.0 - c) * (1.0 + c);
            smallvec![
                (right[0] - c * right[1]) / det,
                (right[1] - c * right[0]) / det,
            ]
        }
        _ => {
            let gram = nalgebra::Matrix3::from_fn(|i, j| dot(n(i), n(j)));
            let solved = gram
                .lu()
                .solve(&nalgebra::Vector3::from_fn(|i, _| right[i]));
            solved.map_or(smallvec![f64::NAN; 3], |n| n.as_slice().into())
        }
    }
}

pub(super) fn unit(vector: [f64; 3]) -> Option<[f64; 3]> {
    let length = norm(vector);
    (length > 0.0 && length.is_finite()).then(|| vector.map(|c| c / length))
}

/// Adds axes until there are three.
fn complete(axes: &mut SmallVec<[[f64; 3]; 3]>) {
    while axes.len() < 3 {
        let next = match axes[..] {
            [one, other] => cross(one, other),
            [one] => {
                // The axis of space that is least along it.
                let least = |best: usize, c: usize| {
                    if one[c].abs() < one[best].abs() {
                        c
                    } else {
                        best
                    }
                };
                let mut other = [0.0; 3];
                other[(0..3).fold(0, least)] = 1.0;
                cross(one, other)
            }
            _ => [1.0, 0.0, 0.0],
        };
        axes.push(unit(next).unwrap_or([0.0, 0.0, 1.0]));
    }
}
