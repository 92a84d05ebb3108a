//! Contact of particles with obstacles and with each other: where they are, what an impact does
//! ([`strike`](Obstacles::strike)), and the motion of what stays in contact ([`Held`]). When impacts happen is the loop's
//! business, not the forces'.

mod group;
mod held;
mod impact;
mod member;
mod near;

pub use group::{MOST, TooManyTouch};
pub use held::{Change, Held};
pub use impact::{BlowError, Blows, Hit, ImpactLaw, Struck};
pub use near::Near;

use super::ConstraintRow;
use crate::physics::State;
use crate::scene::{Collider, Drive, Scene};
use crate::shape::{Bend, Shape};
use crate::space::{dot, minus, norm, three};
use near::Broad;
use std::sync::{Arc, Mutex, PoisonError};

pub(super) const ROW: ConstraintRow = ConstraintRow {
    id: "colliders",
    summary: "keep particles outside of obstacles, by impulses where they meet and forces where they stay",
    source: "v_n' = -e v_n, and min(µ (1 + e) |v_n|, |v_t|) off the sliding velocity (Newton, Coulomb); N ≥ 0 where the gap is \
             closed, sliding against µ N, sticking up to µ_s N (Signorini; Moreau 1988)",
};

/// Gaps within this part of the scene's size are contact: the end of a step that was cut is no nearer.
const TOUCHING: f64 = 1e-13;
/// A gap that a report calls closed is within this part.
const CLOSED: f64 = 1e-9;
/// A bounce of less than this part of the scene's size is the last of a row.
const LOWEST: f64 = 4e-13;
/// Normal velocities within this part of the speed are none.
const SLOW: f64 = 1e-10;
/// Nor is a gap right to more than this part of the coordinates it comes from.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The obstacles of a scene, and what collides with them.
#[derive(Debug)]
pub struct Obstacles {
    obstacles: Vec<Obstacle>,
    law: ImpactLaw,
    /// How particles collide with each other; None where they do not.
    among: Option<Surface>,
    /// Of each particle, those that springs or rods join to it, ascending: they do not collide.
    joined: Vec<Vec<usize>>,
    /// k, N/m, and c, N s/m, where springs and dampers take the place of impulses.
    penalty: Option<[f64; 2]>,
    /// Of each particle, m.
    radii: Vec<f64>,
    /// Of each particle, 1/kg; 0 where it is fixed, and does not collide.
    weights: Vec<f64>,
    /// Gaps within this are contact, m, but for the rounding of coordinates.
    close: f64,
    /// What would rise by less, m, stays.
    lowest: f64,
    /// The scene's step, s: normal velocities that open no gap that is seen in it are none.
    step: f64,
    /// What is near what. It changes no number.
    broad: Mutex<Broad>,
}

/// One obstacle.
#[derive(Debug, Clone)]
struct Obstacle {
    /// Its index among the scene's colliders; a mesh is as many obstacles as it has triangles.
    collider: usize,
    shape: Shape,
    motion: Option<Drive>,
    surface: Surface,
}

/// The coefficients of a contact.
#[derive(Debug, Clone, Copy)]
pub struct Surface {
    /// e.
    pub restitution: f64,
    /// µ of what slides, and of what sticks.
    pub friction: [f64; 2],
}

/// What a particle collides with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Against {
    /// One of the scene's obstacles, which counts a mesh by its triangles.
    Obstacle(usize),
    /// Another particle.
    Particle(usize),
}

impl Against {
    /// The particles of a contact of this one: one, or two.
    pub fn with(self, particle: usize) -> Vec<usize> {
        match self {
            Self::Obstacle(_) => vec![particle],
            Self::Particle(other) => vec![particle, other],
        }
    }
}

/// A particle beside an obstacle, or beside another particle, of which it is then the first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beside {
    pub particle: usize,
    pub against: Against,
    /// The gap between the two, m; negative inside.
    pub gap: f64,
    /// From the other to the particle, a unit vector.
    pub normal: [f64; 3],
    /// How surfaces at this gap bend.
    pub bend: Bend,
    /// Relative to the other, m/s.
    pub velocity: [f64; 3],
    /// A gap within this is contact, m.
    pub close: f64,
    /// A normal velocity within this is none, m/s.
    pub slow: f64,
}

impl Beside {
    /// The normal velocity, m/s; positive where the two part.
    pub fn parting(&self) -> f64 {
        dot(self.normal, self.velocity)
    }

    /// The velocity along the surface, m/s.
    pub fn sliding(&self) -> [f64; 3] {
        let parting = self.parting();
        [0, 1, 2].map(|axis| self.velocity[axis] - parting * self.normal[axis])
    }

    /// Whether the two are in contact, or in each other.
    pub fn touches(&self) -> bool {
        self.gap <= self.close
    }

    /// Whether an impact is due.
    pub fn strikes(&self) -> bool {
        self.touches() && self.parting() < -self.slow
    }

    /// Whether the particle is on the surface and stays, as far as velocities say.
    pub fn rests(&self) -> bool {
        self.touches() && self.parting() <= self.slow
    }
}

impl Obstacle {
    fn new((at, collider): (usize, &Collider)) -> impl Iterator<Item = Self> {
        collider.shapes().into_iter().map(move |shape| Self {
            collider: at,
            shape,
            motion: collider.displacement(),
            surface: Surface {
                restitution: collider.restitution,
                friction: [collider.friction, collider.static_friction],
            },
        })
    }

    /// How far it has moved, m, its velocity, m/s, and its acceleration, m/s².
    fn moved(&self, t: f64) -> [[f64; 3]; 3] {
        self.motion
            .as_ref()
            .map_or([[0.0; 3]; 3], |motion| motion.at(t))
    }

    /// The distance of a point from it, m.
    fn distance(&self, t: f64, x: [f64; 3]) -> f64 {
        self.shape.nearest(minus(x, self.moved(t)[0])).distance
    }

    /// How far it moves between two times, m, at most.
    fn reach(&self, from: f64, to: f64) -> f64 {
        let motion = self.motion.as_ref();
        motion.map_or(0.0, |motion| motion.speed_bound(to) * (to - from))
    }
}

impl Obstacles {
    /// None where nothing collides.
    pub fn new(scene: &Scene) -> Option<Self> {
        let obstacles = scene.colliders.iter().enumerate();
        let obstacles: Vec<_> = obstacles.flat_map(Obstacle::new).collect();
        let contact = scene.contact.as_ref().filter(|contact| contact.particles);
        let among = contact.map(|contact| Surface {
            restitution: contact.restitution,
            friction: [contact.friction, contact.static_friction],
        });
        let weight = |p: &crate::scene::Particle| if p.fixed { 0.0 } else { 1.0 / p.mass };
        if obstacles.is_empty() && among.is_none() {
            return None;
        }
        let mut joined = vec![Vec::new(); scene.particles.len()];
        for [i, j] in scene.joined() {
            joined[i].push(j);
            joined[j].push(i);
        }
        for own in &mut joined {
            own.sort_unstable();
            own.dedup();
        }
        let contact = scene.contact.as_ref();
        let penalty = contact.and_then(|contact| contact.penalty.as_ref());
        let mut all = Self {
            obstacles,
            law: ImpactLaw::RIGHT,
            among,
            joined,
            penalty: penalty.map(|penalty| [penalty.stiffness, penalty.damping]),
            radii: scene.particles.iter().map(|p| p.radius).collect(),
            weights: scene.particles.iter().map(weight).collect(),
            close: 0.0,
            lowest: 0.0,
            step: scene.solver.timestep,
            broad: Mutex::default(),
        };
        let size = all.measured(scene);
        (all.close, all.lowest) = (TOUCHING * size, LOWEST * size);
        Some(all)
    }

    /// How large the scene is, m: the box around the particles, the largest of them, and how far they are from obstacles;
    /// at least the way of the fastest in a step.
    fn measured(&self, scene: &Scene) -> f64 {
        let starts = scene.starts();
        let mut size = scene.size() + self.radii.iter().fold(0.0, |most, r| r.max(most));
        for obstacle in &self.obstacles {
            for particle in self.particles() {
                size = size.max(obstacle.distance(0.0, starts[particle]) - self.radii[particle]);
            }
        }
        let fastest = scene.particles.iter().map(|p| norm(p.velocity));
        let h = scene.solver.timestep;
        size.max(h * (fastest.fold(0.0, f64::max) + h * norm(scene.gravity())))
    }

    /// The same with another law of impacts.
    pub fn struck_by(&self, law: ImpactLaw) -> Self {
        Self {
            law,
            ..self.copied()
        }
    }

    /// The same with other coefficients.
    pub fn resurfaced(&self, change: impl Fn(Surface) -> Surface) -> Self {
        let mut all = self.copied();
        for one in &mut all.obstacles {
            one.surface = change(one.surface);
        }
        all.among = all.among.map(change);
        all
    }

    /// The same with other radii, m; less than 0 where surfaces are farther away by more than the radius.
    pub fn resized(&self, change: impl Fn(f64) -> f64) -> Self {
        let mut all = self.copied();
        for radius in &mut all.radii {
            *radius = change(*radius);
        }
        all
    }

    /// The same, but particles do not collide with each other.
    pub fn apart(&self) -> Self {
        Self {
            among: None,
            ..self.copied()
        }
    }

    /// The same, which remembers nothing of what was near.
    pub fn copied(&self) -> Self {
        Self {
            obstacles: self.obstacles.clone(),
            joined: self.joined.clone(),
            radii: self.radii.clone(),
            weights: self.weights.clone(),
            broad: Mutex::default(),
            ..*self
        }
    }

    /// What may touch while each particle keeps within a cube, given by its centre and half a side, m, between two times: in
    /// ascending order.
    pub fn near(&self, times: [f64; 2], cube: impl Fn(usize) -> ([f64; 3], f64)) -> Arc<Near> {
        let broad = self.broad.lock();
        let mut broad = broad.unwrap_or_else(PoisonError::into_inner);
        broad.near(self, times, &cube)
    }

    /// What may touch at a state, as [`near`](Self::near).
    pub fn near_now(&self, state: &State) -> Arc<Near> {
        self.near([state.t; 2], |particle| (three(&state.x, particle), 0.0))
    }

    /// Whether one of them moves.
    pub fn any_moves(&self) -> bool {
        self.obstacles.iter().any(|one| one.motion.is_some())
    }

    /// The particles that springs or rods join to one, ascending.
    pub fn joined_to(&self, particle: usize) -> &[usize] {
        &self.joined[particle]
    }

    /// k, N/m, and c, N s/m, where springs and dampers take the place of impulses: they are part of the forces then.
    pub fn penalty(&self) -> Option<[f64; 2]> {
        self.penalty
    }

    /// The fastest rate of a contact by penalty, 1/s: w + c/m, of the lightest that may press each other; 0 without.
    pub fn fastest(&self) -> f64 {
        let Some([stiffness, damping]) = self.penalty else {
            return 0.0;
        };
        let mut weights = self.weights.clone();
        weights.sort_by(|a, b| b.total_cmp(a));
        let ends = 1 + usize::from(self.among.is_some());
        let weight: f64 = weights.iter().take(ends).sum();
        (stiffness * weight).sqrt() + damping * weight
    }

    /// Every contact in which something is inside, in ascending order.
    pub fn inside(&self, state: &State) -> Vec<Beside> {
        let at = |particle| three(&state.x, particle);
        let near = self.near_now(state);
        let inside = near
            .pairs()
            .filter(|(particle, against)| self.gap(*particle, *against, state.t, at) < 0.0);
        inside
            .map(|(particle, against)| self.beside(particle, against, state))
            .collect()
    }

    /// Whether particles collide with each other.
    pub fn among_particles(&self) -> bool {
        self.among.is_some()
    }

    /// The particles that collide.
    pub fn particles(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.weights.len()).filter(|particle| self.weights[*particle] > 0.0)
    }

    /// The gap between a particle and another, or an obstacle, m; `at` tells where particles are, m.
    pub fn gap(
        &self,
        particle: usize,
        against: Against,
        t: f64,
        at: impl Fn(usize) -> [f64; 3],
    ) -> f64 {
        let own = self.radii[particle];
        match against {
            Against::Obstacle(other) => self.obstacles[other].distance(t, at(particle)) - own,
            Against::Particle(other) => {
                norm(minus(at(particle), at(other))) - (own + self.radii[other])
            }
        }
    }

    /// What a report calls touching, m: a billionth of the scene's size. Not to be confused with [`close`](Self::close), at
    /// which there are impacts.
    pub fn closed(&self) -> f64 {
        self.size() * CLOSED
    }

    /// The scene's size, m, with its obstacles: the box around the particles, the largest of them, and how far they are from
    /// obstacles.
    pub fn size(&self) -> f64 {
        self.close / TOUCHING
    }

    /// The radius of a particle, m.
    pub fn radius(&self, particle: usize) -> f64 {
        self.radii[particle]
    }

    /// In words: `collider 0 (plane)` or `particle 1`.
    pub fn name(&self, against: Against) -> String {
        match against {
            Against::Obstacle(at) => {
                let one = &self.obstacles[at];
                format!("collider {} ({})", one.collider, one.shape.name())
            }
            Against::Particle(other) => format!("particle {other}"),
        }
    }

    /// What would rise by less than this, m, stays: less than is seen.
    pub fn lowest(&self, beside: &Beside) -> f64 {
        self.lowest.max(2.0 * beside.close)
    }

    /// How far off what stays may be, m, since it is not seen to rise: by the last bounce, and along a surface by µ V times
    /// the time that its bounces would still take, 2 V/((1 - e) a). 0 where nothing bounces to an end.
    pub fn unseen(&self) -> f64 {
        let surfaces = self.surfaces().chain(self.among);
        let each = surfaces
            .filter(|one| one.restitution > 0.0 && one.restitution < 1.0)
            .map(|one| 1.0 + 4.0 * one.friction[0] / (1.0 - one.restitution));
        self.lowest * each.fold(0.0, f64::max)
    }

    /// Whether surfaces of obstacles bend on which a particle may slide.
    pub fn bend(&self) -> bool {
        let flat = |one: &Obstacle| matches!(one.shape, Shape::Plane { .. });
        !self.obstacles.iter().all(flat)
    }

    /// Every particle that collides, with every obstacle.
    pub fn pairs(&self) -> impl Iterator<Item = (usize, Against)> + '_ {
        let each = |obstacle| {
            let particles = self.particles();
            particles.map(move |particle| (particle, Against::Obstacle(obstacle)))
        };
        (0..self.obstacles.len()).flat_map(each)
    }

    /// The coefficients of all obstacles, and of particles with each other.
    pub fn surfaces(&self) -> impl Iterator<Item = Surface> + '_ {
        self.obstacles
            .iter()
            .map(|one| one.surface)
            .chain(self.among)
    }

    /// Whether an obstacle moves; false of particles.
    pub fn moves(&self, against: Against) -> bool {
        matches!(against, Against::Obstacle(at) if self.obstacles[at].motion.is_some())
    }

    /// 1/m of a particle, 1/kg; 0 where it is fixed, and does not collide.
    pub fn weight(&self, particle: usize) -> f64 {
        self.weights[particle]
    }

    /// Which of the scene's colliders an obstacle is, or is part of.
    pub fn collider(&self, against: Against) -> Option<usize> {
        match against {
            Against::Obstacle(at) => Some(self.obstacles[at].collider),
            Against::Particle(_) => None,
        }
    }

    /// A gap within this, m, is contact at `x`, m.
    pub fn close(&self, x: [f64; 3]) -> f64 {
        self.close + ROUNDING * x.iter().fold(0.0, |most: f64, c| most.max(c.abs()))
    }

    /// How far an obstacle moves between two times, m, at most; 0 of particles.
    pub fn reach(&self, against: Against, from: f64, to: f64) -> f64 {
        match against {
            Against::Obstacle(at) => self.obstacles[at].reach(from, to),
            Against::Particle(_) => 0.0,
        }
    }

    /// How far an obstacle has moved at a time, m, its velocity, m/s, and its acceleration, m/s²; 0 of particles.
    pub fn moved(&self, against: Against, t: f64) -> [[f64; 3]; 3] {
        match against {
            Against::Obstacle(at) => self.obstacles[at].moved(t),
            Against::Particle(_) => [[0.0; 3]; 3],
        }
    }

    /// The coefficients of a contact.
    pub fn surface(&self, against: Against) -> Surface {
        match (against, &self.among) {
            (Against::Obstacle(at), _) => self.obstacles[at].surface,
            (Against::Particle(_), Some(surface)) => *surface,
            (Against::Particle(_), None) => Surface {
                restitution: 0.0,
                friction: [0.0; 2],
            },
        }
    }

    /// A particle beside another, or an obstacle, at a state of all.
    pub fn beside(&self, particle: usize, against: Against, state: &State) -> Beside {
        let [place, velocity] = [&state.x, &state.v].map(|all| three(all, particle));
        let other = match against {
            Against::Obstacle(obstacle) => {
                return self.lone(obstacle, particle, state.t, place, velocity);
            }
            Against::Particle(other) => other,
        };
        let [there, along] = [&state.x, &state.v].map(|all| three(all, other));
        let away = minus(place, there);
        let apart = norm(away);
        // Two in one place part upwards.
        let normal = if apart > 0.0 {
            away.map(|c| c / apart)
        } else {
            [0.0, 0.0, 1.0]
        };
        let close = self.close(place).max(self.close(there));
        Beside {
            particle,
            against,
            gap: apart - (self.radii[particle] + self.radii[other]),
            normal,
            bend: Bend::Point(apart),
            velocity: minus(velocity, along),
            close,
            slow: close / self.step + SLOW * norm(velocity).max(norm(along)),
        }
    }

    /// A particle beside an obstacle, at its own position and velocity.
    fn lone(
        &self,
        obstacle: usize,
        particle: usize,
        t: f64,
        place: [f64; 3],
        velocity: [f64; 3],
    ) -> Beside {
        let one = &self.obstacles[obstacle];
        let [moved, along, _] = one.moved(t);
        let near = one.shape.nearest(minus(place, moved));
        let speed = norm(velocity).max(norm(along));
        let close = self.close(place);
        Beside {
            particle,
            against: Against::Obstacle(obstacle),
            gap: near.distance - self.radii[particle],
            normal: near.normal,
            bend: near.bend,
            velocity: minus(velocity, along),
            close,
            slow: close / self.step + SLOW * speed,
        }
    }

    /// How fast a gap would open, m/s², under accelerations of all.
    pub fn opening(&self, beside: &Beside, t: f64, a: &[f64]) -> f64 {
        let pushed = match beside.against {
            Against::Obstacle(at) => self.obstacles[at].moved(t)[2],
            Against::Particle(other) => three(a, other),
        };
        let turning = beside.bend.turning(beside.normal, beside.velocity);
        dot(beside.normal, minus(three(a, beside.particle), pushed)) - turning
    }

    /// What touches at a state, in ascending order of the particles, and of what each touches.
    pub fn touching(&self, near: &Near, state: &State) -> Vec<Beside> {
        let all = near.pairs();
        let beside = all.map(|(particle, against)| self.beside(particle, against, state));
        beside.filter(Beside::touches).collect()
    }

    /// A particle beside all that it touches at a state; of two particles the smaller is the first.
    pub fn touched(&self, near: &Near, particle: usize, state: &State) -> Vec<Beside> {
        let all = near.of(particle).iter().map(|against| match *against {
            Against::Particle(other) if other < particle => {
                self.beside(other, Against::Particle(particle), state)
            }
            against => self.beside(particle, against, state),
        });
        all.filter(Beside::touches).collect()
    }
}
