//! `springs.stiffness=1e2..1e8:24`: the quantity that varies.

use super::range::{Range, VaryError};
use crate::scene::limits::Bounds;
use crate::scene::model::{PARTICLES, PARTS, Part, RODS, Row, ValueKind};
use crate::scene::object::called;
use crate::scene::words::aside;
use crate::scene::{ObjectNumber, Refusal, Scene, Value};
use std::fmt;

/// A number that acts on the motion: of one member of a part of the scene or of all that are free, or of an object.
#[derive(Debug, Clone)]
pub struct VariedKey {
    /// As the command line writes it: `springs.stiffness`, `particles[1].mass`, `sheet[3,4].drag`, `rope.stiffness`.
    id: String,
    of: Of,
}

#[derive(Debug, Clone)]
enum Of {
    Members(Members),
    Object(ObjectNumber),
}

/// One key of a part, in one member or in all that are free.
#[derive(Debug, Clone, Copy)]
struct Members {
    part: &'static Part,
    row: &'static Row,
    quantity: Bounds,
    member: Option<usize>,
}

/// Every key of members, for all at once.
fn keys() -> impl Iterator<Item = Members> {
    let of = |part: &'static Part| part.rows.iter().map(move |row| (part, row));
    let number = |(part, row): (&'static Part, &'static Row)| match row.kind {
        // A rod has the length of its start, whatever else varies.
        ValueKind::Number(quantity) if row.flat.is_some() && part.key != RODS.key => {
            Some(Members {
                part,
                row,
                quantity,
                member: None,
            })
        }
        _ => None,
    };
    PARTS.into_iter().flat_map(of).filter_map(number)
}

impl VariedKey {
    /// Reads `springs.stiffness`, `springs[3].stiffness` for one member where there is a list, `sheet[3,4].mass` for a
    /// particle by its name, or `rope.stiffness` for a number of an object. Where an object has the name of a part, the
    /// part is meant.
    ///
    /// # Errors
    /// [`VaryError`] when the key is unknown, or acts on nothing in this scene.
    pub fn parse(id: &str, scene: &Scene) -> Result<Self, VaryError> {
        let refused = |why: String| VaryError(format!("{id}: {why}"));
        let of = match Members::find(id, scene).map_err(|refusal| refused(said(refusal)))? {
            Some(members) => {
                members.check(scene).map_err(refused)?;
                Of::Members(members)
            }
            None => {
                let mut numbers = scene.object_numbers().into_iter();
                let number = numbers.find(|number| number.id == id);
                Of::Object(number.ok_or_else(|| unknown(id, scene))?)
            }
        };
        let id = id.to_owned();
        let key = Self { id, of };
        if let Of::Object(_) = &key.of {
            // Two values that every object may have, with any number of particles.
            let [one, other] = [1e-3, 2e-3].map(|value| key.apply(scene, value));
            if one? == other? {
                return Err(refused("the object has none, or it changes nothing".into()));
            }
        }
        Ok(key)
    }

    /// The values a scene file may give it, and their unit.
    pub fn quantity(&self) -> Bounds {
        match &self.of {
            Of::Members(members) => members.quantity,
            Of::Object(number) => number.bounds,
        }
    }

    /// The scene with this value, in the one member or in all that are free.
    ///
    /// # Errors
    /// [`VaryError`] where an object with this value cannot be made.
    pub fn apply(&self, scene: &Scene, value: f64) -> Result<Scene, VaryError> {
        match &self.of {
            Of::Members(members) => Ok(members.apply(scene, value)),
            Of::Object(number) => scene
                .with_number(number, value)
                .map_err(|refusal| VaryError(format!("{}: {}", self.id, said(refusal)))),
        }
    }

    /// The largest magnitude among the values the scene has; of an object that which the file gives, or 0.
    pub fn largest(&self, scene: &Scene) -> f64 {
        match &self.of {
            Of::Members(members) => members.largest(scene),
            Of::Object(number) => number.given.unwrap_or_default().abs(),
        }
    }
}

/// A refusal on one line.
fn said(Refusal { message, help, .. }: Refusal) -> String {
    match help.as_str() {
        "" => message,
        help => format!("{message} ({help})"),
    }
}

/// The error of a key that neither the scene nor its objects have.
fn unknown(id: &str, scene: &Scene) -> VaryError {
    let aside = |id: &str, known: &[String]| {
        let known: Vec<&str> = known.iter().map(String::as_str).collect();
        aside(id, &known)
    };
    let (name, _) = id.split_once(['.', '[']).unwrap_or((id, ""));
    let members: Vec<String> = keys().map(|key| key.to_string()).collect();
    let objects = scene.object_numbers().into_iter().map(|number| number.id);
    let objects: Vec<String> = objects.collect();
    if scene.bodies.iter().any(|body| body.name == name) {
        let of =
            |key: &String, name: &str| key.strip_prefix(name)?.strip_prefix('.').map(String::from);
        // Of one of its particles the keys of particles.
        let (owner, own): (_, Vec<String>) = match id.split_once("].") {
            Some((place, _)) => (
                format!("{place}]"),
                members
                    .iter()
                    .filter_map(|key| of(key, PARTICLES.key))
                    .collect(),
            ),
            None => (
                name.to_owned(),
                objects.iter().filter_map(|key| of(key, name)).collect(),
            ),
        };
        let own: Vec<String> = own.iter().map(|key| format!("{owner}.{key}")).collect();
        let (aside, known) = (aside(id, &own), own.join(", "));
        return VaryError(format!("unknown key `{id}`{aside}; known of it: {known}"));
    }
    let of_objects = objects.first().map_or_else(String::new, |first| {
        format!(", and of an object such as {first}")
    });
    let known = members.join(", ");
    let aside = aside(&plain(id), &[members, objects].concat());
    VaryError(format!(
        "unknown key `{id}`{aside}; known: {known}, and of one member such as springs[3].stiffness or \
         particles[1].mass{of_objects}"
    ))
}

/// The key without the member: `springs.stiffness` of `springs[3].stiffness`.
fn plain(id: &str) -> String {
    let (list, rest) = id.split_once('[').unwrap_or((id, ""));
    let (_, field) = rest.split_once(']').unwrap_or(("", rest));
    format!("{list}{field}")
}

impl Members {
    /// The members that a key means; None where it is no key of members.
    fn find(id: &str, scene: &Scene) -> Result<Option<Self>, Refusal> {
        let plain = plain(id);
        let (list, rest) = id.split_once('[').unwrap_or((id, ""));
        let (index, field) = rest.split_once(']').unwrap_or(("", ""));
        let is_part = |part: &&Part| part.inside().map_or(part.key, |(list, _)| list) == list;
        if !field.is_empty() && !scene.bodies.is_empty() && !PARTS.iter().any(is_part) {
            let member = scene.particle_named(&format!("{list}[{index}]"))?;
            let plain = format!("{}{field}", PARTICLES.key);
            let found = keys().find(|key| key.to_string() == plain);
            return Ok(found.map(|key| Self {
                member: Some(member),
                ..key
            }));
        }
        let member = index.parse().ok();
        let found = keys().find(|key| {
            let listed = key.part.list || key.part.inside().is_some();
            key.to_string() == plain && (plain == id || listed && member.is_some())
        });
        Ok(found.map(|key| Self { member, ..key }))
    }

    /// Whether it acts on something in this scene, or why not.
    fn check(&self, scene: &Scene) -> Result<(), String> {
        let count = (self.part.count)(scene);
        Err(match self.member {
            Some(at) if at >= count => format!("the scene has {count} of these, from 0"),
            Some(at) if !self.free(scene, at) && self.part.key == PARTICLES.key => {
                let particle = called(&scene.bodies, at);
                format!("particle {particle} is fixed: it changes nothing")
            }
            Some(at) if !self.free(scene, at) => "this one has none".into(),
            None if self.members(scene).next().is_none() => "the scene has none".into(),
            _ if self.is_vector(scene) => {
                "the scene gives vectors here: only a number can be varied".into()
            }
            _ => return Ok(()),
        })
    }

    /// Whether the scene has vectors in the place of the number.
    fn is_vector(&self, scene: &Scene) -> bool {
        let other = |row: &&Row| row.key == self.row.key && !std::ptr::eq(*row, self.row);
        let mut others = self.part.rows.iter().filter(other);
        others.any(|row| (row.get)(scene, 0, 0).is_some())
    }

    fn apply(&self, scene: &Scene, value: f64) -> Scene {
        let mut varied = scene.clone();
        for at in self.members(scene) {
            (self.row.set)(&mut varied, at, 0, Value::Number(value));
        }
        varied
    }

    fn largest(&self, scene: &Scene) -> f64 {
        let magnitude = |at| match (self.row.get)(scene, at, 0) {
            Some(Value::Number(value)) => value.abs(),
            _ => 0.0,
        };
        self.members(scene).map(magnitude).fold(0.0, f64::max)
    }

    fn members<'s>(&'s self, scene: &'s Scene) -> impl Iterator<Item = usize> + 's {
        let count = (self.part.count)(scene);
        let members = self.member.map_or(0..count, |at| at..at + 1);
        members.filter(|at| self.free(scene, *at))
    }

    /// Whether the key acts on this member: a fixed particle has neither inertia nor drag.
    fn free(&self, scene: &Scene, at: usize) -> bool {
        let there = (self.row.get)(scene, at, 0).is_some();
        let fixed = || scene.particles.get(at).is_some_and(|p| p.fixed);
        there && !(self.part.key == PARTICLES.key && fixed())
    }
}

impl fmt::Display for Members {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.part.path(self.member, self.row.key))
    }
}

impl fmt::Display for VariedKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.id)
    }
}

/// One quantity of a scene and its values.
#[derive(Debug, Clone)]
pub struct Vary {
    key: VariedKey,
    /// Ascending.
    pub values: Vec<f64>,
}

impl Vary {
    /// Reads `KEY=A..B[:N]` for this scene.
    ///
    /// # Errors
    /// [`VaryError`] when the key is unknown, the scene has no such member, or the values leave the bounds
    /// of a scene file or of what objects make of them.
    pub fn parse(text: &str, scene: &Scene) -> Result<Self, VaryError> {
        let (id, range) = text
            .split_once('=')
            .ok_or_else(|| VaryError(format!("expected KEY=A..B or KEY=A..B:N, found `{text}`")))?;
        let refused = |why: String| VaryError(format!("{id}: {why}"));
        let key = VariedKey::parse(id, scene)?;
        let range: Range = range.parse().map_err(|VaryError(why)| refused(why))?;
        let Bounds { low, high, unit } = key.quantity();
        let outside = |end: &f64| !(low..=high).contains(end);
        if let Some(found) = [range.low, range.high].into_iter().find(outside) {
            return Err(refused(format!(
                "expected values from {low:e} to {high:e} ({unit}), found {found}"
            )));
        }
        // What lies between two values that objects may have they may have too: every bound is one of a multiple.
        key.apply(scene, range.low)?;
        key.apply(scene, range.high)?;
        let values = range.values();
        Ok(Self { key, values })
    }

    /// The key as the command line writes it: `springs.stiffness`, `particles[1].mass`.
    pub fn id(&self) -> String {
        self.key.to_string()
    }

    /// The unit of the values.
    pub fn unit(&self) -> &'static str {
        self.key.quantity().unit
    }

    /// The scene with this value.
    ///
    /// # Errors
    /// [`VaryError`] where an object with this value cannot be made.
    pub fn apply(&self, scene: &Scene, value: f64) -> Result<Scene, VaryError> {
        self.key.apply(scene, value)
    }
}
