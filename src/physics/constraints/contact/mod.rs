//! Contact of particles with obstacles: where they are, what an impact does ([`strike`](Obstacles::strike)), and the
//! motion of particles that stay on them ([`Held`]). When impacts happen is the loop's business, not the forces'.

mod held;
mod impact;
mod member;

pub use held::{Change, Held};
pub use impact::{Hit, ImpactLaw};

use super::ConstraintRow;
use crate::physics::State;
use crate::scene::{Collider, Drive, Scene};
use crate::shape::{Bend, Nearest, Shape};

pub(super) const ROW: ConstraintRow = ConstraintRow {
    id: "colliders",
    summary: "keep particles outside of obstacles, by impulses where they meet and forces where they stay",
    source: "v_n' = -e v_n, and min(µ (1 + e) |v_n|, |v_t|) off the sliding velocity (Newton, Coulomb); N ≥ 0 where the gap is \
             closed, sliding against µ N, sticking up to µ_s N (Signorini; Moreau 1988)",
};

/// Gaps within this part of the scene's size are contact: the end of a step that was cut is no nearer.
const TOUCHING: f64 = 1e-13;
/// A bounce of less than this part of the scene's size is the last of a row.
const LOWEST: f64 = 1e-11;
/// Normal velocities within this part of the speed are none.
const SLOW: f64 = 1e-10;
/// Nor is a gap right to more than this part of the coordinates it comes from.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The obstacles of a scene, and what collides with them.
#[derive(Debug, Clone)]
pub struct Obstacles {
    obstacles: Vec<Obstacle>,
    law: ImpactLaw,
    /// Of each particle, m.
    radii: Vec<f64>,
    /// Of each particle, 1/kg; 0 where it is fixed, and does not collide.
    weights: Vec<f64>,
    /// Gaps within this are contact, m, but for the rounding of coordinates.
    close: f64,
    /// What would rise by less, m, stays.
    lowest: f64,
}

/// One obstacle.
#[derive(Debug, Clone)]
pub struct Obstacle {
    /// Its index among the scene's colliders; a mesh is as many obstacles as it has triangles.
    collider: usize,
    shape: Shape,
    motion: Option<Drive>,
    /// e.
    restitution: f64,
    /// µ of what slides, and of what sticks.
    friction: [f64; 2],
}

/// A particle beside an obstacle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beside {
    pub particle: usize,
    pub obstacle: usize,
    /// The gap between the two, m; negative inside.
    pub gap: f64,
    /// From the obstacle to the particle, a unit vector.
    pub normal: [f64; 3],
    /// How surfaces at this gap bend.
    pub bend: Bend,
    /// Relative to the obstacle, m/s.
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
            restitution: collider.restitution,
            friction: [collider.friction, collider.static_friction],
        })
    }

    /// How far it has moved, m, its velocity, m/s, and its acceleration, m/s².
    fn moved(&self, t: f64) -> [[f64; 3]; 3] {
        self.motion
            .as_ref()
            .map_or([[0.0; 3]; 3], |motion| motion.at(t))
    }

    fn nearest(&self, t: f64, x: [f64; 3]) -> Nearest {
        let moved = self.moved(t)[0];
        self.shape.nearest(minus(x, moved))
    }
}

impl Obstacles {
    /// None where the scene has none.
    pub fn new(scene: &Scene) -> Option<Self> {
        let obstacles = scene.colliders.iter().enumerate();
        let obstacles: Vec<_> = obstacles.flat_map(Obstacle::new).collect();
        let weight = |p: &crate::scene::Particle| if p.fixed { 0.0 } else { 1.0 / p.mass };
        if obstacles.is_empty() {
            return None;
        }
        let mut all = Self {
            obstacles,
            law: ImpactLaw::RIGHT,
            radii: scene.particles.iter().map(|p| p.radius).collect(),
            weights: scene.particles.iter().map(weight).collect(),
            close: 0.0,
            lowest: 0.0,
        };
        let size = all.size(scene);
        (all.close, all.lowest) = (TOUCHING * size, LOWEST * size);
        Some(all)
    }

    /// How large the scene is, m: the box around the particles, the largest of them, and how far they are from obstacles;
    /// at least the way of the fastest in a step.
    fn size(&self, scene: &Scene) -> f64 {
        let starts = scene.starts();
        let mut size = scene.size() + self.radii.iter().fold(0.0, |most, r| r.max(most));
        for (particle, obstacle) in self.pairs() {
            size = size.max(self.gap(particle, obstacle, 0.0, starts[particle]));
        }
        let fastest = scene.particles.iter().map(|p| norm(p.velocity));
        let h = scene.solver.timestep;
        size.max(h * (fastest.fold(0.0, f64::max) + h * norm(scene.gravity())))
    }

    /// The same with another law of impacts.
    pub fn struck_by(&self, law: ImpactLaw) -> Self {
        Self {
            law,
            ..self.clone()
        }
    }

    /// The restitution e and the friction µ of an obstacle.
    pub fn coefficients(&self, obstacle: usize) -> [f64; 2] {
        let one = &self.obstacles[obstacle];
        [one.restitution, one.friction[0]]
    }

    /// Every particle that collides, with every obstacle.
    pub fn pairs(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let each = |obstacle| self.particles().map(move |particle| (particle, obstacle));
        (0..self.len()).flat_map(each)
    }

    /// The number of obstacles.
    pub fn len(&self) -> usize {
        self.obstacles.len()
    }

    /// Never: without obstacles there is no such thing.
    pub fn is_empty(&self) -> bool {
        self.obstacles.is_empty()
    }

    /// Whether one of them moves.
    pub fn any_moves(&self) -> bool {
        self.obstacles.iter().any(|one| one.motion.is_some())
    }

    /// The particles that collide.
    pub fn particles(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.weights.len()).filter(|particle| self.weights[*particle] > 0.0)
    }

    /// The gap between a particle at `x`, m, and an obstacle.
    pub fn gap(&self, particle: usize, obstacle: usize, t: f64, x: [f64; 3]) -> f64 {
        self.obstacles[obstacle].nearest(t, x).distance - self.radii[particle]
    }

    /// What would rise by less than this, m, stays.
    pub fn lowest(&self) -> f64 {
        self.lowest
    }

    /// Whether surfaces bend on which a particle may slide.
    pub fn bend(&self) -> bool {
        let flat = |one: &Obstacle| matches!(one.shape, Shape::Plane { .. });
        !self.obstacles.iter().all(flat)
    }

    /// Which of the scene's colliders an obstacle is, or is part of.
    pub fn collider(&self, obstacle: usize) -> usize {
        self.obstacles[obstacle].collider
    }

    /// A gap within this, m, is contact at `x`, m.
    pub fn close(&self, x: [f64; 3]) -> f64 {
        self.close + ROUNDING * x.iter().fold(0.0, |most: f64, c| most.max(c.abs()))
    }

    /// How far an obstacle moves between two times, m, at most.
    pub fn reach(&self, obstacle: usize, from: f64, to: f64) -> f64 {
        let Some(motion) = &self.obstacles[obstacle].motion else {
            return 0.0;
        };
        motion.speed_bound(to) * (to - from)
    }

    /// A particle beside an obstacle at a state of all.
    pub fn beside(&self, particle: usize, obstacle: usize, state: &State) -> Beside {
        let [place, velocity] = [&state.x, &state.v].map(|all| three(all, particle));
        self.lone(obstacle, particle, state.t, place, velocity)
    }

    /// The same at its own position and velocity.
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
        Beside {
            particle,
            obstacle,
            gap: near.distance - self.radii[particle],
            normal: near.normal,
            bend: near.bend,
            velocity: minus(velocity, along),
            close: self.close(place),
            slow: SLOW * speed,
        }
    }

    /// How fast a gap would open, m/s², under accelerations of all.
    pub fn opening(&self, beside: &Beside, t: f64, a: &[f64]) -> f64 {
        let pushed = self.obstacles[beside.obstacle].moved(t)[2];
        let turning = beside.bend.turning(beside.normal, beside.velocity);
        dot(beside.normal, minus(three(a, beside.particle), pushed)) - turning
    }

    /// What touches at a state.
    pub fn touching(&self, state: &State) -> Vec<Beside> {
        let touch = |(particle, obstacle): &(usize, usize)| {
            let x = three(&state.x, *particle);
            self.gap(*particle, *obstacle, state.t, x) <= self.close(x)
        };
        let touching = self.pairs().filter(touch);
        let mut found: Vec<Beside> = touching
            .map(|(particle, obstacle)| self.beside(particle, obstacle, state))
            .collect();
        found.sort_by_key(|beside| (beside.particle, beside.obstacle));
        found
    }
}

fn three(all: &[f64], particle: usize) -> [f64; 3] {
    [0, 1, 2].map(|axis| all[3 * particle + axis])
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}
