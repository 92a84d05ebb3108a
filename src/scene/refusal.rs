//! A refusal's way through serde, whose errors carry nothing but text.
//!
//! The sentence and its help travel between unit separators, which no YAML file may contain as they
//! are; the parser adds path and position around them, and [`fault`] takes all apart again.

use super::locate::Fault;
use super::shown::shorten;
use serde::de;

const MARK: char = '\u{1f}';

/// An error a raw type raises while it is being read. `key` is appended to the path of the value
/// being read; empty for that value itself.
pub(super) fn refuse<E: de::Error>(key: &str, message: &str, help: &str) -> E {
    let clean = |text: &str| text.replace(MARK, " ");
    E::custom(format!(
        "{MARK}{}{MARK}{}{MARK}{}{MARK}",
        clean(key),
        clean(message),
        clean(help)
    ))
}

/// Rebuilds what the parser says as a located fault.
pub(super) fn fault(error: &serde_yaml::Error, text: &str) -> Fault {
    let said = error.to_string();
    let location = error.location();
    let offset = location.as_ref().map_or(0, |l| l.index());
    let place = |key: &str, message: String, help: String| Fault {
        offset,
        key: key.to_owned(),
        message,
        help,
    };

    let parts: Vec<&str> = said.split(MARK).collect();
    if let [path, key, message, help, _] = parts[..] {
        let path = path.trim_end_matches(": ");
        let joined = match (path, key) {
            ("", key) => key.to_owned(),
            (path, "") => path.to_owned(),
            (path, key) => format!("{path}.{key}"),
        };
        return place(&joined, message.to_owned(), help.to_owned());
    }

    let position = location
        .map(|l| format!(" at line {} column {}", l.line(), l.column()))
        .unwrap_or_default();
    let said = match position.as_str() {
        "" => said,
        position => said.replacen(position, "", 1),
    };
    if let Some((path, kinds)) = said.split_once("invalid type: ")
        && let Some((found, expected)) = kinds.rsplit_once(", expected ")
    {
        let message = format!("expected {expected}, found {}", kind(found));
        return place(path.trim_end_matches(": "), message, String::new());
    }
    let help = if text.as_bytes().get(offset) == Some(&b'\t') {
        "YAML indents with spaces, not with tabs"
    } else if said.contains("mapping values are not allowed") {
        "text that contains `: ` needs quotes; keys below each other need the same indentation"
    } else {
        ""
    };
    place("", format!("not valid YAML: {said}"), help.to_owned())
}

/// serde's name of what it found, in a scene author's words.
fn kind(found: &str) -> String {
    match found {
        "sequence" => "a list".into(),
        "map" => "a mapping".into(),
        "unit value" => "nothing".into(),
        "enum" => "a value with a YAML tag".into(),
        other => shorten(
            &other
                .replacen("string ", "the text ", 1)
                .replacen("integer ", "the number ", 1)
                .replacen("floating point ", "the number ", 1),
        ),
    }
}
