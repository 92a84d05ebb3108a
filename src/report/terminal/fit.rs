//! Text cut, padded and wrapped to a number of terminal columns.

use unicode_width::UnicodeWidthStr;

/// Columns the text takes.
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
    let mut kept = head(text, columns - 1).trim_end().to_string();
    kept.push('…');
    kept
}

/// Filled with spaces on the right.
pub fn pad(text: &str, columns: usize) -> String {
    text.to_string() + &" ".repeat(columns.saturating_sub(width(text)))
}

/// Broken between words, within one only where it is longer than a line. Lines but the first start
/// with `indent`. White space at the very start is kept.
pub fn wrap(text: &str, columns: usize, indent: &str) -> Vec<String> {
    let room = columns.saturating_sub(width(indent)).max(8);
    let mut lines = Vec::new();
    let words_at = text.len() - text.trim_start().len();
    let mut line = text[..words_at].to_string();
    let mut empty = true;
    for mut word in text[words_at..].split(' ') {
        if !empty && width(&line) + 1 + width(word) > columns {
            lines.push(std::mem::replace(&mut line, indent.to_string()));
            empty = true;
        }
        while width(word) > room {
            let part = head(word, room - usize::from(!empty));
            word = &word[part.len()..];
            lines.push(std::mem::replace(&mut line, indent.to_string()) + part);
        }
        if !empty {
            line.push(' ');
        }
        line += word;
        empty = false;
    }
    lines.push(line);
    lines
}

/// The longest beginning that fits, at least one character.
fn head(text: &str, columns: usize) -> &str {
    let mut end = 0;
    for (at, c) in text.char_indices() {
        let next = at + c.len_utf8();
        if end > 0 && width(&text[..next]) > columns {
            break;
        }
        end = next;
    }
    &text[..end]
}
