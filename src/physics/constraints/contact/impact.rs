//! Impacts: Newton's restitution along the normal, Coulomb's friction across it.

use super::{Against, Beside, Near, Obstacles, Surface};
use crate::physics::State;
use crate::physics::constraints::{RodError, Rods};
use crate::space::{dot, minus, norm, three};
use nalgebra::{Matrix3, Vector3};
use std::collections::BTreeSet;

/// Why impacts cannot be taken.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BlowError {
    #[error(transparent)]
    Rods(#[from] RodError),
    #[error("impacts at t = {t} s come to no end: a particle is squeezed between obstacles")]
    NoEnd {
        /// s.
        t: f64,
    },
}

/// What an impact starts from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// The speed at which the two approach, along the normal, m/s.
    pub approach: f64,
    /// The speed along the surface, m/s.
    pub sliding: f64,
    /// e.
    pub restitution: f64,
    /// µ.
    pub friction: f64,
    /// The step at whose end it is taken, s; 0 at the instant of an impact.
    pub h: f64,
}

/// What an impact does to velocities.
#[derive(Debug, Clone, Copy)]
pub struct ImpactLaw {
    /// What the normal velocity gains away from the obstacle, m/s.
    pub restitution: fn(&Hit) -> f64,
    /// What the sliding speed loses, m/s, where the normal velocity gains so much.
    pub friction: fn(&Hit, f64) -> f64,
}

impl ImpactLaw {
    /// v_n' = -e v_n (Newton).
    pub fn newton(hit: &Hit) -> f64 {
        (1.0 + hit.restitution) * hit.approach
    }

    /// Coulomb's law for the impulses.
    pub fn coulomb(hit: &Hit, gained: f64) -> f64 {
        (hit.friction * gained).min(hit.sliding)
    }

    /// The right one.
    pub const RIGHT: Self = Self {
        restitution: Self::newton,
        friction: Self::coulomb,
    };

    /// The change of velocity, m/s, of a particle beside an obstacle.
    pub fn change(&self, beside: &Beside, surface: Surface, h: f64) -> [f64; 3] {
        let sliding = beside.sliding();
        let fast = norm(sliding);
        let hit = Hit {
            approach: -beside.parting(),
            sliding: fast,
            restitution: surface.restitution,
            friction: surface.friction[0],
            h,
        };
        let gained = (self.restitution)(&hit);
        let slowed = (self.friction)(&hit, gained);
        let mut change = beside.normal.map(|n| gained * n);
        if slowed != 0.0 && fast > 0.0 {
            for (change, along) in change.iter_mut().zip(sliding) {
                *change -= slowed / fast * along;
            }
        }
        change
    }
}

/// The most passes over particles that press each other, or that several obstacles press.
const PASSES: usize = 1000;

/// Among what impacts happen, and how.
pub struct Blows<'a> {
    pub near: &'a Near,
    pub rods: Option<&'a Rods>,
    /// Particles strike each other, too.
    pub among: bool,
    /// Nothing is given back: what strikes stays.
    pub lands: bool,
}

/// What impacts have done.
#[derive(Debug, Default)]
pub struct Struck {
    /// The particles that were struck.
    pub particles: BTreeSet<usize>,
    /// The number of impulses.
    pub impulses: u64,
}

impl Obstacles {
    /// Gives particles that strike something the velocities after the impacts, and books the energy that they take. With V
    /// the speed of approach, the normal velocity becomes e V, and the sliding one falls by µ (1 + e) V, to 0 at most:
    /// Coulomb's law for the impulses. What they touch as well they strike next, and what that touches, until nothing is
    /// left to strike: pair by pair, in ascending order of the particles.
    ///
    /// # Errors
    /// [`BlowError`] where rods depend on each other, and where impacts come to no end.
    pub fn strike(
        &self,
        blows: &Blows,
        particles: BTreeSet<usize>,
        state: &mut State,
    ) -> Result<Struck, BlowError> {
        let mut struck = Struck::default();
        let mut next = particles;
        for _ in 0..PASSES {
            let mut later = BTreeSet::new();
            for particle in next {
                let all = self.touched(blows.near, particle, state).into_iter();
                let seen =
                    all.filter(|one| blows.among || matches!(one.against, Against::Obstacle(_)));
                for beside in seen.filter(Beside::strikes) {
                    if self.apply(blows.rods, &beside, blows.lands, state)? {
                        later.extend(beside.particles());
                        struck.impulses += 1;
                    }
                }
            }
            if later.is_empty() {
                return Ok(struck);
            }
            struck.particles.extend(&later);
            next = later;
        }
        Err(BlowError::NoEnd { t: state.t })
    }

    /// One impulse, unless an earlier one has turned the two away; `lands`: nothing is given back.
    ///
    /// # Errors
    /// [`RodError`] where rods depend on each other.
    pub fn apply(
        &self,
        rods: Option<&Rods>,
        beside: &Beside,
        lands: bool,
        state: &mut State,
    ) -> Result<bool, RodError> {
        let beside = self.beside(beside.particle, beside.against, state);
        let speed = -beside.parting();
        if speed <= beside.slow {
            return Ok(false);
        }
        let mut surface = self.surface(beside.against);
        if lands {
            surface.restitution = 0.0;
        }
        if let Some(rods) = rods {
            let away = (1.0 + surface.restitution) * speed;
            return self.apply_on_rods(rods, &beside, [away, surface.friction[0]], state);
        }
        let change = self.law.change(&beside, surface, 0.0);
        self.kick(&beside, change, state);
        Ok(true)
    }

    /// Changes the velocity of two relative to each other, and books it.
    fn kick(&self, beside: &Beside, change: [f64; 3], state: &mut State) {
        self.push(beside, change, &mut state.v);
        let impulse = change.map(|c| c / self.lightness(beside));
        self.book(beside, impulse, state);
    }

    /// One impulse where rods pass some of it on: K is what an impulse here changes the velocity here by.
    fn apply_on_rods(
        &self,
        rods: &Rods,
        beside: &Beside,
        [away, friction]: [f64; 2],
        state: &mut State,
    ) -> Result<bool, RodError> {
        let mut at = rods.at(&state.x)?;
        let mut respond = |impulse: Vector3<f64>| {
            let mut change = vec![0.0; state.v.len()];
            let impulse = <[f64; 3]>::from(impulse);
            self.push(
                beside,
                impulse.map(|p| p * self.lightness(beside)),
                &mut change,
            );
            at.still(&mut change);
            change
        };
        let here = |change: &[f64]| Vector3::from(self.relative(beside, change));
        let columns = [Vector3::x(), Vector3::y(), Vector3::z()].map(|one| here(&respond(one)));
        let k = Matrix3::from_columns(&columns);
        let n = Vector3::from(beside.normal);
        let sliding = Vector3::from(beside.sliding());
        if n.dot(&(k * n)) <= 1e-12 * self.lightness(beside) {
            // Rods hold it there.
            return Ok(false);
        }
        let straight = n * (away / n.dot(&(k * n)));
        let mut impulse = straight;
        if friction > 0.0 {
            let sticking = k
                .pseudo_inverse(1e-12 * k.amax())
                .unwrap_or_else(|_| Matrix3::zeros());
            let sticking = sticking * (n * away - sliding);
            let pressed = sticking.dot(&n);
            let across = sticking - n * pressed;
            impulse = if pressed > 0.0 && across.norm() <= friction * pressed {
                sticking
            } else {
                let against = (-sliding)
                    .try_normalize(0.0)
                    .or_else(|| across.try_normalize(0.0));
                let along = n + against.unwrap_or_default() * friction;
                let opens = n.dot(&(k * along));
                if opens > 0.0 {
                    along * (away / opens)
                } else {
                    straight
                }
            };
            // Newton's law with friction may gain energy where rods turn one into the other (Kane 1984): never so here.
            let after = Vector3::from(beside.velocity) + k * impulse;
            if impulse.dot(&(Vector3::from(beside.velocity) + after)) > 0.0 {
                impulse = straight;
            }
        }
        let change = respond(impulse);
        for (v, change) in state.v.iter_mut().zip(change) {
            *v += change;
        }
        self.book(beside, impulse.into(), state);
        Ok(true)
    }

    /// Puts what is inside by rounding onto surfaces: these particles, and those that they are pushed against, which join
    /// them.
    pub fn push_out(&self, near: &Near, particles: &mut BTreeSet<usize>, state: &mut State) {
        for _ in 0..PASSES {
            let mut pushed = BTreeSet::new();
            for particle in particles.iter() {
                for beside in self.touched(near, *particle, state) {
                    let beside = self.beside(beside.particle, beside.against, state);
                    if beside.gap < -beside.close {
                        let out = beside.normal.map(|n| -beside.gap * n);
                        self.push(&beside, out, &mut state.x);
                        pushed.extend(beside.particles());
                    }
                }
            }
            if pushed.is_empty() {
                return;
            }
            particles.extend(pushed);
        }
    }

    /// Takes the normal velocity V of what touches away, and books the energy; `beside` is as the state has it. By the end
    /// of its bounces friction would have taken µ V less off a sliding velocity than it does from now on: that is given.
    ///
    /// # Errors
    /// [`RodError`] where rods depend on each other.
    pub fn rest(
        &self,
        rods: Option<&Rods>,
        beside: &Beside,
        state: &mut State,
    ) -> Result<(), RodError> {
        let parting = beside.parting();
        match rods {
            Some(rods) => {
                self.apply_on_rods(rods, beside, [-parting, 0.0], state)?;
            }
            None => {
                let mut change = beside.normal.map(|n| -parting * n);
                let sliding = beside.sliding();
                let fast = norm(sliding);
                if parting > 0.0 && fast > beside.slow {
                    let given = self.surface(beside.against).friction[0] * parting / fast;
                    for (change, along) in change.iter_mut().zip(sliding) {
                        *change += given * along;
                    }
                }
                self.kick(beside, change, state);
            }
        }
        Ok(())
    }

    /// Changes what two have relative to each other, each by its 1/m.
    pub fn push(&self, beside: &Beside, change: [f64; 3], all: &mut [f64]) {
        let whole = self.lightness(beside);
        for (end, sign) in beside.particles().into_iter().zip([1.0, -1.0]) {
            let share = sign * (self.weights[end] / whole);
            for axis in 0..3 {
                all[3 * end + axis] += share * change[axis];
            }
        }
    }

    /// The sum of both 1/m, 1/kg.
    pub fn lightness(&self, beside: &Beside) -> f64 {
        beside
            .particles()
            .iter()
            .map(|end| self.weights[*end])
            .sum()
    }

    /// A vector at the particle relative to the other; to an obstacle as if that was at rest.
    pub fn relative(&self, beside: &Beside, all: &[f64]) -> [f64; 3] {
        let own = three(all, beside.particle);
        match beside.against {
            Against::Obstacle(_) => own,
            Against::Particle(other) => minus(own, three(all, other)),
        }
    }

    /// Books what an impulse, N s, took out, and what the obstacle's motion did by it; `beside` is as before it.
    fn book(&self, beside: &Beside, impulse: [f64; 3], state: &mut State) {
        let along = self.moved(beside.against, state.t)[1];
        let after = minus(self.relative(beside, &state.v), along);
        state.work.injected += dot(impulse, along);
        state.work.impacts -= 0.5 * (dot(impulse, beside.velocity) + dot(impulse, after));
    }
}

impl Beside {
    /// The particles in it: one, or two.
    pub fn particles(&self) -> Vec<usize> {
        self.against.with(self.particle)
    }
}
