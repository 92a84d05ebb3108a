//! What is refused before any YAML is read: bytes that are no text, and nesting so deep that the
//! parser's time grows with its square.

use super::error::Fault;
use super::limits::NESTING;

/// The text of a scene file, without BOM.
pub(super) fn check(bytes: &[u8]) -> Result<&str, Fault> {
    let text = std::str::from_utf8(bytes).map_err(|e| {
        let message = "these bytes are not UTF-8 text";
        Fault::new(e.valid_up_to(), message, "save the file as UTF-8")
    })?;
    if let Some((offset, c)) = text.char_indices().find(|(_, c)| forbidden(*c)) {
        let code = u32::from(c);
        let message = format!("the control character U+{code:04X} is not allowed in YAML");
        return Err(Fault::new(offset, message, "remove it"));
    }
    // A quote in a block scalar can hide what follows it, so a second count does without quotes;
    // it takes quoted prose for structure and is more patient.
    let bytes = text.as_bytes();
    match too_deep(bytes, NESTING, true).or_else(|| too_deep(bytes, 16 * NESTING, false)) {
        Some(offset) => {
            let message = format!("brackets nest more than {NESTING} deep");
            let help = "a scene needs four levels: is a bracket left open?";
            Err(Fault::new(offset, message, help))
        }
        None => Ok(text),
    }
}

/// YAML's non-printable characters; the parser refuses them too, but without a place.
fn forbidden(c: char) -> bool {
    match c {
        '\t' | '\n' | '\r' | '\u{85}' => false,
        '\u{feff}' | '\u{fffe}' | '\u{ffff}' => true,
        c => c.is_control(),
    }
}

/// Where flow collections first nest deeper than `limit`. Comments, plain text and, if heeded,
/// quoted text do not count; brackets in prose elsewhere may, but never as deep.
fn too_deep(text: &[u8], limit: usize, heed_quotes: bool) -> Option<usize> {
    let mut depth = 0;
    // Inside a plain scalar quotes, and outside a collection brackets, are letters like any other.
    let mut plain = false;
    let mut at = 0;
    while let Some(&byte) = text.get(at) {
        let spaced = text.get(at + 1).is_none_or(u8::is_ascii_whitespace);
        match byte {
            b'\n' | b'\r' => plain = false,
            b' ' | b'\t' => {}
            b'#' if at == 0 || text[at - 1].is_ascii_whitespace() => {
                while text
                    .get(at + 1)
                    .is_some_and(|b| !matches!(b, b'\n' | b'\r'))
                {
                    at += 1;
                }
            }
            b'[' | b'{' if depth > 0 || !plain => {
                depth += 1;
                plain = false;
                if depth > limit {
                    return Some(at);
                }
            }
            b']' | b'}' if depth > 0 => {
                depth -= 1;
                plain = false;
            }
            b',' if depth > 0 => plain = false,
            b':' if spaced || depth > 0 => plain = false,
            b'-' | b'?' if spaced && !plain => {}
            b'&' | b'!' | b'*' if !plain => {
                // An anchor, a tag or an alias: what follows it is still a beginning.
                let ends = |b: &u8| b.is_ascii_whitespace() || b",[]{}".contains(b);
                while text.get(at + 1).is_some_and(|b| !ends(b)) {
                    at += 1;
                }
            }
            b'"' | b'\'' if !plain && heed_quotes => at = closing(text, at),
            _ => plain = true,
        }
        at += 1;
    }
    None
}

/// The index of the quote that closes the one at `open`, or the last byte.
fn closing(text: &[u8], open: usize) -> usize {
    let quote = text[open];
    let mut at = open + 1;
    while let Some(&byte) = text.get(at) {
        if byte == b'\\' && quote == b'"' {
            at += 1;
        } else if byte == quote {
            // A doubled single quote reads as closing and opening again: the same in the end.
            return at;
        }
        at += 1;
    }
    text.len()
}
