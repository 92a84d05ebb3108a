//! Colour for laid-out text.
//!
//! Layout counts columns, and would count escape sequences with the text. So cells carry
//! zero-width marks (variation selectors, which [`words::one_line`](crate::report::words::one_line)
//! takes out of foreign text) that become ANSI sequences once everything stands in its place.

use crate::scene::words::printable;
use anstyle::{AnsiColor, Style};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tone {
    Good,
    Warn,
    Bad,
    /// Energy that the method loses: neither good nor bad.
    Cool,
    Dim,
    Strong,
}

const TONES: [(Tone, Style); 6] = [
    (Tone::Good, AnsiColor::Green.on_default()),
    (Tone::Warn, AnsiColor::Yellow.on_default()),
    (Tone::Bad, AnsiColor::Red.on_default()),
    (Tone::Cool, AnsiColor::Cyan.on_default()),
    (Tone::Dim, Style::new().dimmed()),
    (Tone::Strong, Style::new().bold()),
];

const FIRST: u32 = 0xE0100;
const END: char = '\u{e01ef}';

/// Puts the text between zero-width marks.
pub fn mark(tone: Tone, text: &str) -> String {
    if text.is_empty() {
        return String::new();
    }
    let start = char::from_u32(FIRST + tone as u32).unwrap_or(END);
    format!("{start}{text}{END}")
}

/// Replaces the marks by ANSI sequences. No other character that a terminal acts on passes, but the line's end.
pub fn paint(text: &str) -> String {
    let mut painted = String::with_capacity(text.len() + 256);
    for c in text.chars() {
        let tone = (c as u32).wrapping_sub(FIRST) as usize;
        if c == END {
            painted += &format!("{:#}", Style::new().bold());
        } else if let Some((_, style)) = TONES.get(tone) {
            painted += &style.to_string();
        } else if c == '\n' {
            painted.push(c);
        } else {
            painted.push(printable(c));
        }
    }
    painted
}
