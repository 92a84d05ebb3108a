//! The common mistakes, a row each: wrong forms of methods that replay names, and nothing runs.
//!
//! Some mistakes are methods of their own and have no row here: explicit Euler that drifts with the
//! new velocity is `symplectic_euler`, one that kicks at the position already moved is
//! `symplectic_euler_drift_first`, leapfrog without its first half kick is `symplectic_euler`, and
//! two half steps of explicit Euler taken for midpoint are `explicit_euler` in two substeps.

mod maps;
mod physics;
mod rows;

pub use rows::MISTAKES;

use super::{Candidate, Map};
use crate::integrators::{self, Method};
use crate::physics::{ParticleSystem, System};
use crate::scene::Scene;

/// A common mistake.
pub struct Mistake {
    /// As reports name it, alone or as `id(method)`.
    pub id: &'static str,
    /// What is wrong and what to change, for the program's author.
    pub says: &'static str,
    pub wrong: Wrong,
}

/// What a mistake alters.
pub enum Wrong {
    /// The step itself.
    Step {
        /// Registry id of the method it was meant to be.
        meant: &'static str,
        map: Map,
        /// Whether it uses the state one step before.
        remembers: bool,
        /// Whether without damping it is the method it was meant to be.
        only_damped: bool,
    },
    /// The forces or masses, in any method. None where the scene gives it nothing to get wrong.
    Physics(fn(&Scene) -> Option<ParticleSystem>),
    /// The length of the step, in any method: this many h.
    Length(f64),
}

/// The mistakes that can be made in this scene: wrong steps once, wrong physics and lengths with
/// every method, as `mistake(method)`. `system` is the scene's own.
pub fn mistakes(scene: &Scene, system: &ParticleSystem) -> Vec<Candidate> {
    let mut candidates = Vec::new();
    let mut with_every_method = |build: &dyn Fn(&'static Method) -> Candidate| {
        candidates.extend(integrators::fixed().iter().map(build));
    };
    for mistake in MISTAKES {
        let (id, says) = (mistake.id, mistake.says);
        match mistake.wrong {
            Wrong::Step { .. } => {}
            Wrong::Physics(build) => {
                if let Some(wrong) = build(scene) {
                    with_every_method(&|method| Candidate::altered(&wrong, method, id, says));
                }
            }
            Wrong::Length(factor) => with_every_method(&|method| {
                Candidate::altered(system, method, id, says).stretched(factor)
            }),
        }
    }
    let steps = MISTAKES.iter().filter_map(|m| m.as_step(system));
    steps.chain(candidates).collect()
}

impl Mistake {
    /// The candidate of a wrong step, where it differs from the method it was meant to be.
    pub(super) fn as_step(&self, system: &ParticleSystem) -> Option<Candidate> {
        match self.wrong {
            Wrong::Step {
                meant,
                map,
                remembers,
                only_damped,
            } if system.kinds().depends_on_velocity() || !only_damped => {
                let candidate = Candidate::map(system, self.id, meant, self.says, map);
                Some(candidate.remembering(remembers))
            }
            _ => None,
        }
    }
}
