//! A scene as the text of a file: every default written out, in the order of the table.

use super::expectation::{Expectation, SKIP, Wanted};
use super::model::{Part, Row, SCENE, Scene, ValueKind};
use super::table::Value;
use std::fmt::Write;

/// The scene as YAML. [`parse`](super::parse) makes the same scene of it, but for the name of its file.
///
/// What has no default (the tolerance of the method's own choice, an empty list) stays absent. Not to be confused with the
/// [flat arrays](crate::solvers::external::Flat) that other programs get.
pub fn yaml(scene: &Scene) -> String {
    let mut text = String::new();
    let mut line = |key: &str, value: &str| {
        // Writing to a string does not fail.
        let _ = writeln!(text, "{key}:{value}");
    };
    for row in SCENE.rows {
        match &row.kind {
            ValueKind::Part(part) => {
                let members = (0..(part.count)(scene)).map(|at| member(part, scene, at));
                let members: Vec<String> = members.collect();
                match &members[..] {
                    [] => {}
                    [one] if !part.list => line(row.key, &format!(" {one}")),
                    _ => line(row.key, &format!("\n  - {}", members.join("\n  - "))),
                }
            }
            ValueKind::Expect => {
                let lines = expectations(scene);
                if !lines.is_empty() {
                    line(row.key, &format!("\n  {}", lines.join("\n  ")));
                }
            }
            _ => {
                if let Some(value) = value(row, scene, 0) {
                    line(row.key, &format!(" {value}"));
                }
            }
        }
    }
    text
}

/// One mapping of a part, on one line.
fn member(part: &Part, scene: &Scene, at: usize) -> String {
    let mut entries: Vec<(&str, String)> = Vec::new();
    for row in part.rows {
        let Some(value) = value(row, scene, at) else {
            continue;
        };
        // Of two rows of a key the later one holds what is given in the number's place.
        entries.pop_if(|(key, _)| *key == row.key);
        entries.push((row.key, value));
    }
    braces(
        entries
            .into_iter()
            .map(|(key, value)| format!("{key}: {value}")),
    )
}

/// The value of a key; None where it has none.
fn value(row: &Row, scene: &Scene, at: usize) -> Option<String> {
    if let ValueKind::Part(part) = row.kind {
        let mut rows = part.rows.iter();
        return rows
            .any(|row| (row.get)(scene, at, 0).is_some())
            .then(|| member(part, scene, at));
    }
    let mut values = row.values(scene, at).map(|value| match value {
        Value::Number(x) => number(x),
        Value::Id(id) => id.to_string(),
        Value::Flag(flag) => flag.to_string(),
        Value::Text(text) => self::text(text),
    });
    match row.kind {
        ValueKind::Table(width, ..) => {
            let values: Vec<String> = values.collect();
            let rows = values.chunks(width).map(|row| brackets(row.to_vec()));
            (!values.is_empty()).then(|| brackets(rows))
        }
        ValueKind::Numbers(..) | ValueKind::Ids(_) | ValueKind::Names(_) => {
            let values: Vec<String> = values.collect();
            (!values.is_empty()).then(|| brackets(values))
        }
        ValueKind::Vectors(_) => {
            let values: Vec<String> = values.collect();
            let vectors = values.chunks(3).map(|vector| brackets(vector.to_vec()));
            let vectors: Vec<String> = vectors.collect();
            match &vectors[..] {
                [] => None,
                [vector] => Some(vector.clone()),
                _ => Some(brackets(vectors)),
            }
        }
        _ => values.next(),
    }
}

/// A line for each engine, and one for the checks that are skipped.
fn expectations(scene: &Scene) -> Vec<String> {
    let of_one = |a: &Expectation, b: &Expectation| a.scope == b.scope;
    let mut lines = Vec::new();
    for line in scene.expect.chunk_by(of_one) {
        let keys = line
            .iter()
            .map(|expected| format!("{}: {}", expected.key, wanted(&expected.wanted)));
        lines.push(format!(
            "{}: {}",
            text(&line[0].scope.to_string()),
            braces(keys)
        ));
    }
    let skipped = scene.skip.iter();
    let skipped: Vec<String> = skipped
        .map(|skip| format!("{}: {}", text(&skip.check), text(&skip.reason)))
        .collect();
    if !skipped.is_empty() {
        lines.push(format!("{SKIP}: {}", braces(skipped)));
    }
    lines
}

fn wanted(wanted: &Wanted) -> String {
    match wanted {
        Wanted::Words(words) => match &words[..] {
            [word] => text(word),
            words => brackets(words.iter().map(|word| text(word))),
        },
        Wanted::Bounds { above, below } => {
            let bounds = [("above", above), ("below", below)].into_iter();
            braces(bounds.filter_map(|(key, x)| x.map(|x| format!("{key}: {}", number(x)))))
        }
        Wanted::Contains(part) => format!("{{contains: {}}}", text(part)),
    }
}

fn braces(entries: impl IntoIterator<Item = String>) -> String {
    format!("{{{}}}", entries.into_iter().collect::<Vec<_>>().join(", "))
}

fn brackets(entries: impl IntoIterator<Item = String>) -> String {
    format!("[{}]", entries.into_iter().collect::<Vec<_>>().join(", "))
}

/// The fewest digits that read back to the same bits. YAML 1.1, which many programs read, takes `1e5` for text and
/// `1.0e+5` for a number.
fn number(x: f64) -> String {
    let text = format!("{x:?}");
    let Some((digits, exponent)) = text.split_once('e') else {
        return text;
    };
    let point = if digits.contains('.') { "" } else { ".0" };
    let sign = if exponent.starts_with('-') { "" } else { "+" };
    format!("{digits}{point}e{sign}{exponent}")
}

/// Text that is read back as this text: a plain word, or a string as JSON has it, which YAML reads too.
fn text(text: &str) -> String {
    let word = |c: char| c.is_ascii_alphanumeric() || "_-.".contains(c);
    let starts = text.starts_with(|c: char| c.is_ascii_alphabetic());
    let plain = starts && text.chars().all(word);
    if plain && matches!(serde_yaml::from_str(text), Ok(serde_yaml::Value::String(_))) {
        return text.to_owned();
    }
    let mut quoted = serde_json::Value::from(text).to_string();
    // Unlike JSON, YAML ends a line at these, and skips the last.
    for (raw, escaped) in [
        ('\u{2028}', "\\u2028"),
        ('\u{2029}', "\\u2029"),
        ('\u{feff}', "\\ufeff"),
    ] {
        quoted = quoted.replace(raw, escaped);
    }
    quoted
}
