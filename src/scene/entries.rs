//! What stands under `expect`: mappings whose keys are judged later, since they belong to other
//! stages, and the values they may have. Everything here is bounded: aliases multiply.

use super::limits::{EXPECTED, WORD_BYTES};
use super::raw::RawBounds;
use super::refusal::refuse;
use super::shown::shorten;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserialize, DeserializeSeed, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use std::fmt;
use std::marker::PhantomData;

/// A mapping, in its order: each key at most once.
#[derive(Debug)]
pub(super) struct Entries<T>(pub(super) Vec<(String, T)>);

/// A short text.
#[derive(Debug)]
pub(super) struct Word(pub(super) String);

/// What is expected of a key.
#[derive(Debug)]
pub(super) enum RawWanted {
    Word(Word),
    Words(Vec<Word>),
    Bounds(RawBounds),
}

struct Reader<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Entries<T> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(Reader::<Self>(PhantomData))
    }
}

impl<'de, T: Deserialize<'de>> Visitor<'de> for Reader<Entries<T>> {
    type Value = Entries<T>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a mapping such as {status: completed}")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Entries<T>, A::Error> {
        let mut entries: Vec<(String, T)> = Vec::new();
        while let Some(key) = map.next_key_seed(Fresh(&entries))? {
            entries.push((key, map.next_value()?));
        }
        Ok(Entries(entries))
    }
}

/// Reads a key that is not among those before it; fails at the key itself.
struct Fresh<'s, T>(&'s [(String, T)]);

impl<'de, T> DeserializeSeed<'de> for Fresh<'_, T> {
    type Value = String;

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<String, D::Error> {
        from.deserialize_str(self)
    }
}

impl<T> Visitor<'_> for Fresh<'_, T> {
    type Value = String;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a key")
    }

    fn visit_str<E: Error>(self, key: &str) -> Result<String, E> {
        let Word(key) = word(key)?;
        if self.0.iter().any(|(before, _)| *before == key) {
            return Err(refuse(&key, "this key is given twice", "keep one of them"));
        }
        if self.0.len() >= EXPECTED {
            return Err(refuse("", &format!("expected at most {EXPECTED} keys"), ""));
        }
        if key == "<<" {
            let help = "write the keys out, or alias a whole value";
            return Err(refuse("", "merge keys (`<<`) are not applied", help));
        }
        Ok(key)
    }
}

fn word<E: Error>(text: &str) -> Result<Word, E> {
    if text.len() > WORD_BYTES {
        let message = format!(
            "expected at most {WORD_BYTES} bytes, found `{}`",
            shorten(text)
        );
        return Err(refuse("", &message, ""));
    }
    Ok(Word(text.to_owned()))
}

impl<'de> Deserialize<'de> for Word {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(Reader::<Self>(PhantomData))
    }
}

impl Visitor<'_> for Reader<Word> {
    type Value = Word;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("text (in quotes if it looks like something else)")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Word, E> {
        word(text)
    }
}

impl<'de> Deserialize<'de> for RawWanted {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(Reader::<Self>(PhantomData))
    }
}

impl<'de> Visitor<'de> for Reader<RawWanted> {
    type Value = RawWanted;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a word, a list of words, or bounds such as {below: 1e-3}")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<RawWanted, E> {
        word(text).map(RawWanted::Word)
    }

    fn visit_bool<E: Error>(self, truth: bool) -> Result<RawWanted, E> {
        Ok(RawWanted::Word(Word(truth.to_string())))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<RawWanted, A::Error> {
        let mut words = Vec::new();
        while let Some(word) = list.next_element()? {
            if words.len() >= EXPECTED {
                let message = format!("expected at most {EXPECTED} words");
                return Err(refuse("", &message, ""));
            }
            words.push(word);
        }
        Ok(RawWanted::Words(words))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<RawWanted, A::Error> {
        RawBounds::deserialize(MapAccessDeserializer::new(map)).map(RawWanted::Bounds)
    }
}
