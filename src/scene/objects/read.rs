//! What objects have in common, as the file writes it.

use schemars::JsonSchema;
use serde::Deserialize;
use serde::de::{Deserializer, Error, SeqAccess, Visitor};
use std::fmt;

/// A spring of an object.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Link {
    /// k, N/m.
    pub stiffness: f64,
    /// c, N s/m.
    #[serde(default)]
    pub damping: f64,
}

/// A hinge of an object.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Hinge {
    /// kb, N m/rad.
    pub stiffness: f64,
    /// N m s/rad.
    #[serde(default)]
    pub damping: f64,
    /// rad; 0 is straight.
    #[serde(default)]
    pub rest_angle: f64,
}

/// What refining does to masses, stiffnesses and dampers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Scaling {
    /// They follow the links, so that the object stays the same.
    #[default]
    Continuum,
    /// Each particle and each link keeps its own.
    None,
}

/// What is fixed: a word, such as `start` or `corner00`, or a place, such as 3 or [3, 4].
#[derive(Debug, Clone, PartialEq)]
pub enum Pin {
    /// A corner, an edge, an end.
    Word(String),
    /// A particle of the file, before it is refined.
    Place(Vec<u64>),
}

impl<'de> Deserialize<'de> for Pin {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(Read)
    }
}

struct Read;

impl<'de> Visitor<'de> for Read {
    type Value = Pin;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a word such as start or corner00, or a place such as 3 or [3, 4]")
    }

    fn visit_u64<E: Error>(self, place: u64) -> Result<Pin, E> {
        Ok(Pin::Place(vec![place]))
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<Pin, E> {
        Ok(Pin::Word(word.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Pin, A::Error> {
        let mut place = Vec::new();
        while let Some(at) = list.next_element()? {
            place.push(at);
        }
        Ok(Pin::Place(place))
    }
}

impl JsonSchema for Pin {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Pin".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({
            "description": "A word such as start or corner00, or a place such as 3 or [3, 4].",
            "anyOf": [
                {"type": "string"},
                {"type": "integer", "minimum": 0},
                {"type": "array", "items": {"type": "integer", "minimum": 0}}
            ]
        })
    }
}

/// Declares a kind of object: its own keys, and those that all have.
macro_rules! object {
    ($(#[$about:meta])* $name:ident { $($(#[$note:meta])* $field:ident: $of:ty,)* }) => {
        $(#[$about])*
        #[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields)]
        pub struct $name {
            /// What its particles are called by: `name[3]`; the kind of the object where there is none.
            pub name: Option<String>,
            $($(#[$note])* pub $field: $of,)*
            /// Of the whole object, kg; particles at an end stand for half a link, and weigh half.
            pub mass: Option<f64>,
            /// Of each particle, kg, at the ends too.
            pub particle_mass: Option<f64>,
            /// Of each particle, m, for contact.
            pub radius: Option<f64>,
            /// Drag coefficient of each particle, N s/m.
            pub drag: Option<f64>,
            /// Of all that are not pinned, m/s.
            pub vel: Option<[f64; 3]>,
            /// What does not move.
            #[serde(default)]
            pub pins: Vec<Pin>,
            /// How many links each link becomes.
            pub refine: Option<u64>,
            /// What refining does to masses and stiffnesses.
            #[serde(default)]
            pub scaling: Scaling,
        }

        impl $name {
            fn common(&self) -> Options {
                Options {
                    name: self.name.clone(),
                    mass: self.mass,
                    particle_mass: self.particle_mass,
                    radius: self.radius,
                    drag: self.drag,
                    velocity: self.vel,
                    refine: self.refine,
                    scaling: self.scaling,
                    pins: self.pins.clone(),
                }
            }
        }
    };
}
pub(super) use object;
