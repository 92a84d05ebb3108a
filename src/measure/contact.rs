//! What contact leaves: how far particles are inside obstacles and each other, what touches at the end, and the laws.

use super::Laws;
use crate::physics::constraints::Corrections;
use crate::physics::constraints::contact::Against;
use crate::physics::{ParticleSystem, System};
use crate::trajectory::Trajectory;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Contact with obstacles over the recorded instants.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
pub struct Contact {
    /// How deep a particle was inside an obstacle, or another particle, at most, m; 0 where none was deeper than a billionth
    /// of the size of the scene, which is touching.
    pub deepest_m: f64,
    /// That particle; null where none was inside.
    pub particle: Option<usize>,
    /// That obstacle, in the order of `colliders`; null where none was inside, or another particle.
    pub collider: Option<usize>,
    /// That other particle; null where it was an obstacle, or none.
    pub other: Option<usize>,
    /// What that is, as `collider 0 (plane)` or `particle 1`; null where none was inside.
    #[serde(default)]
    pub inside: Option<String>,
    /// When, s.
    pub t_s: f64,
    /// The number of particles that touch something at the end, to a billionth of the size of the scene, or are inside.
    pub touching: u64,
    /// Impacts, each time counted; null where nobody counts them.
    pub impacts: Option<u64>,
    /// How far it is off each law.
    #[serde(flatten)]
    pub laws: Laws,
    /// Where the contact of a rapier world differs from the laws, in words, with this run's numbers; empty for others.
    #[serde(default)]
    pub differs: Vec<String>,
}

impl Contact {
    /// Over a run. None where nothing was recorded, or nothing collides.
    pub fn of(
        system: &ParticleSystem,
        run: &Trajectory,
        done: Option<Corrections>,
    ) -> Option<Self> {
        let obstacles = system.obstacles()?;
        let last = run.len().checked_sub(1)?;
        let closed = obstacles.closed();
        let mut contact = Self {
            deepest_m: 0.0,
            particle: None,
            collider: None,
            other: None,
            inside: None,
            t_s: 0.0,
            touching: 0,
            impacts: done.map(|done| done.impacts),
            laws: Laws::of(system, run),
            differs: Vec::new(),
        };
        for k in 0..=last {
            let (t, x) = (run.time(k), run.x(k));
            let mut touching: Vec<usize> = Vec::new();
            let at = |particle: usize| [0, 1, 2].map(|axis| x[3 * particle + axis]);
            let near = obstacles.near([t; 2], |particle| (at(particle), closed));
            for (particle, against) in near.pairs() {
                let gap = obstacles.gap(particle, against, t, at);
                if -gap
                    > contact
                        .deepest_m
                        .max(closed + obstacles.close(at(particle)))
                {
                    (contact.deepest_m, contact.t_s) = (-gap, t);
                    contact.particle = Some(particle);
                    contact.collider = obstacles.collider(against);
                    contact.other = match against {
                        Against::Particle(other) => Some(other),
                        Against::Obstacle(_) => None,
                    };
                    contact.inside = Some(obstacles.name(against));
                }
                if k == last && gap <= closed + obstacles.close(at(particle)) {
                    touching.push(particle);
                    if let Against::Particle(other) = against {
                        touching.push(other);
                    }
                }
            }
            touching.sort_unstable();
            touching.dedup();
            contact.touching = touching.len() as u64;
        }
        Some(contact)
    }
}
