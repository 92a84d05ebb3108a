//! Programs of somebody else's: each computes a whole trajectory by itself and leaves it as rows.
//!
//! ```text
//! Command (words with placeholders) + Task -> the program runs -> Rows, or a Failure
//! ```
//! Such a program takes no single steps, so it is not an [`Engine`](super::Engine) but a [`Program`]:
//! asked once, it answers with everything. What is here is pure. Whoever calls the library starts
//! the process; the command line does so in `src/cli/external`, the only place that may.

mod command;
mod failure;
mod flat;

pub use command::{Command, CommandError, Placeholder};
pub use failure::Failure;
pub use flat::Flat;

use crate::physics::ParticleSystem;
use crate::scene::Scene;
use crate::trajectory::Rows;

/// What a program is asked for: the scene from its start to `steps` timesteps.
#[derive(Clone, Copy)]
pub struct Task<'a> {
    /// With the duration that flags may have changed.
    pub scene: &'a Scene,
    /// What the scene makes of its particles: which effects are in force.
    pub system: &'a ParticleSystem,
    /// Seconds a step, which need not be the scene's own.
    pub timestep: f64,
    /// Steps that cover the duration.
    pub steps: u64,
}

/// Something that computes whole trajectories.
pub trait Program: Send + Sync {
    /// Runs from the scene's start to the end of the task, or as far as it gets.
    ///
    /// Rows may be any whole number of steps apart. What is after the task's last step is ignored.
    ///
    /// # Errors
    /// Whatever keeps rows from being known; it becomes the outcome.
    fn record(&self, task: &Task) -> Result<Recording, Failure>;
}

/// What a program left.
#[derive(Debug, Clone)]
pub struct Recording {
    pub rows: Rows,
    /// Wall time of the whole program, s: starting, reading and writing included. None of a file,
    /// which does not say.
    pub seconds: Option<f64>,
}
