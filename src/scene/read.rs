//! Reads the file by the table of [`parameters`](super::parameters): known keys, each at most once, with
//! values of their kind and within their bounds.
//!
//! The values are judged as they stream by and go straight into the [`Scene`], never through a free-form value,
//! whose aliases and nesting a hostile file can multiply. What concerns several values waits for the
//! end: [`complete`](super::complete) judges it.

use super::error::{Fault, Refusal};
use super::expect::Engines;
use super::expectation::Names;
use super::limits::known;
use super::model::Scene;
use super::parameters::{Absent, Kind, Part, Row, SCENE, Value};
use super::place::{Problem, fault, refuse, second_document};
use super::values::{Any, Key, Maybe, Number, Numbers, flag, number, text};
use super::words::{about_key, shorten};
use serde::de::{DeserializeSeed, Deserializer, MapAccess, SeqAccess, Visitor};
use std::fmt;
use std::path::Path;

/// A scene while it is read.
pub(super) struct Reading<'n> {
    pub(super) scene: Scene,
    pub(super) names: &'n Names,
    /// Members without a key whose default follows from the rest of the scene.
    pub(super) absent: Vec<(&'static str, usize)>,
    /// The first id that is no whole number from 0, and where: the message says how many particles there are.
    pub(super) no_id: Option<(String, Number)>,
    /// The first unknown key under `expect`: the value it has may say better what is wrong.
    pub(super) unknown: Option<Problem>,
}

impl<'n> Reading<'n> {
    /// Nothing yet; the name is the file's.
    pub(super) fn new(file: &str, names: &'n Names) -> Reading<'n> {
        let mut scene = Scene {
            file: file.to_owned(),
            ..Scene::default()
        };
        if let Some(stem) = Path::new(file).file_stem() {
            scene.name = stem.to_string_lossy().replace(char::is_control, " ");
        }
        Reading {
            scene,
            names,
            absent: Vec::new(),
            no_id: None,
            unknown: None,
        }
    }
}

/// Reads the one document the file holds into the scene.
pub(super) fn document(text: &str, reading: &mut Reading) -> Result<(), Fault> {
    let mut documents = serde_yaml::Deserializer::from_str(text);
    let scene = Any(Mapping(&SCENE, reading));
    let first = match documents.next() {
        Some(document) => Maybe(scene)
            .deserialize(document)
            .map_err(|e| fault(&e, text))?,
        None => None,
    };
    if let Some(second) = documents.next() {
        return Err(second_document(second, text));
    }
    first.ok_or_else(|| Fault {
        offset: 0,
        refusal: Refusal::new(
            "the file holds no scene",
            "a scene needs at least `solver` and `particles`",
        ),
    })
}

/// Reads one mapping as a member of the part.
struct Mapping<'r, 'n>(&'static Part, &'r mut Reading<'n>);

impl<'de> Visitor<'de> for Mapping<'_, '_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.0.expected)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let Mapping(part, reading) = self;
        (part.add)(&mut reading.scene);
        let at = (part.count)(&reading.scene) - 1;
        // Bit i: the key of row i was there, and had a value.
        let (mut seen, mut given) = (0_u32, 0_u32);
        while let Some(index) = map.next_key_seed(Key(|key: &str| row_of(part, key, &mut seen)))? {
            let value = Entry {
                part,
                row: &part.rows[index],
                at,
                reading: &mut *reading,
            };
            if map.next_value_seed(Maybe(value))?.is_some() {
                given |= 1 << index;
            }
        }
        for (index, row) in part.rows.iter().enumerate() {
            match row.absent {
                _ if given & (1 << index) != 0 => {}
                Absent::Required(help) => {
                    return Err(refuse(Refusal::new("missing", help).of(row.key)));
                }
                Absent::Derived => reading.absent.push((row.key, at)),
                Absent::Default => {}
            }
        }
        Ok(())
    }
}

/// The row of a key that was not there before.
fn row_of(part: &Part, key: &str, seen: &mut u32) -> Result<usize, Refusal> {
    if let Some(index) = part.rows.iter().position(|row| row.key == key) {
        if *seen & (1 << index) != 0 {
            return Err(twice(key));
        }
        *seen |= 1 << index;
        return Ok(index);
    }
    if part.later.contains(&key) {
        let help = "remove the key to run the rest of the scene";
        return Err(Refusal::new("not supported yet", help).of(key));
    }
    no_merge(key)?;
    let keys: Vec<&str> = part.rows.iter().map(|row| row.key).collect();
    Err(unknown(key, &keys))
}

pub(super) fn twice(key: &str) -> Refusal {
    Refusal::new("this key is given twice", "keep one of them").of(key)
}

pub(super) fn unknown(key: &str, known: &[&str]) -> Refusal {
    let message = format!("unknown key `{}`", shorten(key));
    Refusal::new(message, about_key(key, known))
}

pub(super) fn no_merge(key: &str) -> Result<(), Refusal> {
    match key {
        "<<" => Refusal::because(
            "merge keys (`<<`) are not applied",
            "write the keys out, or alias a whole value",
        ),
        _ => Ok(()),
    }
}

/// Reads the value of a row.
struct Entry<'r, 'n> {
    part: &'static Part,
    row: &'static Row,
    at: usize,
    reading: &'r mut Reading<'n>,
}

impl Entry<'_, '_> {
    fn set(&mut self, value: Value<'_>) {
        (self.row.set)(&mut self.reading.scene, self.at, value);
    }

    /// The id; of what is none, the largest number, which is no id either.
    fn id(&mut self, index: &str, number: Number) -> usize {
        let Entry { part, row, at, .. } = *self;
        number.whole().unwrap_or_else(|| {
            let member = if part.list {
                format!("[{at}]")
            } else {
                String::new()
            };
            let path = || format!("{}{member}.{}{index}", part.key, row.key);
            self.reading.no_id.get_or_insert_with(|| (path(), number));
            usize::MAX
        })
    }
}

impl<'de> DeserializeSeed<'de> for Entry<'_, '_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(mut self, from: D) -> Result<(), D::Error> {
        match self.row.kind {
            Kind::Number(quantity) => {
                let number = from.deserialize_any(number(|n| quantity.judge(n)))?;
                self.set(Value::Numbers(&[number]));
            }
            Kind::Numbers(count, quantity) => {
                let mut room = [0.0; 3];
                from.deserialize_any(Numbers(&mut room[..count], |_, n| quantity.judge(n)))?;
                self.set(Value::Numbers(&room[..count]));
            }
            Kind::Ids(1) => {
                let id = from.deserialize_any(number(|n| Ok(self.id("", n))))?;
                self.set(Value::Ids(&[id]));
            }
            Kind::Ids(count) => {
                let mut room = [0; 2];
                let id = |index, n| Ok(self.id(&format!("[{index}]"), n));
                from.deserialize_any(Numbers(&mut room[..count], id))?;
                self.set(Value::Ids(&room[..count]));
            }
            Kind::Coordinate => {
                let coordinate = from.deserialize_any(number(coordinate))?;
                self.set(Value::Ids(&[coordinate]));
            }
            Kind::Flag => {
                let flag = from.deserialize_any(flag())?;
                self.set(Value::Flag(flag));
            }
            Kind::Word(words) => from.deserialize_any(text(|word| {
                known(word, words, "choice")?;
                self.set(Value::Text(word));
                Ok(())
            }))?,
            Kind::Text(judge) => from.deserialize_any(text(|text| {
                judge(text, self.reading.names)?;
                self.set(Value::Text(text));
                Ok(())
            }))?,
            Kind::Part(part) if part.list => from.deserialize_any(List(part, self.reading))?,
            Kind::Part(part) => from.deserialize_any(Mapping(part, self.reading))?,
            Kind::Expect => from.deserialize_any(Engines(self.reading))?,
        }
        Ok(())
    }
}

fn coordinate(number: Number) -> Result<usize, Refusal> {
    match number.whole() {
        Some(coordinate @ 0..=2) => Ok(coordinate),
        _ => Refusal::because(
            format!("expected a coordinate, 0, 1 or 2, found {number}"),
            "0 is x, 1 is y, 2 is z",
        ),
    }
}

/// Reads a list of mappings.
struct List<'r, 'n>(&'static Part, &'r mut Reading<'n>);

impl<'de> Visitor<'de> for List<'_, '_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a list")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<(), A::Error> {
        let List(part, reading) = self;
        let mut one = || list.next_element_seed(Any(Mapping(part, &mut *reading)));
        while one()?.is_some() {}
        Ok(())
    }
}
