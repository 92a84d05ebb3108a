//! Objects as a file writes them: a few lines that stand for many members. What they make of a scene stands in
//! [`Scene::expand`](super::Scene::expand).

use super::table::Field;
use schemars::JsonSchema;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Serialize, Serializer};
use std::fmt;

/// The name of a particle of an object, as a regular expression of ECMA-262.
pub const PARTICLE_NAME: &str =
    r"^ *[A-Za-z][A-Za-z0-9_-]{0,63} *\[ *[0-9]+ *(, *[0-9]+ *){0,2}\] *$";

/// One entry under `objects`: one of these.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("minProperties" = 1, "maxProperties" = 1))]
pub struct Object {
    /// Particles in a row, joined by springs or rods.
    pub string: Option<Strand>,
    /// The same as `string`.
    pub chain: Option<Strand>,
    /// A string that resists bending, and may be clamped at its root.
    pub hair: Option<Hair>,
    /// A sheet of particles with structural, shear and flexion springs.
    pub cloth: Option<Cloth>,
    /// A sheet with structural springs alone.
    pub net: Option<Net>,
    /// A block of particles.
    pub lattice: Option<Lattice>,
}

impl Object {
    /// Cuts each of its links into so many.
    pub(super) fn refine(&mut self, links: u64, scaling: Scaling) {
        let Self {
            string,
            chain,
            hair,
            cloth,
            net,
            lattice,
        } = self;
        for strand in [string, chain].into_iter().flatten() {
            strand.refine(links, scaling);
        }
        if let Some(hair) = hair {
            hair.refine(links, scaling);
        }
        if let Some(cloth) = cloth {
            cloth.refine(links, scaling);
        }
        if let Some(net) = net {
            net.refine(links, scaling);
        }
        if let Some(lattice) = lattice {
            lattice.refine(links, scaling);
        }
    }
}

/// The particles of an object, by their places in it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "NamedParticles")]
pub struct Body {
    /// The object's name.
    pub name: String,
    /// The id of its first particle.
    pub first: usize,
    /// How many particles it has along each of its directions, the first of which counts slowest.
    pub shape: Vec<usize>,
}

impl Body {
    /// The id of the particle at this place; None outside.
    pub fn id(&self, place: &[usize]) -> Option<usize> {
        let inside = place.len() == self.shape.len()
            && place.iter().zip(&self.shape).all(|(at, count)| at < count);
        let along = |sum, (at, count): (&usize, &usize)| sum * count + at;
        inside.then(|| self.first + place.iter().zip(&self.shape).fold(0, along))
    }

    /// Where particle `id` is in it; None where it is not.
    pub fn place(&self, id: usize) -> Option<Vec<usize>> {
        let mut rest = id.checked_sub(self.first)?;
        let mut place = vec![0; self.shape.len()];
        for (at, count) in place.iter_mut().zip(&self.shape).rev() {
            *at = rest.checked_rem(*count)?;
            rest /= count;
        }
        (rest == 0).then_some(place)
    }

    /// `sheet[3,4]`
    pub fn called(&self, place: &[usize]) -> String {
        let place: Vec<String> = place.iter().map(usize::to_string).collect();
        format!("{}[{}]", self.name, place.join(","))
    }

    /// `sheet[0..29, 0..19]`
    pub(super) fn range(&self) -> String {
        let ranges = self.shape.iter().map(|count| format!("0..{}", count - 1));
        format!("{}[{}]", self.name, ranges.collect::<Vec<_>>().join(", "))
    }
}

/// The name of a particle that an object made, such as `sheet[3,4]`.
pub fn particle_name(bodies: &[Body], id: usize) -> Option<String> {
    let mut names = bodies
        .iter()
        .filter_map(|body| Some(body.called(&body.place(id)?)));
    names.next()
}

/// The same, or the id of a particle without a name: what people call it.
pub fn called(bodies: &[Body], id: usize) -> String {
    particle_name(bodies, id).unwrap_or_else(|| id.to_string())
}

/// Objects have a reader of their own, and no rows.
impl Field for Vec<Object> {}

/// A spring of an object.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Link {
    /// k, N/m.
    pub stiffness: f64,
    /// c, N s/m.
    #[serde(default)]
    pub damping: f64,
}

/// What joins neighbours: springs, or rods.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Links {
    Springs(Link),
    /// Exact distances; `rods` in the file.
    Rods,
}

/// The word for rods.
const RODS: &str = "rods";

impl Serialize for Links {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Springs(link) => link.serialize(to),
            Self::Rods => RODS.serialize(to),
        }
    }
}

impl<'de> Deserialize<'de> for Links {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(ReadLinks)
    }
}

struct ReadLinks;

impl<'de> Visitor<'de> for ReadLinks {
    type Value = Links;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a mapping with `stiffness`, or the word rods")
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<Links, E> {
        match word {
            RODS => Ok(Links::Rods),
            _ => Err(E::unknown_variant(word, &[RODS])),
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, keys: A) -> Result<Links, A::Error> {
        Link::deserialize(MapAccessDeserializer::new(keys)).map(Links::Springs)
    }
}

impl JsonSchema for Links {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Links".into()
    }

    fn json_schema(from: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let springs = from.subschema_for::<Link>();
        schemars::json_schema!({
            "description": "Springs with these numbers, or the word rods for exact distances.",
            "anyOf": [springs, {"const": RODS}]
        })
    }
}

/// A hinge of an object.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
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
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Scaling {
    /// They follow the links, so that the object stays the same.
    #[default]
    Continuum,
    /// Each particle and each link keeps its own.
    None,
}

/// What is fixed: a word, such as `start` or `corner00`, or a place, such as 3 or [3, 4].
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
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

/// What every kind of object may say.
#[derive(Debug, Clone, Default)]
pub(super) struct Options {
    pub name: Option<String>,
    pub mass: Option<f64>,
    pub particle_mass: Option<f64>,
    pub radius: Option<f64>,
    pub drag: Option<f64>,
    pub velocity: Option<[f64; 3]>,
    pub refine: Option<u64>,
    pub scaling: Scaling,
    pub pins: Vec<Pin>,
}

/// Declares a kind of object: its own keys, and those that all have.
macro_rules! object {
    ($(#[$about:meta])* $name:ident { $($(#[$note:meta])* $field:ident: $of:ty,)* }) => {
        $(#[$about])*
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
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
            /// Cuts each of its links into so many.
            fn refine(&mut self, links: u64, scaling: Scaling) {
                self.refine = Some(self.refine.unwrap_or(1).saturating_mul(links));
                self.scaling = scaling;
            }

            pub(super) fn common(&self) -> Options {
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

object! {
    /// Particles in a row, joined by springs.
    ///
    /// Refined n times, a link becomes n links of n times its stiffness and damping, with an nth of its mass: N
    /// springs in a row are as stiff as one of k/N.
    Strand {
        /// The first particle, m.
        from: [f64; 3],
        /// The last, m.
        to: [f64; 3],
        /// How many particles it has, both ends included.
        particles: u64,
        /// k of each spring, N/m.
        stiffness: Option<f64>,
        /// c of each spring, N s/m.
        damping: Option<f64>,
        /// In the place of `stiffness` and `damping`: `rods` for a string that does not stretch.
        structural: Option<Links>,
        /// Rest lengths over the distances at the start, 1 by default.
        rest_ratio: Option<f64>,
    }
}

object! {
    /// A string that resists bending, and may be clamped at its root.
    ///
    /// A hinge at the middle of links of length l has kb = EI/l: refined n times it is n times as stiff.
    Hair {
        /// The root, m.
        from: [f64; 3],
        /// The tip, m.
        to: [f64; 3],
        /// How many particles it has, both ends included.
        particles: u64,
        /// The springs between neighbours, or `rods`.
        structural: Links,
        /// The hinges at all particles between two.
        bending: Hinge,
        /// The direction in which it leaves its root, which is fixed then. The hinge there stands for half a link and
        /// has 2 kb; a fixed particle of no motion behind the root is its third.
        clamp: Option<[f64; 3]>,
        /// Rest lengths over the distances at the start, 1 by default.
        rest_ratio: Option<f64>,
    }
}

object! {
    /// A sheet of particles in a plane, with springs along its threads and across.
    ///
    /// Refined n times it keeps its springs and has an nth² of their masses: a membrane of square cells is as stiff
    /// whatever their number. Flexion springs have no such limit.
    Cloth {
        /// The corner [0, 0], m.
        origin: [f64; 3],
        /// From there to the last particle of the first direction, m.
        u: Option<[f64; 3]>,
        /// From there to the last particle of the second direction, m.
        v: Option<[f64; 3]>,
        /// In the place of `u` and `v`: xy, xz or yz, with `size`.
        plane: Option<String>,
        /// Its two sides in that plane, m.
        size: Option<[f64; 2]>,
        /// How many particles it has along u and v.
        particles: [u64; 2],
        /// Springs between neighbours along u and v, or `rods`.
        structural: Links,
        /// Springs across each cell, both ways.
        shear: Option<Link>,
        /// Springs between every second particle along u and v.
        flexion: Option<Link>,
        /// Drag coefficient C of its triangles, two a cell.
        air_drag: Option<f64>,
        /// Rest lengths over the distances at the start, 1 by default.
        rest_ratio: Option<f64>,
    }
}

object! {
    /// A sheet with springs along its threads alone.
    Net {
        /// The corner [0, 0], m.
        origin: [f64; 3],
        /// From there to the last particle of the first direction, m.
        u: Option<[f64; 3]>,
        /// From there to the last particle of the second direction, m.
        v: Option<[f64; 3]>,
        /// In the place of `u` and `v`: xy, xz or yz, with `size`.
        plane: Option<String>,
        /// Its two sides in that plane, m.
        size: Option<[f64; 2]>,
        /// How many particles it has along u and v.
        particles: [u64; 2],
        /// Springs between neighbours.
        structural: Link,
        /// Rest lengths over the distances at the start, 1 by default, 0 for springs without a rest length.
        rest_ratio: Option<f64>,
    }
}

object! {
    /// A block of particles.
    ///
    /// Refined n times its springs have an nth of their stiffness, and its particles an nth³ of their mass.
    Lattice {
        /// The corner [0, 0, 0], m.
        origin: [f64; 3],
        /// From there to the last particle of the first direction, m.
        u: [f64; 3],
        /// Of the second, m.
        v: [f64; 3],
        /// Of the third, m.
        w: [f64; 3],
        /// How many particles it has along u, v and w.
        particles: [u64; 3],
        /// Springs between neighbours.
        structural: Link,
        /// Springs across each face of a cell, both ways.
        shear: Option<Link>,
        /// Springs through each cell, all four ways.
        diagonal: Option<Link>,
        /// Rest lengths over the distances at the start, 1 by default.
        rest_ratio: Option<f64>,
    }
}
