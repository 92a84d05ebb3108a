//! What the command lines of all verbs share: the only place that touches files, the terminal and programs.

pub mod announce;
pub mod cache;
pub mod chosen;
pub mod external;
pub mod host;
pub mod output;
pub mod progress;
pub mod rapier;
pub mod save;
pub mod shown;
pub mod time;

use anyhow::Context;
use std::io::Write;

/// Writes to stdout. A reader that has gone away (`| head`) is not an error.
pub fn print(text: &str) -> anyhow::Result<()> {
    let mut out = anstream::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        other => other.context("cannot write to stdout"),
    }
}
