//! The one error of reading a trajectory: what is wrong, where, and what to do about it. Lines and columns
//! are worked out from byte offsets only when something is wrong.

use crate::scene::words::{in_line, shorten};
use std::fmt;

/// Why a trajectory file cannot be used. Displays as `mine.csv:17:3: ...` or
/// `mine.npz: x[12, 3, 0]: ...`, followed by a line of help where there is some.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}{place}: {message}{}", in_line(file), separated(help))]
pub struct ReadError {
    /// The file as it was named.
    pub file: String,
    pub place: ErrorPlace,
    /// What was expected and what was found.
    pub message: String,
    /// What to do; empty where the message says it all.
    pub help: String,
}

/// The place in a file where something is wrong.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ErrorPlace {
    /// The file as a whole.
    File,
    /// A place in text. Both count from 1; the column counts characters, as editors do, not fields.
    Text { line: u64, column: u64 },
    /// A number in an array, or the whole array where the index is empty. Indices count from 0.
    Array { name: String, index: Vec<usize> },
}

impl fmt::Display for ErrorPlace {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::File => Ok(()),
            Self::Text { line, column } => write!(f, ":{line}:{column}"),
            Self::Array { name, index } if index.is_empty() => write!(f, ": {}", shorten(name)),
            Self::Array { name, index } => write!(f, ": {}{index:?}", shorten(name)),
        }
    }
}

fn separated(help: &str) -> String {
    if help.is_empty() {
        String::new()
    } else {
        format!("\nhelp: {help}")
    }
}

/// The help for a file that ends too early.
pub(super) const HALF: &str = "half a file? The program that wrote it may have stopped early";

/// The help for data of a plane where no plane was named.
pub(super) const PLANE: &str =
    "data of a plane? `--axes xy` (or xz, yz) says which axes of the scene it has";

/// The help for three coordinates where a plane was named.
pub(super) const SPACE: &str = "there are three coordinates: leave --axes out";

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

    /// The error at this place; the caller adds the file's name.
    pub fn at(self, place: ErrorPlace) -> ReadError {
        ReadError {
            file: String::new(),
            place,
            message: self.message,
            help: self.help,
        }
    }
}

/// The byte order mark some programs begin UTF-8 with.
const MARK: &[u8] = b"\xef\xbb\xbf";

/// The text after a byte order mark, if it has one. Offsets below count from there.
pub(super) fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(MARK).unwrap_or(bytes)
}

/// The place of the first character of a field, in the record that begins at this offset or after the
/// blank lines there.
pub(super) fn of_field(bytes: &[u8], start: u64, field: usize) -> ErrorPlace {
    let text = without_mark(bytes);
    let mut at = usize::try_from(start).unwrap_or(usize::MAX).min(text.len());
    let skip = |at: usize, skipped: fn(&u8) -> bool| {
        at + text[at..].iter().take_while(|b| skipped(b)).count()
    };
    at = skip(at, |b| matches!(b, b'\n' | b'\r'));
    for _ in 0..field {
        at = skip(at, |b| !matches!(b, b',' | b'\n' | b'\r'));
        if text.get(at) == Some(&b',') {
            at += 1;
        }
    }
    place(text, skip(at, |b| matches!(b, b' ' | b'\t')))
}

/// The place of the last character.
pub(super) fn of_end(bytes: &[u8]) -> ErrorPlace {
    let text = without_mark(bytes).trim_ascii_end();
    place(text, text.len().saturating_sub(1))
}

fn place(text: &[u8], at: usize) -> ErrorPlace {
    let before = &text[..at.min(text.len())];
    // "\r\n" ends one line, a lone "\r" ends one too.
    let ends = |i: usize| match before[i] {
        b'\n' => true,
        b'\r' => text.get(i + 1) != Some(&b'\n'),
        _ => false,
    };
    let breaks = (0..before.len()).filter(|&i| ends(i)).count();
    let start = before
        .iter()
        .rposition(|b| matches!(b, b'\n' | b'\r'))
        .map_or(0, |i| i + 1);
    let column = String::from_utf8_lossy(&before[start..]).chars().count();
    ErrorPlace::Text {
        line: breaks as u64 + 1,
        column: column as u64 + 1,
    }
}
