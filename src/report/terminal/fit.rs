//! Text cut, padded and wrapped to a number of terminal columns.

use std::borrow::Cow;
use textwrap::{Options, WordSeparator, WordSplitter};
use unicode_width::UnicodeWidthStr;

/// The width of the text, columns.
pub fn width(text: &str) -> usize {
    text.width()
}

/// The text, or its beginning and an ellipsis where it is wider than `columns`.
pub fn clip(text: &str, columns: usize) -> String {
    if width(text) <= columns {
        return text.to_string();
    }
    if columns == 0 {
        return String::new();
    }
    // The longest beginning that leaves room for the ellipsis, at least one character.
    let ends = text.char_indices().map(|(at, c)| at + c.len_utf8());
    let fits = |(i, end): &(usize, usize)| *i == 0 || width(&text[..*end]) < columns;
    let end = ends
        .enumerate()
        .take_while(fits)
        .last()
        .map_or(0, |(_, end)| end);
    text[..end].trim_end().to_owned() + "…"
}

/// The text, filled with spaces on the right.
pub fn pad(text: &str, columns: usize) -> String {
    text.to_string() + &" ".repeat(columns.saturating_sub(width(text)))
}

/// The text broken between words, within a word only where it is longer than a line. All lines but the first
/// start with `indent`. White space at the very start is kept.
pub fn wrap(text: &str, columns: usize, indent: &str) -> Vec<String> {
    let options = Options::new(columns)
        .subsequent_indent(indent)
        .word_separator(WordSeparator::AsciiSpace)
        .word_splitter(WordSplitter::NoHyphenation);
    let lines = textwrap::wrap(text, options).into_iter();
    lines.map(Cow::into_owned).collect()
}
