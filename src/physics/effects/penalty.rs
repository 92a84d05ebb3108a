//! Contact by penalty: a spring and a damper while a particle is inside an obstacle, or another particle.

use super::{Effect, EffectRow, FEW_OPERATIONS, boxed, dot};
use crate::physics::constraints::contact::{Against, Beside, Obstacles};
use crate::physics::{Derivative, ForceKinds, Jacobian, Linearization, Power, State};
use crate::scene::Scene;
use crate::shape::Bend;
use nalgebra::{Matrix3, Vector3};

pub(super) const ROW: EffectRow = EffectRow {
    id: "penalty",
    summary: "a spring and a damper at every contact, while a particle is inside an obstacle or another particle",
    source: "N = k d + c d' along the normal, d the depth, from d = 0 until d = 0 again; U = k d² / 2 (Kelvin, Voigt)",
    elastic: true,
    constant: false,
    build: |scene| Penalty::new(scene).map(boxed),
};

/// The law of one contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PenaltyLaw {
    /// k, N/m.
    pub stiffness: f64,
    /// c, N s/m.
    pub damping: f64,
    /// Whether N may be negative, as it is just before two part.
    pub pulls: bool,
    /// Whether there is sliding friction, µ N.
    pub rubs: bool,
}

/// A contact, and how often its force is added: 1, or -1 where it is taken away.
pub type Press = (Beside, f64);

/// The force of all contacts in which something is inside.
pub struct Penalty {
    obstacles: Obstacles,
    law: PenaltyLaw,
}

impl PenaltyLaw {
    /// The law of a scene: it may pull, and has no friction.
    pub const fn new([stiffness, damping]: [f64; 2]) -> Self {
        Self {
            stiffness,
            damping,
            pulls: true,
            rubs: false,
        }
    }

    /// N at a contact, N.
    fn normal_force(&self, beside: &Beside) -> f64 {
        let force = -self.stiffness * beside.gap - self.damping * beside.parting();
        if self.pulls { force } else { force.max(0.0) }
    }

    /// The force on the first of the two, N.
    fn force(&self, obstacles: &Obstacles, beside: &Beside) -> [f64; 3] {
        let normal = self.normal_force(beside);
        let mut force = beside.normal.map(|n| normal * n);
        if self.rubs {
            let sliding = beside.sliding();
            let fast = dot(sliding, sliding).sqrt();
            let rubbed = obstacles.surface(beside.against).friction[0] * normal;
            if fast > 0.0 {
                force = [0, 1, 2].map(|axis| force[axis] - rubbed * sliding[axis] / fast);
            }
        }
        force
    }

    /// *Adds* the forces of contacts, N; returns their powers, W.
    pub fn add_force(
        &self,
        obstacles: &Obstacles,
        t: f64,
        contacts: &[Press],
        f: &mut [f64],
    ) -> Power {
        let mut power = Power::default();
        for (beside, times) in contacts {
            let force = self.force(obstacles, beside);
            add(beside, *times, force, f);
            // F·v = F·u + F·w, with u relative to the other and w the velocity of that; the spring's part of F·u is -dU/dt.
            let spring = -self.stiffness * beside.gap * beside.parting();
            power.dissipated += times * (spring - dot(force, beside.velocity));
            let pushed = obstacles.moved(beside.against, t)[1];
            power.injected += times * dot(force, pushed);
        }
        power
    }

    /// *Adds* the forces of the dampers alone, N.
    pub fn add_damping(&self, contacts: &[Press], f: &mut [f64]) {
        for (beside, times) in contacts {
            let force = -self.damping * beside.parting();
            add(beside, *times, beside.normal.map(|n| force * n), f);
        }
    }

    /// k d²/2 of contacts, J.
    pub fn potential(&self, contacts: &[Press]) -> f64 {
        let one = |(beside, times): &Press| 0.5 * times * self.stiffness * beside.gap * beside.gap;
        contacts.iter().map(one).sum()
    }

    /// *Adds* the slopes of contacts that pull and do not rub.
    pub fn add_jacobian(
        &self,
        contacts: &[Press],
        linearization: Linearization,
        out: &mut Jacobian,
    ) {
        for (beside, times) in contacts {
            let n = Vector3::from(beside.normal);
            let axial = n * n.transpose();
            let mut position = axial * -self.stiffness;
            if linearization != Linearization::Material {
                let turns = turns(beside);
                let normal = self.normal_force(beside);
                let definite = linearization == Linearization::Definite;
                position += turns * if definite { normal.min(0.0) } else { normal };
                if !definite {
                    let sliding = turns * Vector3::from(beside.velocity);
                    position -= n * sliding.transpose() * self.damping;
                }
            }
            let slopes = [
                (Derivative::Position, position),
                (Derivative::Velocity, axial * -self.damping),
            ];
            for (by, slope) in slopes {
                if by == Derivative::Velocity && self.damping == 0.0 {
                    continue;
                }
                let one = beside.particle;
                match beside.against {
                    Against::Obstacle(_) => out.add_block(by, [one, one], &(slope * *times)),
                    Against::Particle(other) => out.add_pair(by, [one, other], slope * -*times),
                }
            }
        }
    }
}

/// How the normal turns with the place, 1/m: symmetric.
fn turns(beside: &Beside) -> Matrix3<f64> {
    let n = Vector3::from(beside.normal);
    let across = Matrix3::identity() - n * n.transpose();
    match beside.bend {
        Bend::Point(radius) if radius > 0.0 => across / radius,
        Bend::Line(along, radius) if radius > 0.0 => {
            let along = Vector3::from(along);
            (across - along * along.transpose()) / radius
        }
        _ => Matrix3::zeros(),
    }
}

/// *Adds* a force to the first of the two, and against it to another particle.
fn add(beside: &Beside, times: f64, force: [f64; 3], f: &mut [f64]) {
    for axis in 0..3 {
        f[3 * beside.particle + axis] += times * force[axis];
        if let Against::Particle(other) = beside.against {
            f[3 * other + axis] -= times * force[axis];
        }
    }
}

impl Penalty {
    /// None where nothing collides, or by impulses.
    pub fn new(scene: &Scene) -> Option<Self> {
        let obstacles = Obstacles::new(scene)?;
        let law = PenaltyLaw::new(obstacles.penalty()?);
        Some(Self { obstacles, law })
    }

    /// Another law, with these obstacles.
    pub fn with(obstacles: Obstacles, law: PenaltyLaw) -> Self {
        Self { obstacles, law }
    }

    /// All contacts in which something is inside.
    fn inside(&self, t: f64, x: &[f64], v: &[f64]) -> Vec<Press> {
        let mut state = State::new(x.to_vec(), v.to_vec());
        state.t = t;
        let inside = self.obstacles.inside(&state).into_iter();
        inside.map(|beside| (beside, 1.0)).collect()
    }

    /// Whether its force is linear in the velocity, wherever obstacles are.
    fn is_linear(&self) -> bool {
        let mut surfaces = self.obstacles.surfaces();
        let rubs = self.law.rubs && surfaces.any(|one| one.friction[0] > 0.0);
        let clipped = self.law.damping != 0.0 && !self.law.pulls;
        !clipped && !self.obstacles.any_moves() && !rubs
    }
}

impl Effect for Penalty {
    fn members(&self) -> usize {
        self.obstacles.particles().count()
    }

    /// Of what moves: its work depends on the place, which only powers at a state say.
    fn kinds(&self) -> ForceKinds {
        if self.is_linear() {
            ForceKinds::of_damper(self.law.damping)
        } else {
            ForceKinds::NON_LINEAR
        }
    }

    fn add_force(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) -> Power {
        let inside = self.inside(t, x, v);
        self.law.add_force(&self.obstacles, t, &inside, f)
    }

    fn add_rounding(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        for (beside, _) in self.inside(t, x, v) {
            let most = |all: &[f64]| {
                let ends = beside.against.with(beside.particle).into_iter();
                let own = ends.flat_map(|end| all[3 * end..3 * end + 3].iter());
                own.fold(0.0_f64, |most, c| most.max(c.abs()))
            };
            let moved = obstacle_moved(&self.obstacles, &beside, t);
            // A depth is a difference of coordinates, and so is a normal where the surface bends.
            let far = most(x) + moved;
            let turned = match beside.bend {
                Bend::Flat => 0.0,
                Bend::Line(_, radius) | Bend::Point(radius) => {
                    (FEW_OPERATIONS * far / radius).min(1.0)
                }
            };
            let force = self.law.normal_force(&beside).abs();
            let rounded = self.law.stiffness.abs() * far + self.law.damping.abs() * most(v) + force;
            let speed = dot(beside.velocity, beside.velocity).sqrt();
            let off = FEW_OPERATIONS * rounded + turned * (force + self.law.damping.abs() * speed);
            for end in beside.against.with(beside.particle) {
                f[3 * end..3 * end + 3].iter_mut().for_each(|f| *f += off);
            }
        }
    }

    fn potential(&self, t: f64, x: &[f64]) -> f64 {
        self.law.potential(&self.inside(t, x, &vec![0.0; x.len()]))
    }

    fn add_damping(&self, x: &[f64], w: &[f64], f: &mut [f64]) {
        // Where obstacles move nobody asks for it.
        self.law.add_damping(&self.inside(0.0, x, w), f);
    }

    fn add_jacobian(
        &self,
        t: f64,
        x: &[f64],
        v: &[f64],
        linearization: Linearization,
        out: &mut Jacobian,
    ) {
        self.law
            .add_jacobian(&self.inside(t, x, v), linearization, out);
    }
}

/// How far the other has moved, m, at most along an axis.
fn obstacle_moved(obstacles: &Obstacles, beside: &Beside, t: f64) -> f64 {
    let moved = obstacles.moved(beside.against, t)[0];
    moved.iter().fold(0.0, |most, c| most.max(c.abs()))
}
