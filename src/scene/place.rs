//! From a refusal to its place in the text.
//!
//! What is refused while it is being read travels through serde, whose errors carry nothing but text: the
//! sentence and its help stand between unit separators, which no YAML file may contain as they are.
//! The parser adds path and position around them; [`fault`] takes all apart again.
//!
//! What is refused later is a [`Problem`]. The document is walked again to the value's path, and the
//! walk fails there on purpose, so that the parser names the position. One pass, and only when something is
//! wrong; no second parser, no positions carried through the good case.

use super::error::{Fault, MARK, Refusal};
use super::values::{Any, Key};
use super::words::shorten;
use serde::de::{Deserialize, DeserializeSeed, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use std::fmt;

/// Rebuilds what the parser says as a located fault.
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
        // A bracket left open may be why the value is odd: what is not YAML goes first.
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
    if let Some((path, kinds)) = said.split_once("invalid type: ")
        && let Some((found, expected)) = kinds.rsplit_once(", expected ")
    {
        let message = format!("expected {expected}, found {}", kind(found));
        return place(path, &message, "");
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

/// A refusal that shows once the document is read, and the path of the value that is refused:
/// `springs[7].stiffness`. An absent value is at its container.
#[derive(Debug)]
pub(super) struct Problem {
    path: String,
    /// The key itself is at fault, not its value. The message names it.
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

    /// The problem as a result.
    pub(super) fn because<T>(
        path: impl Into<String>,
        message: impl Into<String>,
        help: &str,
    ) -> Result<T, Problem> {
        Err(Problem::new(path, Refusal::new(message, help)))
    }

    /// Of a key of the mapping at the path.
    pub(super) fn of_key(path: &str, key: &str, refusal: Refusal) -> Problem {
        Problem {
            path: format!("{path}.{key}"),
            of_key: true,
            refusal: refusal.of(path),
        }
    }

    /// Looks the path up in the text it was read from.
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

/// A scene file holds one document; this one is too much, if it is one at all.
pub(super) fn second_document(document: serde_yaml::Deserializer, text: &str) -> Fault {
    match Any(Walk("", false)).deserialize(document) {
        // Whatever is not the walk's own failure is text that does not parse.
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

/// Goes down the path left; with none left, fails on whatever stands there.
struct Walk<'p>(&'p str, bool);

impl<'p> Walk<'p> {
    /// Below a key, if the path leads there.
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
