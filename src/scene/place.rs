//! Finds the place of a refusal in the text.
//!
//! A refusal during reading travels through serde, whose errors are plain text: its message and help
//! stand between unit separators, which no YAML file may contain unescaped. The parser adds path and
//! position around them, and [`fault`] takes them apart again.
//!
//! A later refusal is a [`Problem`]. The document is walked again to the value's path, and the walk fails
//! there on purpose, so that the parser names the position. This costs one pass, only when something is
//! wrong. It needs no second parser, and reading a good file carries no positions.

use super::error::{Fault, MARK, Refusal};
use super::values::{Any, Key};
use super::words::{about_key, did_you_mean, shorten};
use serde::de::{Deserialize, DeserializeSeed, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use std::fmt;

/// Turns the parser's error into a located fault.
pub(super) fn fault(error: &serde_yaml::Error, text: &str) -> Fault {
    let said = error.to_string();
    let location = error.location();
    let offset = location.as_ref().map_or(0, |l| l.index());
    let place = |path: &str, message: &str, help: &str| Fault {
        offset,
        refusal: Refusal::new(message, help).of(path.trim_end_matches(": ")),
    };

    let parts: Vec<&str> = said.split(MARK).collect();
    if let [path, key, message, help, judged, _] = parts[..] {
        // An open bracket may be why the value is odd, so an error of syntax is reported first.
        if !judged.is_empty()
            && let Some(document) = serde_yaml::Deserializer::from_str(text).next()
            && let Err(not_yaml) = IgnoredAny::deserialize(document)
        {
            return fault(&not_yaml, text);
        }
        let path = [path.trim_end_matches(": "), key];
        let path: Vec<&str> = path.into_iter().filter(|part| !part.is_empty()).collect();
        return place(&path.join("."), message, help);
    }

    let said = match location {
        Some(l) => said.replacen(
            &format!(" at line {} column {}", l.line(), l.column()),
            "",
            1,
        ),
        None => said,
    };
    for what in ["invalid type: ", "invalid length ", "invalid value: "] {
        if let Some((path, kinds)) = said.split_once(what)
            && let Some((found, expected)) = kinds.rsplit_once(", expected ")
        {
            let message = format!("expected {}, found {}", wanted(expected), kind(found));
            return place(path, &message, "");
        }
    }
    let below = |path: &str, key: &str| format!("{}.{key}", path.trim_end_matches(": "));
    if let Some((path, key)) = quoted(&said, "missing field `") {
        return place(&below(path, key), "missing", "");
    }
    if let Some((path, key)) = quoted(&said, "duplicate field `") {
        return place(
            &below(path, key),
            "this key is given twice",
            "keep one of them",
        );
    }
    if let Some((path, key)) = quoted(&said, "unknown field `") {
        let known: Vec<&str> = said.split('`').skip(3).step_by(2).collect();
        return place(
            path,
            &format!("unknown key `{}`", shorten(key)),
            &about_key(key, &known),
        );
    }
    if let Some((path, word)) = quoted(&said, "unknown variant `") {
        let known: Vec<&str> = said.split('`').skip(3).step_by(2).collect();
        let message = format!(
            "expected one of {}, found `{}`",
            known.join(", "),
            shorten(word)
        );
        return place(
            path,
            &message,
            &did_you_mean(word, &known).unwrap_or_default(),
        );
    }
    let help = if text.as_bytes().get(offset) == Some(&b'\t') {
        "YAML indents with spaces, not with tabs"
    } else if said.contains("mapping values are not allowed") {
        "text that contains `: ` needs quotes; keys below each other need the same indentation"
    } else {
        ""
    };
    place("", &format!("not valid YAML: {said}"), help)
}

/// What stands before these words, and the text between them and the next quote.
fn quoted<'a>(said: &'a str, words: &str) -> Option<(&'a str, &'a str)> {
    let (path, rest) = said.split_once(words)?;
    Some((path, rest.split_once('`')?.0))
}

/// serde's name of what it expected, in words for the scene's author.
fn wanted(expected: &str) -> String {
    match expected {
        "u64" => "a whole number from 0".into(),
        "f64" => "a number".into(),
        "a sequence" => "a list".into(),
        other if other.starts_with("struct ") => "a mapping".into(),
        other => match other.strip_prefix("an array of length ") {
            Some(count) => format!("a list of {count} numbers"),
            None => other.to_owned(),
        },
    }
}

/// serde's name of what it found, in words for the scene's author.
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

/// A refusal that is found once the document is read, with the path of the value, as
/// `springs[7].stiffness`. For an absent value the place is its container.
#[derive(Debug)]
pub(super) struct Problem {
    path: String,
    /// Whether the key itself is at fault and not its value. The message then names the key.
    of_key: bool,
    refusal: Refusal,
}

impl Problem {
    pub(super) fn new(path: impl Into<String>, refusal: Refusal) -> Problem {
        let path = path.into();
        Problem {
            refusal: refusal.of(&path),
            path,
            of_key: false,
        }
    }

    /// What is wrong, without its place.
    pub(super) fn refusal(self) -> Refusal {
        self.refusal
    }

    /// The problem as a result.
    pub(super) fn because<T>(
        path: impl Into<String>,
        message: impl Into<String>,
        help: &str,
    ) -> Result<T, Problem> {
        Err(Problem::new(path, Refusal::new(message, help)))
    }

    /// A problem with a key of the mapping at the path.
    pub(super) fn of_key(path: &str, key: &str, refusal: Refusal) -> Problem {
        Problem {
            path: format!("{path}.{key}"),
            of_key: true,
            refusal: refusal.of(path),
        }
    }

    /// Finds the path in the text it was read from.
    pub(super) fn locate(self, text: &str) -> Fault {
        let walk = Any(Walk(&self.path, self.of_key));
        let found = serde_yaml::Deserializer::from_str(text)
            .next()
            .and_then(|document| walk.deserialize(document).err());
        Fault {
            offset: found.and_then(|e| e.location()).map_or(0, |l| l.index()),
            refusal: self.refusal,
        }
    }
}

/// The fault of a second document, or of text after the first that does not parse.
pub(super) fn second_document(document: serde_yaml::Deserializer, text: &str) -> Fault {
    match Any(Walk("", false)).deserialize(document) {
        // An error other than the walk's own means that the text does not parse.
        Err(e) if !e.to_string().contains(HERE) => fault(&e, text),
        here => Fault {
            offset: here
                .err()
                .and_then(|e| e.location())
                .map_or(0, |l| l.index()),
            refusal: Refusal::new(
                "a second YAML document begins here",
                "a scene file holds one scene: remove the `---`, or split the file",
            ),
        },
    }
}

const HERE: &str = "the place looked for";

/// Descends along the rest of the path; at its end it fails on whatever stands there.
struct Walk<'p>(&'p str, bool);

impl<'p> Walk<'p> {
    /// The walk below a key, if the path leads there.
    fn below(&self, step: &str) -> Option<Walk<'p>> {
        let rest = self.0.strip_prefix(step)?;
        let ends = rest.is_empty() || rest.starts_with(['.', '[']);
        ends.then(|| Walk(rest.strip_prefix('.').unwrap_or(rest), self.1))
    }
}

impl<'de> Visitor<'de> for Walk<'_> {
    type Value = ();

    // A visitor that accepts no scalar: the parser's complaint about it is the answer.
    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(HERE)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let below = |key: &str| match self.below(key) {
            Some(Walk("", true)) => Refusal::because(HERE, ""),
            below => Ok(below),
        };
        while !self.0.is_empty()
            && let Some(below) = map.next_key_seed(Key(below))?
        {
            match below {
                Some(walk) => map.next_value_seed(Any(walk))?,
                None => _ = map.next_value::<IgnoredAny>()?,
            }
        }
        Err(A::Error::custom(HERE))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<(), A::Error> {
        let index = self
            .0
            .strip_prefix('[')
            .and_then(|rest| rest.split_once(']'));
        if let Some((index, rest)) = index
            && let Ok(wanted) = index.parse::<usize>()
        {
            for _ in 0..wanted {
                list.next_element::<IgnoredAny>()?;
            }
            let rest = rest.strip_prefix('.').unwrap_or(rest);
            list.next_element_seed(Any(Walk(rest, self.1)))?;
        }
        Err(A::Error::custom(HERE))
    }
}
