//! External programs. Each computes a whole trajectory by itself and writes it as rows.
//!
//! ```text
//! Command (words with placeholders) + Task -> the program runs -> Rows, or a Failure
//! ```
//! Such a program takes no single steps, so it is not an [`Engine`](super::Engine) but a [`Program`]: one call
//! returns everything. This module is pure. The caller of the library starts the process; the command line
//! does so in `verbs::cli`, the only place that may.

mod command;
mod flat;

pub use command::{Command, CommandError, Placeholder};
pub use flat::Flat;

use crate::physics::ParticleSystem;
use crate::scene::Scene;
use crate::trajectory::{ReadError, Rows};
use std::time::Duration;

/// The task of a program: the scene from its start over `steps` timesteps.
#[derive(Clone, Copy)]
pub struct Task<'a> {
    /// The scene, with the duration that flags may have changed.
    pub scene: &'a Scene,
    /// The scene's system, which says which effects act.
    pub system: &'a ParticleSystem,
    /// Seconds a step; it may differ from the scene's own.
    pub timestep: f64,
    /// The number of steps that cover the duration.
    pub steps: u64,
}

/// Something that computes whole trajectories.
pub trait Program: Send + Sync {
    /// Runs from the scene's start to the end of the task, or as far as it gets.
    ///
    /// Rows may be any whole number of steps apart. Rows after the task's last step are ignored.
    ///
    /// # Errors
    /// The [`Failure`] because of which there are no rows; it becomes the outcome.
    fn record(&self, task: &Task) -> Result<Recording, Failure>;
}

/// The result of a program.
#[derive(Debug, Clone)]
pub struct Recording {
    pub rows: Rows,
    /// Wall time of the whole program, s, with start, reading and writing. None for a stored file.
    pub seconds: Option<f64>,
}

/// The failure of a program. It is an outcome, not a fault of the run: every message says what was expected
/// and what to do.
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
    /// The program ended well, but a stream or file of it has no end.
    #[error(
        "it ended well, but {what} had no end after {after:?}: something that it left in the background still holds \
         it, or it is no plain file; let the program wait for what it started"
    )]
    Held { what: &'static str, after: Duration },
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
    /// A failure of input or output around the program: its pipes, or the files passed to it.
    #[error("could not {doing}: {cause}")]
    Io {
        doing: &'static str,
        cause: std::io::Error,
    },
}

impl Failure {
    /// Converts an I/O error, for `map_err`.
    pub fn io(doing: &'static str) -> impl Fn(std::io::Error) -> Self {
        move |cause| Self::Io { doing, cause }
    }
}

/// The error and its help on one line.
fn line(error: &ReadError) -> String {
    error.to_string().replace("\nhelp: ", "; ")
}
