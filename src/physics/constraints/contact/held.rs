//! The motion of particles that stay in contact: the same system in coordinates of which some are given.
//!
//! Each such particle has axes of its own. Along the first ones, the normals of its contacts, it moves as its obstacles
//! do: these coordinates are fixed ones. Where it slides, the next axis is the direction it slides in, along which friction
//! acts; where it sticks, all three are given. Every integrator sees flat vectors with some fixed coordinates, so each
//! keeps what it has.
//!
//! On a surface that bends nothing is given to a method that takes rods: N then acts among the forces, at the normal of the
//! moment, and the particle is moved back onto the surface after the step. Any other method has the plane that touches the
//! surface where the step begins, which is of first order.
//!
//! The normal forces N ≥ 0 are those that keep it on the surface: N = m (n·a_s - n·a), a without them and a_s the
//! surface's, turning included (complementarity: a contact that would have to pull is none).
//!
//! Particles that touch each other, or that rods join, have such coordinates together ([`Group`]).

mod turned;
mod work;

use super::group::{Group, TooManyTouch, grouped};
use super::member::{Contact, Member, approach, multipliers};
use super::{Against, Beside, Obstacles};
use crate::physics::{
    Bound, Dampers, ForceKinds, Injected, Jacobian, Linearization, Power, State, Sweep, System,
};
use crate::space::{dot, norm, three};

/// Particles that stay in contact from one instant on, and the system they are part of.
pub struct Held<'s> {
    system: &'s dyn System,
    obstacles: &'s Obstacles,
    members: Vec<Member>,
    /// Of each particle its place among the members, or [`NONE`].
    places: Vec<u32>,
    groups: Vec<Group>,
    inverse_mass: Vec<f64>,
    /// The acceleration without contact at the beginning, m/s².
    begins: Vec<f64>,
    /// When it begins, s.
    since: f64,
    /// What dampers cannot move, where they act one after the other.
    bound: Option<Bound>,
    /// Whether friction acts among the forces. Where it turns, a method whose forces must not depend on velocity takes it
    /// apart: see [`slow_down`](Self::slow_down).
    friction: bool,
}

/// The place of what is no member.
const NONE: u32 = u32::MAX;

/// What ends a motion in contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Change {
    /// A contact would have to pull.
    Leaves,
    /// What slid has come to rest.
    Stops,
    /// What stuck begins to slide.
    Slips,
}

impl<'s> Held<'s> {
    /// What stays in contact from a state on, of what touches there, for a method that takes forces of these kinds; None
    /// where nothing does.
    ///
    /// # Errors
    /// [`TooManyTouch`] where more particles depend on each other than [`MOST`](super::MOST).
    pub fn at(
        system: &'s dyn System,
        obstacles: &'s Obstacles,
        touching: &[Beside],
        state: &State,
        taken: ForceKinds,
    ) -> Result<Option<Self>, TooManyTouch> {
        let any_velocity = taken.has(ForceKinds::NON_LINEAR);
        let follow = any_velocity && taken.has(ForceKinds::CONSTRAINED);
        let resting = touching.iter().filter(|beside| beside.rests());
        let mut all: Vec<Beside> = resting.copied().collect();
        if all.is_empty() {
            return Ok(None);
        }
        let mut a = vec![0.0; state.x.len()];
        system.remembered_acceleration(state.t, &state.x, &state.v, &mut a);
        let groups = grouped(obstacles, system.rods(), &mut all, state, &a)?;
        let mut members: Vec<Member> = Vec::with_capacity(all.len());
        for own in all.chunk_by(|one, other| one.particle == other.particle) {
            let [x, a] = [&state.x, &a].map(|all| three(all, own[0].particle));
            members.extend(Member::new(obstacles, own, state.t, [x, a], follow));
        }
        let pressed = |group: &Group| group.contacts().next().is_some();
        if members.is_empty() && !groups.iter().any(pressed) {
            return Ok(None);
        }
        let mut inverse_mass = system.inverse_mass().to_vec();
        for group in &groups {
            for particle in group.particles() {
                inverse_mass[3 * particle..3 * particle + 3].fill(1.0 / group.mass());
            }
            for at in group.given() {
                inverse_mass[at] = 0.0;
            }
        }
        let mut places = vec![NONE; state.x.len() / 3];
        for (place, member) in members.iter().enumerate() {
            let at = 3 * member.particle;
            inverse_mass[at..at + member.given].fill(0.0);
            places[member.particle] = u32::try_from(place).unwrap_or(NONE);
        }
        let turns = members
            .iter()
            .any(|member| member.slides && !member.straight);
        let friction = any_velocity || !turns;
        let apart = groups.is_empty()
            && !obstacles.any_moves()
            && !system.kinds().has(ForceKinds::GYROSCOPIC)
            && !members
                .iter()
                .any(|member| member.follows || (friction && member.slides));
        let bound = (apart && system.dampers() != Dampers::Whole).then(|| {
            Bound::new(
                state.x.len() / 3,
                members
                    .iter()
                    .map(|member| (member.particle, &member.axes[member.given..])),
            )
        });
        Ok(Some(Self {
            system,
            obstacles,
            members,
            places,
            groups,
            inverse_mass,
            begins: a,
            since: state.t,
            bound,
            friction,
        }))
    }

    /// The state in the particles' own axes.
    pub fn inward(&self, mut own: State) -> State {
        self.turn(&mut own.x);
        self.turn(&mut own.v);
        self.place(own.t, &mut own.x, &mut own.v);
        own
    }

    /// The state in the axes of space, on surfaces that bend too.
    pub fn outward(&self, mut state: State) -> State {
        self.turn_back(&mut state.x);
        self.turn_back(&mut state.v);
        let (rods, h) = (self.system.rods(), state.t - self.since);
        for member in &self.members {
            let begins = three(&self.begins, member.particle);
            member.project(self.obstacles, (h, begins), &mut state);
        }
        for group in &self.groups {
            group.project(self.obstacles, rods, (h, &self.begins), &mut state);
        }
        state
    }

    fn turn(&self, all: &mut [f64]) {
        for member in &self.members {
            let own = member.inward(three(all, member.particle));
            all[3 * member.particle..3 * member.particle + 3].copy_from_slice(&own);
        }
        self.groups.iter().for_each(|group| group.turn(all));
    }

    fn turn_back(&self, all: &mut [f64]) {
        for member in &self.members {
            let out = member.outward(three(all, member.particle));
            all[3 * member.particle..3 * member.particle + 3].copy_from_slice(&out);
        }
        self.groups.iter().for_each(|group| group.turn_back(all));
    }

    /// The acceleration without contact at a state in the axes of space, m/s².
    pub fn free(&self, state: &State) -> Vec<f64> {
        let mut a = vec![0.0; state.x.len()];
        self.system
            .free_acceleration(state.t, &state.x, &state.v, &mut a);
        a
    }

    /// The same where the next step may begin.
    pub fn free_at_end(&self, state: &State) -> Vec<f64> {
        let mut a = vec![0.0; state.x.len()];
        self.system
            .remembered_acceleration(state.t, &state.x, &state.v, &mut a);
        a
    }

    /// The part of a change of velocities that contacts leave at a state, in the axes of space.
    pub fn left(&self, state: &State, change: &mut [f64]) {
        for member in &self.members {
            let own = 3 * member.particle..3 * member.particle + 3;
            if change[own.clone()] == [0.0; 3] {
                continue;
            }
            let left = if member.sticks() {
                [0.0; 3]
            } else {
                let now = member.contacts.now(self.obstacles, state);
                now.along(three(change, member.particle))
            };
            change[own].copy_from_slice(&left);
        }
        for group in &self.groups {
            group.turn(change);
            for at in group.given() {
                change[at] = 0.0;
            }
            group.turn_back(change);
        }
    }

    /// The acceleration with contact at a state in the axes of space, m/s², but for that of moving obstacles.
    pub fn whole(&self, state: &State) -> Vec<f64> {
        let own = self.inward(state.clone());
        let mut a = vec![0.0; state.x.len()];
        self.acceleration(state.t, &own.x, &own.v, &mut a);
        self.turn_back(&mut a);
        a
    }

    /// What has changed at a state in the axes of space, with the acceleration `a` without contact there, by how much: the
    /// largest violation, negative where none is. Each is a continuous function of time, and 0 where the change is due.
    /// Without `a` what has stopped alone.
    pub fn changes(&self, state: &State, a: Option<&[f64]>) -> Vec<(usize, Change, f64)> {
        let mut found = Vec::with_capacity(2 * self.members.len());
        for member in &self.members {
            if !member.slides && a.is_none() {
                continue;
            }
            let mut push = |change: Change, by: f64| found.push((member.particle, change, by));
            let Some(a) = a else {
                // At the end of a step nothing is left along the normal of one contact.
                let along = match &member.contacts[..] {
                    [_] => member.contacts.relative(self.obstacles, state),
                    _ => {
                        let now = member.contacts.now(self.obstacles, state);
                        now.outer_sliding(self.obstacles, state)
                    }
                };
                push(Change::Stops, -dot(member.forward(), along));
                continue;
            };
            let now = member.contacts.now(self.obstacles, state);
            if member.slides {
                let along = now.outer_sliding(self.obstacles, state);
                push(Change::Stops, -dot(member.forward(), along));
            }
            let free = three(a, member.particle);
            let pressed = now.pressed(self.obstacles, state.t, free);
            for n in &pressed {
                push(Change::Leaves, -n);
            }
            if member.sticks() {
                let pull = now.pull(self.obstacles, state.t, free);
                push(Change::Slips, norm(pull) - now.resistance(&pressed, 1));
            }
        }
        for group in &self.groups {
            let own = a.map(|a| group.changes(self.obstacles, self.system.rods(), state, a));
            found.extend(own.into_iter().flatten());
        }
        found
    }

    /// Gives what has stopped the velocity of its obstacle.
    pub fn stop(&self, particle: usize, state: &mut State) {
        if let Some(member) = self.member(particle).filter(|member| member.slides) {
            let along = member.contacts.outer_sliding(self.obstacles, state);
            for axis in 0..3 {
                state.v[3 * particle + axis] -= along[axis];
            }
        }
        for group in &self.groups {
            group.stop(self.obstacles, self.system.rods(), particle, state);
        }
    }

    /// Whether this particle stays in this contact.
    pub fn holds(&self, particle: usize, against: Against) -> bool {
        let is = |beside: &Beside| beside.particle == particle && beside.against == against;
        let member = self.member(particle);
        member.is_some_and(|member| member.contacts.iter().any(|one| is(&one.beside)))
            || self.groups.iter().any(|group| group.contacts().any(is))
    }

    /// Adds friction to an acceleration in the particles' own axes, and sets given coordinates to 0, at positions and
    /// velocities in the axes of space; `v` are the velocities in the particles' own, None where all are 0.
    fn constrain(&self, t: f64, out: [&[f64]; 2], v: Option<&[f64]>, a: &mut [f64]) {
        for member in &self.members {
            let at = 3 * member.particle;
            let own = three(a, member.particle);
            if member.follows {
                let out = out.map(|all| three(all, member.particle));
                let added = member.inward(self.follow(member, t, out, member.outward(own)));
                for axis in 0..3 {
                    a[at + axis] += added[axis];
                }
                continue;
            }
            if member.slides && self.friction {
                let free = member.outward(own);
                let pressed = member.contacts.pressed(self.obstacles, t, free);
                let lost = member.contacts.resistance(&pressed, 0);
                let along = v.map_or([1.0, 0.0], |v| member.direction(self.obstacles, t, v));
                a[at + member.given] -= lost * along[0];
                if member.given == 1 {
                    a[at + 2] -= lost * along[1];
                }
            }
            a[at..at + member.given].fill(0.0);
        }
        for group in &self.groups {
            group.constrain(self.obstacles, t, a, true);
        }
    }

    /// What a surface that bends adds to the acceleration `a` of a particle at a place and with a velocity, all in the
    /// axes of space.
    fn follow(
        &self,
        member: &Member,
        t: f64,
        [place, velocity]: [[f64; 3]; 2],
        a: [f64; 3],
    ) -> [f64; 3] {
        let Against::Obstacle(obstacle) = member.contacts[0].beside.against else {
            return [0.0; 3];
        };
        let at = self
            .obstacles
            .lone(obstacle, member.particle, t, place, velocity);
        let now = Contact::new(self.obstacles, at);
        let pressed = -approach(self.obstacles, &now, t, a);
        let mut added = now.beside.normal.map(|n| pressed * n);
        if member.slides && self.friction {
            let direction = member.rubbed(now.beside.sliding());
            let lost = now.friction[0] * pressed.max(0.0);
            for (added, along) in added.iter_mut().zip(direction) {
                *added -= lost * along;
            }
        }
        added
    }

    /// Positions and velocities in the axes of space.
    fn seen<T>(&self, x: &[f64], v: &[f64], see: impl FnOnce(&[f64], &[f64]) -> T) -> T {
        let (mut x, mut v) = (x.to_vec(), v.to_vec());
        self.turn_back(&mut x);
        if !v.is_empty() {
            self.turn_back(&mut v);
        }
        see(&x, &v)
    }

    fn member(&self, particle: usize) -> Option<&Member> {
        self.members.get(self.places[particle] as usize)
    }

    fn group(&self, particle: usize) -> Option<&Group> {
        let has = |group: &&Group| group.particles().binary_search(&particle).is_ok();
        self.groups.iter().find(has)
    }
}

impl System for Held<'_> {
    fn inverse_mass(&self) -> &[f64] {
        &self.inverse_mass
    }

    fn acceleration(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        let still = v.iter().all(|v| *v == 0.0);
        let mut out_x = x.to_vec();
        let mut out_v = if still { Vec::new() } else { v.to_vec() };
        self.place(t, &mut out_x, &mut out_v);
        self.turn_back(&mut out_x);
        if !still {
            self.turn_back(&mut out_v);
        }
        let seen_v = if still { v } else { &out_v };
        let power = self.system.free_acceleration(t, &out_x, seen_v, a);
        self.turn(a);
        self.constrain(t, [&out_x, seen_v], (!still).then_some(v), a);
        power
    }

    fn rounding(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) {
        self.seen(x, v, |x, v| self.system.rounding(t, x, v, a));
        for member in &self.members {
            let off: f64 = three(a, member.particle).iter().sum();
            a[3 * member.particle..3 * member.particle + 3].fill(off);
        }
        for group in &self.groups {
            let own = |a: &[f64]| group.particles().iter().flat_map(|p| three(a, *p)).sum();
            let off: f64 = own(a);
            for particle in group.particles() {
                a[3 * particle..3 * particle + 3].fill(off);
            }
        }
    }

    fn kinds(&self) -> ForceKinds {
        let mut kinds = self.system.kinds().without(ForceKinds::CONSTRAINED);
        if self.obstacles.any_moves() {
            kinds = kinds | ForceKinds::DRIVEN;
        }
        let turns = self
            .members
            .iter()
            .any(|member| member.slides && !member.straight);
        if self.friction && turns {
            kinds = kinds | ForceKinds::NON_LINEAR;
        }
        if self.members.iter().any(|member| member.follows) {
            kinds = kinds | ForceKinds::CONSTRAINED;
        }
        kinds
    }

    fn place(&self, t: f64, x: &mut [f64], v: &mut [f64]) {
        self.system.place(t, x, v);
        for member in &self.members {
            let [place, speed] = member.placed(self.obstacles, self.since, t);
            let at = 3 * member.particle;
            for axis in 0..member.given {
                x[at + axis] = place[axis];
                if let Some(v) = v.get_mut(at + axis) {
                    *v = speed[axis];
                }
            }
        }
        for group in &self.groups {
            let [place, speed] = group.placed(self.obstacles, self.since, t);
            for (own, at) in group.given().enumerate() {
                x[at] = place[own];
                if let Some(v) = v.get_mut(at) {
                    *v = speed[own];
                }
            }
        }
    }

    fn jumps(&self) -> &[f64] {
        self.system.jumps()
    }

    fn dampers(&self) -> Dampers {
        match self.bound {
            Some(_) => Dampers::Shared,
            None => Dampers::Whole,
        }
    }

    fn sweep(&self, sweep: &mut Sweep) {
        let Some(bound) = &self.bound else {
            return;
        };
        let mut x = sweep.x().to_vec();
        self.turn_back(&mut x);
        sweep.seen(
            self.system,
            &x,
            bound,
            (|v| self.turn_back(v), |v| self.turn(v)),
        );
    }

    fn damping(&self, t: f64, x: &[f64], w: &[f64], a: &mut [f64]) {
        self.seen(x, w, |x, w| self.system.damping(t, x, w, a));
        self.turn(a);
        for member in &self.members {
            let at = 3 * member.particle;
            if member.slides && self.friction {
                // Linear in the force: what presses rubs.
                let free = member.outward(three(a, member.particle));
                let none = multipliers(self.obstacles, &member.contacts, t, [0.0; 3]);
                let some = multipliers(self.obstacles, &member.contacts, t, free);
                let each = some.iter().zip(&none).zip(member.contacts.iter());
                let lost: f64 = each.map(|((n, o), c)| c.friction[0] * (n - o)).sum();
                a[at + member.given] -= lost;
            }
            a[at..at + member.given].fill(0.0);
        }
        for group in &self.groups {
            group.constrain(self.obstacles, t, a, false);
        }
    }

    fn injected(&self, t: f64, x: &[f64], moved: &[f64], h: f64) -> Injected {
        self.seen(x, moved, |x, moved| self.system.injected(t, x, moved, h))
    }

    fn potential(&self, t: f64, x: &[f64]) -> f64 {
        self.seen(x, &[], |x, _| self.system.potential(t, x))
    }

    fn jacobian(
        &self,
        t: f64,
        x: &[f64],
        v: &[f64],
        linearization: Linearization,
        out: &mut Jacobian,
    ) {
        let mut own = Jacobian::in_blocks();
        self.seen(x, v, |x, v| {
            self.system.jacobian(t, x, v, linearization, &mut own);
        });
        self.add_turned(&own, linearization == Linearization::Exact, out);
    }
}
