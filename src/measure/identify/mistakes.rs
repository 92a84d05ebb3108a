//! The common mistakes, a row each: wrong forms of methods that replay names, and nothing runs.
//!
//! Some mistakes are methods of their own and have no row here: explicit Euler that drifts with the
//! new velocity is `symplectic_euler`, one that kicks at the position already moved is
//! `symplectic_euler_drift_first`, leapfrog without its first half kick is `symplectic_euler`, and
//! two half steps of explicit Euler taken for midpoint are `explicit_euler` in two substeps.

mod physics;
mod rows;
mod springs;

pub use rows::MISTAKES;

use super::altered::Around;
use super::candidate::{Candidate, Forces};
use super::channels;
use super::keeping::Kept;
use super::rods;
use super::step::Step;
use super::treated::treated;
use crate::physics::ParticleSystem;
use crate::scene::Scene;
use std::sync::Arc;

/// A common mistake.
pub struct Mistake {
    /// As reports name it, alone or as `id(method)`.
    pub id: &'static str,
    /// What is wrong and what to change, for the program's author.
    pub says: &'static str,
    pub wrong: Wrong,
    /// The parts of the scene that it changes, as deviations name them, and their factors.
    pub deviates: &'static [(&'static str, f64)],
}

/// What a mistake alters.
pub enum Wrong {
    /// The step itself.
    Step {
        /// Registry id of the method it was meant to be.
        meant: &'static str,
        step: Step,
        /// How it is applied, where not to all particles at once.
        around: Option<Around>,
    },
    /// Numbers of the scene, in any method, as the row's deviations say.
    Scaled,
    /// The forces or masses, in any method. None where the scene gives it nothing to get wrong.
    Physics(fn(&Scene) -> Option<ParticleSystem>),
    /// The length of the step, in any method: this many h.
    Length(f64),
    /// How any method is applied, where particles are driven.
    Applied(Around),
    /// How rods are kept, with any method.
    Rods(Kept),
    /// Springs in place of rods, with any method that solves nothing; the rows tell their stiffness.
    SpringsForRods,
}

/// The mistakes that can be made in this scene: wrong steps once, wrong physics and lengths with
/// every method, as `mistake(method)`. `system` is the scene's own.
pub fn mistakes(scene: &Scene, system: &ParticleSystem) -> Vec<Candidate> {
    let steps = MISTAKES.iter().filter_map(|m| m.as_step(system));
    let mut candidates: Vec<Candidate> = steps.collect();
    for mistake in MISTAKES {
        if let Wrong::Rods(kept) = mistake.wrong {
            let kept = rods::kept(system, kept, mistake.id, mistake.says);
            candidates.extend(kept.into_iter().map(Candidate::mistaken));
        }
        let (length, around) = match mistake.wrong {
            Wrong::Length(factor) => (factor, None),
            Wrong::Applied(around) => (1.0, Some(around)),
            _ => (1.0, None),
        };
        let Some(wrong) = mistake.forces(scene) else {
            continue;
        };
        let methods = Candidate::plain(&wrong, 1)
            .chain(treated(&wrong))
            .chain(rods::restabilised(scene, &wrong, 1));
        // A step of one force has no other times.
        let methods = methods.filter(|candidate| around.is_none() || candidate.has_stages());
        candidates.extend(methods.map(|candidate| {
            let id = format!("{}({})", mistake.id, candidate.id);
            let candidate = candidate.stretched(length).around(around);
            candidate.named(id, mistake.says).mistaken()
        }));
    }
    candidates
}

/// The row of a mistake that a candidate's id names, alone or as `mistake(method)`.
pub fn mistake(id: &str) -> Option<&'static Mistake> {
    let name = id.split('(').next().unwrap_or(id);
    MISTAKES.iter().find(|mistake| mistake.id == name)
}

impl Mistake {
    /// The forces that it computes, in any method; None where the scene gives it nothing to get wrong, and for a
    /// step that is wrong itself.
    pub(super) fn forces(&self, scene: &Scene) -> Option<ParticleSystem> {
        match self.wrong {
            Wrong::Step { .. } | Wrong::Rods(_) | Wrong::SpringsForRods => None,
            Wrong::Scaled => {
                channels::scaled(scene, self.deviates).map(|s| ParticleSystem::new(&s))
            }
            Wrong::Physics(build) => build(scene),
            Wrong::Length(_) => Some(ParticleSystem::new(scene)),
            Wrong::Applied(_) => (!scene.driven.is_empty()).then(|| ParticleSystem::new(scene)),
        }
    }

    /// The candidate of a wrong step, where it differs from the method it was meant to be.
    pub(super) fn as_step(&self, system: &ParticleSystem) -> Option<Candidate> {
        match self.wrong {
            Wrong::Step {
                meant,
                step,
                around,
            } => {
                let forces: Forces = Arc::new(system.clone());
                let candidate = Candidate::new(&forces, step, meant).around(around);
                Some(candidate.named(self.id, self.says).mistaken())
            }
            _ => None,
        }
    }
}
