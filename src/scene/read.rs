//! Reads the file by the table of the [model](super::model): known keys, each at most once, with values
//! of their kind and within their bounds.
//!
//! Values are checked as the parser delivers them and go straight into the [`Scene`], never through a
//! free-form value, whose aliases and nesting a hostile file can multiply. Checks that involve several
//! values wait for the end: [`complete`](super::complete) does them.

use super::error::{Fault, Refusal};
use super::expect::Engines;
use super::expectation::Names;
use super::limits::{Bounds, EXPECTED, known, method};
use super::model::{Absent, Named, Part, Row, SCENE, Scene, ValueKind};
use super::place::{Problem, fault, second_document};
use super::table::Value;
use super::values::{
    Any, Id, Ids, Key, Maybe, Number, Numbers, Table, Texts, flag, id, index_of, number, text,
};
use super::vectors::{Either, NumberOrList, vectors};
use serde::Deserialize;
use serde::de::{DeserializeSeed, Deserializer, MapAccess, SeqAccess, Visitor};
use std::fmt;

/// A scene while it is read.
pub(super) struct Reading<'n> {
    pub(super) scene: Scene,
    pub(super) names: &'n Names,
    /// The first id that is no whole number from 0, with its path. The message needs the number of particles,
    /// so it waits for the end.
    pub(super) no_id: Option<(String, Number)>,
    /// Particles that are named, in the order of the file: objects, which may stand below, make the names.
    pub(super) named: Vec<Named>,
    /// The first key that is missing, or unknown under `expect`. Errors of the parser in the rest of the
    /// file take precedence.
    pub(super) problem: Option<Problem>,
}

/// Reads the one document the file holds.
pub(super) fn document(text: &str, reading: &mut Reading) -> Result<(), Fault> {
    let mut documents = serde_yaml::Deserializer::from_str(text);
    let scene = Any(Mapping {
        part: &SCENE,
        row: None,
        at: 0,
        reading,
    });
    let first = match documents.next() {
        Some(document) => Maybe(scene)
            .deserialize(document)
            .map_err(|e| fault(&e, text))?,
        None => None,
    };
    if let Some(second) = documents.next() {
        return Err(second_document(second, text));
    }
    let help = "a scene needs at least `solver` and `particles`";
    first.ok_or_else(|| Fault::new(0, "the file holds no scene", help))
}

/// Reads one mapping as a member of a part.
struct Mapping<'r, 'n> {
    part: &'static Part,
    /// The row that adds the member; None for the file itself.
    row: Option<&'static Row>,
    /// The index of the mapping that the row is of.
    at: usize,
    reading: &'r mut Reading<'n>,
}

impl<'de> Visitor<'de> for Mapping<'_, '_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.part.expected)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let Mapping {
            part,
            row,
            at,
            reading,
        } = self;
        if let Some(row) = row {
            (row.set)(&mut reading.scene, at, 0, Value::Flag(true));
        }
        let at = match part.inside() {
            Some(_) => at,
            None => (part.count)(&reading.scene) - 1,
        };
        // Bit i of `seen`: the key of row i occurred. Bit i of `given`: it had a value.
        let (mut seen, mut given) = (0_u32, 0_u32);
        while let Some(index) = map.next_key_seed(Key(|key: &str| row_of(part, key, &mut seen)))? {
            let row = &part.rows[index];
            let reading = &mut *reading;
            let value = Entry {
                part,
                row,
                at,
                reading,
            };
            if map.next_value_seed(Maybe(value))?.is_some() {
                given |= 1 << index;
            }
        }
        for (index, row) in part.rows.iter().enumerate() {
            match row.absent {
                _ if given & (1 << index) != 0 => {}
                Absent::Unless(other, _)
                    if part
                        .rows
                        .iter()
                        .enumerate()
                        .any(|(i, row)| row.key == other && given & (1 << i) != 0) => {}
                Absent::Required(help) | Absent::Unless(_, help) => {
                    let path = part.path(Some(at), row.key);
                    let missing = || Problem::new(path, Refusal::new("missing", help));
                    reading.problem.get_or_insert_with(missing);
                }
                Absent::Derived => {
                    (row.set)(&mut reading.scene, at, 0, Value::Number(f64::NAN));
                }
                Absent::Usual => {}
            }
        }
        Ok(())
    }
}

/// The index of the row of a key, which must not be repeated.
fn row_of(part: &Part, key: &str, seen: &mut u32) -> Result<usize, Refusal> {
    if part.reserved.contains(&key) {
        let help = "remove the key to run the rest of the scene";
        return Err(Refusal::new("not supported yet", help).of(key));
    }
    index_of(key, part.rows.iter().map(|row| row.key), seen)
}

/// Reads the value of a row.
struct Entry<'r, 'n> {
    part: &'static Part,
    row: &'static Row,
    at: usize,
    reading: &'r mut Reading<'n>,
}

impl<'n> Entry<'_, 'n> {
    fn set(&mut self, component: usize, value: Value<'_>) {
        (self.row.set)(&mut self.reading.scene, self.at, component, value);
    }

    fn member(&mut self, part: &'static Part) -> Mapping<'_, 'n> {
        Mapping {
            part,
            row: Some(self.row),
            at: self.at,
            reading: self.reading,
        }
    }

    /// Sets a number, or one of a list.
    fn number(&mut self, component: usize, number: Number) -> Result<(), Refusal> {
        let value = match self.row.kind {
            ValueKind::Number(quantity)
            | ValueKind::Numbers(_, quantity)
            | ValueKind::Table(.., quantity)
            | ValueKind::Vectors(quantity) => Value::Number(quantity.judge(number)?),
            ValueKind::Coordinate => Value::Id(coordinate(number)?),
            ValueKind::Count(bounds) => Value::Id(count(bounds, number)?),
            _ => Value::Id(self.id(component, number)),
        };
        self.set(component, value);
        Ok(())
    }

    /// Sets an id, or keeps a name for later.
    fn particle(&mut self, component: usize, id: Id<'_>) -> Result<(), Refusal> {
        let name = match id {
            Id::Number(number) => return self.number(component, number),
            Id::Name(name) => name.to_owned(),
        };
        let Entry { part, row, at, .. } = *self;
        self.set(component, Value::Id(usize::MAX));
        self.reading.named.push(Named {
            part,
            row,
            at,
            component,
            name,
        });
        Ok(())
    }

    /// The id. A number that is no id is recorded, and the largest integer stands for it, which is no id either.
    fn id(&mut self, component: usize, number: Number) -> usize {
        number.whole().unwrap_or_else(|| {
            let mut path = self.part.path(Some(self.at), self.row.key);
            if let ValueKind::Ids(_) = self.row.kind {
                path += &format!("[{component}]");
            }
            self.reading.no_id.get_or_insert((path, number));
            usize::MAX
        })
    }
}

impl<'de> DeserializeSeed<'de> for Entry<'_, '_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(mut self, from: D) -> Result<(), D::Error> {
        match self.row.kind {
            ValueKind::Number(_) if self.vectors().is_some() => {
                from.deserialize_any(NumberOrList(self)).map(|_| ())
            }
            // Its number's row reads it.
            ValueKind::Vectors(_) => Ok(()),
            ValueKind::Id => from.deserialize_any(id(|id: Id<'_>| self.particle(0, id))),
            ValueKind::Number(_) | ValueKind::Coordinate | ValueKind::Count(_) => {
                from.deserialize_any(number(|n| self.number(0, n)))
            }
            ValueKind::Numbers(count, _) => {
                from.deserialize_any(Numbers(count, |i, n| self.number(i, n)))
            }
            ValueKind::Table(width, least, _) => {
                from.deserialize_any(Table(width, least, |i, n| self.number(i, n)))
            }
            ValueKind::Ids(count) => {
                from.deserialize_any(Ids(count, |i, id: Id<'_>| self.particle(i, id)))
            }
            ValueKind::Flag => {
                let flag = from.deserialize_any(flag())?;
                self.set(0, Value::Flag(flag));
                Ok(())
            }
            ValueKind::Word(_) | ValueKind::Method | ValueKind::Text(_) => {
                from.deserialize_any(text(|text| {
                    let mut text = text;
                    match self.row.kind {
                        ValueKind::Word(words) => known(text, words, "choice")?,
                        ValueKind::Method => text = method(text, self.reading.names)?,
                        ValueKind::Text(ref form) => (form.judge)(text)?,
                        _ => {}
                    }
                    self.set(0, Value::Text(text));
                    Ok(())
                }))
            }
            ValueKind::Names(ref form) => {
                let mut count = 0;
                from.deserialize_any(Texts(|name: &str| {
                    count += 1;
                    if count > EXPECTED {
                        let message = format!("expected at most {EXPECTED} names");
                        return Refusal::because(message, "");
                    }
                    (form.judge)(name)?;
                    self.set(0, Value::Text(name));
                    Ok(())
                }))
            }
            ValueKind::Part(part) if part.list => from.deserialize_any(List(part, self)),
            ValueKind::Part(part) => from.deserialize_any(self.member(part)),
            ValueKind::Objects => {
                self.reading.scene.objects = Vec::deserialize(from)?;
                Ok(())
            }
            ValueKind::Expect => from.deserialize_any(Engines {
                names: self.reading.names,
                expect: &mut self.reading.scene.expect,
                skip: &mut self.reading.scene.skip,
                problem: &mut self.reading.problem,
            }),
        }
    }
}

impl Entry<'_, '_> {
    /// The row that takes vectors in the place of this one's number.
    fn vectors(&self) -> Option<&'static Row> {
        let mut rows = self.part.rows.iter();
        rows.find(|row| row.key == self.row.key && matches!(row.kind, ValueKind::Vectors(_)))
    }
}

impl Either for Entry<'_, '_> {
    fn number(&mut self, number: Number) -> Result<(), Refusal> {
        Entry::number(self, 0, number)
    }

    /// Vectors stand in the place of the number, which is 0 then.
    fn list<'de, A: SeqAccess<'de>>(mut self, list: A) -> Result<bool, A::Error> {
        self.set(0, Value::Number(0.0));
        self.row = self.vectors().unwrap_or(self.row);
        vectors(list, |at, number| Entry::number(&mut self, at, number)).map(|()| true)
    }
}

/// A whole number within bounds.
fn count(bounds: Bounds, number: Number) -> Result<usize, Refusal> {
    bounds.judge(number)?;
    number.whole().map_or_else(
        || Refusal::because(format!("expected a whole number, found {number}"), ""),
        Ok,
    )
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
struct List<'r, 'n>(&'static Part, Entry<'r, 'n>);

impl<'de> Visitor<'de> for List<'_, '_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a list")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<(), A::Error> {
        let List(part, mut entry) = self;
        while list.next_element_seed(Any(entry.member(part)))?.is_some() {}
        Ok(())
    }
}
