//! What contact leaves: how far particles are inside obstacles, and what touches at the end.

use crate::physics::constraints::Corrections;
use crate::physics::constraints::contact::{Against, Obstacles};
use crate::trajectory::Trajectory;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Contact with obstacles over the recorded instants.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
pub struct Contact {
    /// How deep a particle was inside an obstacle at most, m; 0 where none was.
    pub deepest_m: f64,
    /// That particle; null where none was inside.
    pub particle: Option<usize>,
    /// That obstacle, in the order of `colliders`; null where none was inside, or another particle.
    pub collider: Option<usize>,
    /// That other particle; null where it was an obstacle, or none.
    pub other: Option<usize>,
    /// When, s.
    pub t_s: f64,
    /// The number of particles that touch an obstacle at the end, to a billionth of the size of the scene, or are inside.
    pub touching: u64,
    /// Impacts, each time counted; null where nobody counts them.
    pub impacts: Option<u64>,
    /// Where the contact of a rapier world differs from the laws, in words, with this run's numbers; empty for others.
    #[serde(default)]
    pub differs: Vec<String>,
}

/// A gap is closed where it is less than this part of the scene's size.
const CLOSED: f64 = 1e-9;

impl Contact {
    /// Over a run of a scene of this size, m. None where nothing was recorded.
    pub fn of(
        obstacles: &Obstacles,
        size: f64,
        run: &Trajectory,
        done: Option<Corrections>,
    ) -> Option<Self> {
        let last = run.len().checked_sub(1)?;
        let mut contact = Self {
            deepest_m: 0.0,
            particle: None,
            collider: None,
            other: None,
            t_s: 0.0,
            touching: 0,
            impacts: done.map(|done| done.impacts),
            differs: Vec::new(),
        };
        for k in 0..=last {
            let (t, x) = (run.time(k), run.x(k));
            let mut touching: Vec<usize> = Vec::new();
            let at = |particle: usize| [0, 1, 2].map(|axis| x[3 * particle + axis]);
            // What touches to a billionth of the size is within a ball of that.
            let near = obstacles.near([t; 2], |particle| (at(particle), CLOSED * size));
            for (particle, against) in near.pairs() {
                let gap = obstacles.gap(particle, against, t, at);
                if -gap > contact.deepest_m.max(obstacles.close(at(particle))) {
                    (contact.deepest_m, contact.t_s) = (-gap, t);
                    contact.particle = Some(particle);
                    contact.collider = obstacles.collider(against);
                    contact.other = match against {
                        Against::Particle(other) => Some(other),
                        Against::Obstacle(_) => None,
                    };
                }
                if k == last && gap <= CLOSED * size + obstacles.close(at(particle)) {
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
