//! Mappings with known keys: each at most once, an unknown one answered with the nearest known.

use super::refusal::refuse;
use super::shown::shorten;
use super::suggest;
use serde::de::{DeserializeSeed, Deserializer, Error, Visitor};
use std::fmt;

/// Reads one key after the other. It fails at the key itself, which is what gives a misspelt or
/// repeated key its exact place.
pub(super) struct Keys {
    known: &'static [&'static str],
    /// Named by the format, not read by this version.
    later: &'static [&'static str],
    /// Bit i: `known[i]` has been seen.
    seen: u32,
}

impl Keys {
    pub(super) fn new(known: &'static [&'static str], later: &'static [&'static str]) -> Keys {
        assert!(known.len() <= 32);
        Keys {
            known,
            later,
            seen: 0,
        }
    }
}

impl<'de> DeserializeSeed<'de> for &mut Keys {
    type Value = &'static str;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<&'static str, D::Error> {
        deserializer.deserialize_str(self)
    }
}

impl Visitor<'_> for &mut Keys {
    type Value = &'static str;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a key")
    }

    fn visit_str<E: Error>(self, key: &str) -> Result<&'static str, E> {
        if let Some(index) = self.known.iter().position(|k| *k == key) {
            if self.seen & (1 << index) != 0 {
                return Err(refuse(key, "this key is given twice", "keep one of them"));
            }
            self.seen |= 1 << index;
            return Ok(self.known[index]);
        }
        if self.later.contains(&key) {
            let help = "remove the key to run the rest of the scene";
            return Err(refuse(key, "not supported yet", help));
        }
        if key == "<<" {
            let help = "write the keys out, or alias a whole value";
            return Err(refuse("", "merge keys (`<<`) are not applied", help));
        }
        let message = format!("unknown key `{}`", shorten(key));
        Err(refuse("", &message, &suggest::key(key, self.known)))
    }
}

/// Declares what a mapping of the file holds: key, field, type. Every field is optional here; what
/// is required is the validation's business. A key without a value counts as absent.
macro_rules! mapping {
    (
        $(#[$doc:meta])*
        $name:ident: $what:literal;
        $($key:literal => $field:ident: $type:ty,)*
        later $later:expr
    ) => {
        $(#[$doc])*
        #[derive(Debug, Default)]
        pub(super) struct $name {
            $(pub(super) $field: Option<$type>,)*
        }

        impl<'de> serde::Deserialize<'de> for $name {
            fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
                struct Fields;

                impl<'de> serde::de::Visitor<'de> for Fields {
                    type Value = $name;

                    fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
                        f.write_str($what)
                    }

                    fn visit_map<A>(self, mut map: A) -> Result<$name, A::Error>
                    where
                        A: serde::de::MapAccess<'de>,
                    {
                        let mut read = $name::default();
                        let mut keys = Keys::new(&[$($key),*], $later);
                        while let Some(key) = map.next_key_seed(&mut keys)? {
                            match key {
                                $($key => read.$field = map.next_value()?,)*
                                _ => unreachable!("Keys answers with known keys only"),
                            }
                        }
                        Ok(read)
                    }
                }

                from.deserialize_any(Fields)
            }
        }
    };
}
pub(super) use mapping;
