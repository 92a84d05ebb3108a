//! The one error of reading a trajectory: what is wrong, where, and what to do about it.

use crate::scene::words::{printable, shorten};
use std::fmt;

/// Why a trajectory file cannot be used. Displays as `mine.csv:17:3: ...` or
/// `mine.npz: x[12, 3, 0]: ...`, followed by a line of help where there is some.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}{place}: {message}{}", printed(file), separated(help))]
pub struct ReadError {
    /// The file as it was named.
    pub file: String,
    pub place: Place,
    /// What was expected and what was found.
    pub message: String,
    /// What to do; empty where the message says it all.
    pub help: String,
}

/// Where in a file something is wrong.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    /// The file as a whole.
    File,
    /// In text. Both count from 1; the column in characters, as editors do, not in fields.
    Text { line: u64, column: u64 },
    /// In an array, or the array as a whole where the index is empty. Indices count from 0.
    Array { name: String, index: Vec<usize> },
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::File => Ok(()),
            Self::Text { line, column } => write!(f, ":{line}:{column}"),
            Self::Array { name, index } if index.is_empty() => write!(f, ": {}", shorten(name)),
            Self::Array { name, index } => write!(f, ": {}{index:?}", shorten(name)),
        }
    }
}

fn printed(file: &str) -> String {
    file.chars().map(printable).collect()
}

fn separated(help: &str) -> String {
    if help.is_empty() {
        String::new()
    } else {
        format!("\nhelp: {help}")
    }
}

/// What to do where a file ends too early.
pub(super) const HALF: &str = "half a file? The program that wrote it may have stopped early";

/// An error that does not know yet where it happened.
#[derive(Debug)]
pub(super) struct Wrong {
    pub message: String,
    pub help: String,
}

impl Wrong {
    pub fn new(message: impl Into<String>, help: impl Into<String>) -> Self {
        Self {
            message: message.into(),
            help: help.into(),
        }
    }

    pub fn at(self, file: &str, place: Place) -> ReadError {
        ReadError {
            file: file.to_owned(),
            place,
            message: self.message,
            help: self.help,
        }
    }
}
