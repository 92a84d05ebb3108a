//! Static quantities of a state: what holds the fixed particles, and how much each spring pulls.

use crate::physics::constraints::Rods;
use crate::physics::{ParticleSystem, State, System};
use crate::scene::{Scene, Spring, Vectors};
use crate::trajectory::Trajectory;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Computes static quantities of states of one scene. They are no part of a state: each follows from it alone.
#[derive(Clone)]
pub struct Statics {
    /// The scene with nothing fixed, without rods, and nothing of what acts on free particles alone.
    held: ParticleSystem,
    /// The scene as it is, for the forces of its rods; None without any.
    on_rods: Option<ParticleSystem>,
    springs: Vec<Spring>,
    /// Ids of the fixed particles.
    fixed: Vec<usize>,
}

/// The largest loads of a run, over its recorded instants; null where they were not asked for. What a strain limit does is
/// in none of them.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Loads {
    /// The largest pull of a spring, N; null without springs.
    pub tension_max: Option<Tension>,
    /// The smallest, N: below 0 where a spring pushes.
    pub tension_min: Option<Tension>,
    /// What holds each fixed particle at the last finite instant. A strain limit acts by impulses between steps, which are
    /// left out: their sum over the run and over what is fixed is `strain.impulse_n_s`, and over the run's time it is the
    /// mean force with which the limit pulls there.
    pub reactions_final: Vec<Reaction>,
}

/// The tension of a spring at an instant.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Tension {
    /// N.
    pub tension_n: f64,
    /// Its place in the scene's list.
    pub spring: usize,
    /// s.
    pub t_s: f64,
}

/// The force that holds a fixed particle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Reaction {
    /// Its id.
    pub particle: usize,
    /// N.
    pub force_n: [f64; 3],
}

impl Statics {
    pub fn new(scene: &Scene) -> Self {
        let particles = scene.particles.iter().enumerate();
        let mut held = scene.clone();
        held.particles.iter_mut().for_each(|p| p.fixed = false);
        held.solver.gravity = 0.0;
        held.solver.gravities = Vectors::default();
        (held.wind, held.driven, held.rods) = (None, Vec::new(), Vec::new());
        Self {
            held: ParticleSystem::new(&held),
            on_rods: (!scene.rods.is_empty()).then(|| ParticleSystem::new(scene)),
            springs: scene.springs.clone(),
            fixed: particles
                .filter(|(_, p)| p.fixed)
                .map(|(id, _)| id)
                .collect(),
        }
    }

    /// The force that holds each fixed particle, N, 3 a particle; 0 for free ones.
    ///
    /// Minus the sum of all other forces on it (inverse dynamics); the impulses of a strain limit are no force of a state. A fixed particle has no weight here, and of a driven
    /// one m a is left out: in scenes its mass means nothing. Wind acts on what is free.
    pub fn reactions(&self, state: &State) -> Vec<f64> {
        let mut forces = vec![0.0; state.x.len()];
        let mut reactions = forces.clone();
        self.held.forces(state.t, &state.x, &state.v, &mut forces);
        if let Some(system) = &self.on_rods {
            system.add_rod_forces(state.t, &state.x, &state.v, &mut forces);
        }
        for id in &self.fixed {
            for at in 3 * id..3 * id + 3 {
                // Not -0.
                reactions[at] = 0.0 - forces[at];
            }
        }
        reactions
    }

    /// How much each spring pulls on its ends, N: above 0 it pulls, below it pushes.
    ///
    /// k (l - L) + q (l - L)³ + c v·n: its damper included, of an isotropic one the part along the spring. Ends in one
    /// place have no direction, and no tension.
    pub fn tensions(&self, state: &State) -> Vec<f64> {
        self.springs
            .iter()
            .map(|spring| tension(spring, state))
            .collect()
    }

    /// How much each rod pulls on its ends, N: its multiplier. NaN where that is not determined.
    pub fn rod_tensions(&self, state: &State) -> Vec<f64> {
        let Some(system) = &self.on_rods else {
            return Vec::new();
        };
        let found = system.rod_tensions(state.t, &state.x, &state.v);
        let rods = system.rods().map_or(0, Rods::len);
        found.unwrap_or_else(|_| vec![f64::NAN; rods])
    }

    /// The largest loads of a run; None without instants, and where velocities are not known, on which dampers depend.
    pub fn loads(&self, run: &Trajectory) -> Option<Loads> {
        if run.is_empty() || !run.has_velocities() {
            return None;
        }
        let mut loads = Loads::default();
        let mut last = None;
        for k in 0..run.len() {
            let mut state = State::new(run.x(k).to_vec(), run.v(k).to_vec());
            state.t = run.time(k);
            if !state.is_finite() {
                continue;
            }
            for (spring, tension_n) in self.tensions(&state).into_iter().enumerate() {
                let t_s = state.t;
                let now = Tension {
                    tension_n,
                    spring,
                    t_s,
                };
                let more = |than: &Tension| tension_n > than.tension_n;
                let less = |than: &Tension| tension_n < than.tension_n;
                if tension_n.is_finite() && loads.tension_max.as_ref().is_none_or(more) {
                    loads.tension_max = Some(now);
                }
                if tension_n.is_finite() && loads.tension_min.as_ref().is_none_or(less) {
                    loads.tension_min = Some(now);
                }
            }
            last = Some(state);
        }
        if let Some(state) = last {
            let reactions = self.reactions(&state);
            let of = |&particle: &usize| Reaction {
                particle,
                force_n: [0, 1, 2].map(|axis| reactions[3 * particle + axis]),
            };
            let finite = |reaction: &Reaction| reaction.force_n.iter().all(|f| f.is_finite());
            loads.reactions_final = self.fixed.iter().map(of).filter(finite).collect();
        }
        Some(loads)
    }
}

fn tension(spring: &Spring, State { x, v, .. }: &State) -> f64 {
    let [i, j] = spring.ends.map(|end| 3 * end);
    let along = |of: &[f64]| [0, 1, 2].map(|axis| of[j + axis] - of[i + axis]);
    let (d, u) = (along(x), along(v));
    let length = d[0].hypot(d[1]).hypot(d[2]);
    if length == 0.0 {
        return 0.0;
    }
    let parting: f64 = d.iter().zip(u).map(|(d, u)| d / length * u).sum();
    let stretch = length - spring.rest_length;
    spring.stiffness * stretch
        + spring.cubic * stretch * stretch * stretch
        + spring.damping * parting
}
