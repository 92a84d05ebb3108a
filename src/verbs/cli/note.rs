//! Notes and errors on stderr.

use crate::scene::words::visible;
use std::io::Write;

/// Writes a note or an error to stderr, with a line end. Nothing in it acts on a terminal. A stderr that is closed is
/// no error.
pub fn note(text: &str) {
    let _ = writeln!(std::io::stderr(), "{}", visible(text));
}
