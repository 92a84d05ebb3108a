//! Notes and errors on stderr.

use crate::scene::SceneError;
use crate::scene::words::{in_line, visible};
use crate::trajectory::ReadError;
use std::io::Write;

/// Writes a note or an error to stderr, with a line end. Nothing in it acts on a terminal. A stderr that is closed is
/// no error.
pub fn note(text: &str) {
    let _ = writeln!(std::io::stderr(), "{}", visible(text));
}

/// Writes to stderr why a verb has failed: what is wrong with a scene or a trajectory as it stands, and anything else
/// introduced, with its causes, on one line.
pub fn error(error: &anyhow::Error) {
    if error.is::<SceneError>() || error.is::<ReadError>() {
        note(&error.to_string());
    } else {
        note(&format!("error: {}", in_line(&format!("{error:#}"))));
    }
}
