//! Why a program gave no trajectory.

use crate::trajectory::ReadError;
use std::time::Duration;

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
