//! Numbers of objects, by paths such as `sheet.structural.stiffness`.

use super::error::Refusal;
use super::limits::{self, Bounds};
use super::model::{BENDING, PARTICLES, Row, SPRINGS, Scene, TRIANGLES, ValueKind};
use super::object::Object;
use serde_json::Value;

/// A number of an object that has a say in the motion.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectNumber {
    /// The object's name and the keys: `sheet.structural.stiffness`.
    pub id: String,
    /// The values a scene file may give it, and their unit.
    pub bounds: Bounds,
    /// The value in the file; None where it is not given.
    pub given: Option<f64>,
    /// The index of the object.
    object: usize,
    /// `/cloth/structural/stiffness`
    pointer: String,
}

impl Scene {
    /// The numbers of its objects, in the order of the file and then of the alphabet; also those that are not given, in
    /// mappings that are.
    pub fn object_numbers(&self) -> Vec<ObjectNumber> {
        let mut found = Vec::new();
        let objects = self.written.iter().flat_map(|w| &w.scene.objects);
        for (object, (written, body)) in objects.zip(&self.bodies).enumerate() {
            let value = serde_json::to_value(written).unwrap_or_default();
            for (kind, value) in value.as_object().into_iter().flatten() {
                keys(value, &mut Vec::new(), &mut |path, given| {
                    if let Some(bounds) = bounds(path) {
                        found.push(ObjectNumber {
                            id: format!("{}.{}", body.name, path.join(".")),
                            bounds,
                            given,
                            object,
                            pointer: format!("/{kind}/{}", path.join("/")),
                        });
                    }
                });
            }
        }
        found
    }

    /// The scene [remade](Self::remade) with another value of this number.
    ///
    /// # Errors
    /// A [`Refusal`] where objects with this value cannot be made.
    pub fn with_number(&self, number: &ObjectNumber, value: f64) -> Result<Self, Refusal> {
        let unread = |error: serde_json::Error| Refusal::new(error.to_string(), "");
        let objects = self.written.iter().flat_map(|w| &w.scene.objects);
        let mut changed: Vec<Object> = objects.cloned().collect();
        if let Some(object) = changed.get_mut(number.object) {
            let mut read = serde_json::to_value(&*object).map_err(unread)?;
            if let Some(place) = read.pointer_mut(&number.pointer) {
                *place = value.into();
            }
            *object = serde_json::from_value(read).map_err(unread)?;
        }
        self.remade(|objects| *objects = changed)
    }
}

/// Visits every key of a mapping, and of those in it, that holds a number or nothing.
fn keys<'v>(
    value: &'v Value,
    path: &mut Vec<&'v str>,
    visit: &mut impl FnMut(&[&str], Option<f64>),
) {
    match value {
        Value::Object(map) => {
            for (key, value) in map {
                path.push(key);
                keys(value, path, visit);
                path.pop();
            }
        }
        Value::Number(_) | Value::Null => visit(path, value.as_f64()),
        _ => {}
    }
}

/// The bounds of the members' number that it becomes; None where it becomes none that has a say in the motion.
fn bounds(path: &[&str]) -> Option<Bounds> {
    let key = match path {
        ["rest_ratio"] => return Some(limits::REST_RATIO),
        ["particle_mass"] => "mass",
        [.., key] => key,
        [] => return None,
    };
    let parts = match path {
        ["bending", _] => &[&BENDING][..],
        _ => &[&SPRINGS, &PARTICLES, &TRIANGLES],
    };
    let of_row = |row: &Row| match row.kind {
        ValueKind::Number(bounds) if row.key == key && row.flat.is_some() => Some(bounds),
        _ => None,
    };
    let mut rows = parts.iter().flat_map(|part| part.rows);
    rows.find_map(of_row)
}
