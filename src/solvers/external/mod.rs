//! Programs of somebody else's: each computes a whole trajectory by itself and leaves it as rows.
//!
//! ```text
//! Command (words with placeholders) + Task -> the program runs -> Rows, or a Failure
//! ```
//! Such a program takes no single steps, so it is not an [`Engine`](super::Engine) but a [`Program`]:
//! asked once, it answers with everything. What is here is pure. Whoever calls the library starts
//! the process; the command line does so in `verbs::cli`, the only place that may.

mod command;
mod flat;

pub use command::{Command, CommandError, Placeholder};
pub use flat::Flat;

use crate::physics::ParticleSystem;
use crate::scene::Scene;
use crate::trajectory::{ReadError, Rows};
use std::time::Duration;

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

/// What went wrong with a program. An outcome, not a fault of the run: every message says what was
/// expected and what to do.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    #[error(
        "there is no program `{program}` (or its first line names an interpreter that is not \
         there): state its path, or put its folder on PATH"
    )]
    NotFound { program: String },
    #[error("`{program}` could not be started: {cause}")]
    NotStarted {
        program: String,
        cause: std::io::Error,
    },
    #[error(
        "it had not ended after {after:?} and was stopped: give it longer with --external-timeout, \
         or less to do with --duration"
    )]
    TimedOut { after: Duration },
    #[error(
        "it ended with exit code {code}, expected 0: what it wrote to stderr is shown as it came"
    )]
    Exited { code: i32 },
    #[error("it was ended by signal {signal}, expected exit code 0")]
    Signalled { signal: i32 },
    #[error(
        "it gave more than {} MiB: keep fewer instants, every tenth step for example",
        limit >> 20
    )]
    TooMuch { limit: usize },
    #[error(
        "it printed nothing: expected rows `t,id,x,y,z[,vx,vy,vz]` on stdout, or {{output}} in its \
         command and a file written there"
    )]
    Silent,
    #[error("it ended well but wrote no file to {{output}}: expected an .npz with t, x and v")]
    NoFile,
    #[error("what it gave is no trajectory of this scene: {}", line(.0))]
    Unreadable(#[from] ReadError),
    /// Something around the program: its pipes, the files handed to it.
    #[error("could not {doing}: {cause}")]
    Io {
        doing: &'static str,
        cause: std::io::Error,
    },
}

impl Failure {
    /// For `map_err`.
    pub fn io(doing: &'static str) -> impl Fn(std::io::Error) -> Self {
        move |cause| Self::Io { doing, cause }
    }
}

/// The error with its help on one line.
fn line(error: &ReadError) -> String {
    error.to_string().replace("\nhelp: ", "; ")
}
