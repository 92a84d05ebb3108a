//! The error of this module: it says what is wrong, where, and what to do about it.

use super::words::{in_line, printable};
use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};
use std::ops::Range;

/// Why a value is refused, without its place.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct Refusal {
    /// The key at fault: the whole path where the place is known, else the path below the value being
    /// read, which is empty for that value itself.
    pub(super) key: String,
    /// What was expected and what was found.
    pub message: String,
    /// What to do; empty where the message says it all.
    pub help: String,
    /// Whether the value could be read, but its content is wrong.
    judged: bool,
}

impl Refusal {
    pub(super) fn new(message: impl Into<String>, help: impl Into<String>) -> Refusal {
        Refusal {
            key: String::new(),
            message: message.into(),
            help: help.into(),
            judged: false,
        }
    }

    pub(super) fn judged(self) -> Refusal {
        Refusal {
            judged: true,
            ..self
        }
    }

    /// The refusal as a result.
    pub(super) fn because<T>(
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Result<T, Refusal> {
        Err(Refusal::new(message, help))
    }

    pub(super) fn of(self, key: &str) -> Refusal {
        Refusal {
            key: key.to_owned(),
            ..self
        }
    }
}

/// Separates the parts of a [`Refusal`] that travels through serde, whose errors are plain text. No YAML
/// file may contain this character unescaped.
pub(super) const MARK: char = '\u{1f}';

/// Turns the refusal of the value being read into a serde error.
pub(super) fn refuse<E: serde::de::Error>(refusal: Refusal) -> E {
    let judged = if refusal.judged { "judged" } else { "" };
    let parts = [refusal.key, refusal.message, refusal.help].map(|text| text.replace(MARK, " "));
    let [key, message, help] = parts;
    E::custom(format!(
        "{MARK}{key}{MARK}{message}{MARK}{help}{MARK}{judged}{MARK}"
    ))
}

/// A refusal at a place in the text.
#[derive(Debug)]
pub(super) struct Fault {
    /// Bytes from the start of the text.
    pub(super) offset: usize,
    pub(super) refusal: Refusal,
}

impl Fault {
    pub(super) fn new(offset: usize, message: impl Into<String>, help: &str) -> Fault {
        Fault {
            offset,
            refusal: Refusal::new(message, help),
        }
    }
}

/// Why a scene cannot be used, for its author. Displays as a block whose first line begins with
/// `file:line:column` and which shows the offending line.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.render(&Renderer::plain()))]
pub struct SceneError {
    /// The file as it was named.
    pub file: String,
    /// Counted from 1; absent where the file as a whole is at fault.
    pub line: Option<u32>,
    /// Counted from 1, in characters.
    pub column: Option<u32>,
    /// The fault without its place; its key is empty where the file as a whole is at fault.
    pub refusal: Box<Refusal>,
    excerpt: Option<Box<Excerpt>>,
}

/// The part of the offending line that is shown.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Excerpt {
    line: String,
    /// The bytes of `line` that are underlined.
    marked: Range<usize>,
}

impl SceneError {
    /// An error about the file, not about a place in it.
    pub(super) fn of_file(file: &str, message: String) -> SceneError {
        SceneError {
            file: file.to_owned(),
            line: None,
            column: None,
            refusal: Box::new(Refusal::new(message, "")),
            excerpt: None,
        }
    }

    /// An error at a place in `text`.
    pub(super) fn at(file: &str, text: &str, fault: Fault) -> SceneError {
        let mut offset = fault.offset.min(text.len());
        while !text.is_char_boundary(offset) {
            offset -= 1;
        }
        let (before, after) = text.split_at(offset);
        let start = before.rfind(['\n', '\r']).map_or(0, |i| i + 1);
        let end = offset + after.find(['\n', '\r']).unwrap_or(after.len());
        // "\r\n" ends one line, a lone "\r" ends one too.
        let bytes = &before.as_bytes()[..start];
        let breaks = (0..start)
            .filter(|&i| bytes[i] == b'\n' || bytes[i] == b'\r' && bytes.get(i + 1) != Some(&b'\n'))
            .count();
        let column = text[start..offset].chars().count();
        SceneError {
            file: file.to_owned(),
            line: u32::try_from(breaks + 1).ok(),
            column: u32::try_from(column + 1).ok(),
            refusal: Box::new(fault.refusal),
            excerpt: Some(Box::new(excerpt(&text[start..offset], &text[offset..end]))),
        }
    }

    /// Renders the whole block, plain or styled by the caller's renderer.
    pub fn render(&self, renderer: &Renderer) -> String {
        let Refusal {
            key, message, help, ..
        } = &*self.refusal;
        let mut headline = in_line(&self.file);
        for number in [self.line, self.column].into_iter().flatten() {
            headline += &format!(":{number}");
        }
        if !key.is_empty() {
            headline += &format!(": {key}");
        }
        let title = Level::ERROR.no_name();
        let mut report = Group::with_title(title.primary_title(format!("{headline}: {message}")));
        if let (Some(excerpt), Some(line)) = (&self.excerpt, self.line) {
            report = report.element(
                Snippet::source(&excerpt.line)
                    .line_start(line as usize)
                    .annotation(AnnotationKind::Primary.span(excerpt.marked.clone())),
            );
        }
        if !help.is_empty() {
            report = report.element(Level::HELP.message(help));
        }
        renderer.render(&[report])
    }
}

/// Longest part of a line shown before and after the marked place, in characters.
const AROUND: usize = 70;

/// Shortens the line to what fits, and replaces control characters, which a terminal must not receive.
fn excerpt(before: &str, after: &str) -> Excerpt {
    let skipped = before.chars().count().saturating_sub(AROUND);
    let mut line = String::new();
    if skipped > 0 {
        line.push_str("… ");
    }
    line.extend(before.chars().skip(skipped).map(printable));
    let start = line.len();
    let shown = || after.chars().take(AROUND).map(printable);
    let marked: usize = shown().take(token(after)).map(char::len_utf8).sum();
    line.extend(shown());
    if after.chars().nth(AROUND).is_some() {
        line.push_str(" …");
    }
    Excerpt {
        line,
        marked: start..start + marked,
    }
}

/// The number of characters of the value or key that begins here; a bracket or an indicator counts as 1.
fn token(text: &str) -> usize {
    let mut chars = text.chars();
    let one = |c: char| matches!(c, ',' | ':' | '[' | ']' | '{' | '}');
    match chars.next() {
        None => 0,
        Some(c) if one(c) => 1,
        Some(quote @ ('"' | '\'')) => {
            let inner = chars.take(AROUND).position(|c| c == quote);
            inner.map_or(1, |inner| inner + 2)
        }
        Some(_) => 1 + chars.take_while(|c| !c.is_whitespace() && !one(*c)).count(),
    }
}
