//! Finds the place of a value after the fact: walks the document to the value's path and fails
//! there on purpose, so that the parser names the position. One pass, and only when something is
//! wrong; no second parser, no positions carried through the good case.

use super::path::{At, Step};
use super::refusal;
use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use std::fmt;

/// Something wrong at a place in the text.
#[derive(Debug)]
pub(super) struct Fault {
    /// Bytes from the start of the text.
    pub(super) offset: usize,
    /// `springs[7].stiffness`, or empty.
    pub(super) key: String,
    /// What was expected and what was found.
    pub(super) message: String,
    /// What to do, or empty.
    pub(super) help: String,
}

/// Something wrong with the value at a path. An absent value is at its container.
#[derive(Debug)]
pub(super) struct Problem {
    steps: Vec<Step>,
    key: String,
    message: String,
    help: String,
}

impl Problem {
    pub(super) fn new(at: At, message: impl Into<String>, help: impl Into<String>) -> Problem {
        Problem {
            steps: at.steps(),
            key: at.to_string(),
            message: message.into(),
            help: help.into(),
        }
    }

    /// Looks the path up in the text it was read from.
    pub(super) fn locate(self, text: &str) -> Fault {
        let found = serde_yaml::Deserializer::from_str(text)
            .next()
            .and_then(|document| Walk(&self.steps).deserialize(document).err());
        let offset = found.and_then(|e| e.location()).map_or(0, |l| l.index());
        Fault {
            offset,
            key: self.key,
            message: self.message,
            help: self.help,
        }
    }
}

/// A scene file holds one document; this one is too much, if it is one at all.
pub(super) fn second_document(document: serde_yaml::Deserializer, text: &str) -> Fault {
    match Walk(&[]).deserialize(document) {
        // Whatever is not the walk's own failure is text that does not parse.
        Err(e) if !e.to_string().contains(HERE) => refusal::fault(&e, text),
        here => Fault {
            offset: here
                .err()
                .and_then(|e| e.location())
                .map_or(0, |l| l.index()),
            key: String::new(),
            message: "a second YAML document begins here".into(),
            help: "a scene file holds one scene: remove the `---`, or split the file".into(),
        },
    }
}

const HERE: &str = "the place looked for";

/// Goes down the steps left; with none left, fails on whatever stands there.
struct Walk<'s>(&'s [Step]);

impl<'de> DeserializeSeed<'de> for Walk<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<(), D::Error> {
        from.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Walk<'_> {
    type Value = ();

    // A visitor that accepts no scalar: the parser's complaint about it is the answer.
    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(HERE)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        match self.0 {
            [Step::Key(wanted), rest @ ..] => {
                while let Some(key) = map.next_key::<String>()? {
                    if key == *wanted {
                        map.next_value_seed(Walk(rest))?;
                    } else {
                        map.next_value::<IgnoredAny>()?;
                    }
                }
            }
            [Step::Name(wanted), ..] => {
                while map.next_key_seed(Until(wanted))?.is_some() {
                    map.next_value::<IgnoredAny>()?;
                }
            }
            _ => {}
        }
        Err(A::Error::custom(HERE))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<(), A::Error> {
        if let [Step::Index(wanted), rest @ ..] = self.0 {
            for _ in 0..*wanted {
                list.next_element::<IgnoredAny>()?;
            }
            list.next_element_seed(Walk(rest))?;
        }
        Err(A::Error::custom(HERE))
    }
}

/// Reads keys, and fails at the one looked for.
struct Until<'s>(&'s str);

impl<'de> DeserializeSeed<'de> for Until<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<(), D::Error> {
        from.deserialize_str(self)
    }
}

impl Visitor<'_> for Until<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a key")
    }

    fn visit_str<E: Error>(self, key: &str) -> Result<(), E> {
        if key == self.0 {
            return Err(E::custom(HERE));
        }
        Ok(())
    }
}
