//! Lines and columns from byte offsets, worked out only when something is wrong.

use super::super::Place;

const MARK: &[u8] = b"\xef\xbb\xbf";

/// The text after a byte order mark, if it has one. Offsets below count from there.
pub(super) fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(MARK).unwrap_or(bytes)
}

/// Of the first character of a field, in the record that begins at this offset or after the blank
/// lines there.
pub fn of_field(bytes: &[u8], start: u64, field: usize) -> Place {
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

/// Of the last character.
pub(super) fn of_end(bytes: &[u8]) -> Place {
    let text = without_mark(bytes).trim_ascii_end();
    place(text, text.len().saturating_sub(1))
}

fn place(text: &[u8], at: usize) -> Place {
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
    Place::Text {
        line: breaks as u64 + 1,
        column: column as u64 + 1,
    }
}
