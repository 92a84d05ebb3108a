//! A scene as flat arrays of numbers, which a program in any language can read in a few lines.

use super::Task;
use crate::physics::System;
use crate::scene::model::{
    BENDING, COLLIDERS, CONTACT, DRIVEN, GRAVITATIONAL, MESH, MOTION, MOTION_SINE, PARTICLES,
    PENALTY, Part, RODS, Row, SINE, SPRINGS, STRAIN_LIMIT, TRIANGLES, ValueKind,
};
use crate::scene::{Scene, Value};
use serde::ser::{Serialize, SerializeMap, Serializer};

/// The version of the keys and of their meaning.
const SCHEMA_VERSION: u32 = 1;

/// The JSON behind `{scene_json}`: everything that influences the motion, with all defaults filled in.
/// `docs/external.md` explains its keys. Numbers read back to the same bits. SI units.
///
/// The arrays of particles, springs and pairs come from the [table](crate::scene::model) of parameters: one
/// for each row that influences the motion, under its name.
#[derive(Clone, Copy)]
pub struct Flat<'a>(pub &'a Task<'a>);

impl Serialize for Flat<'_> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let Task {
            scene,
            system,
            timestep,
            steps,
        } = *self.0;
        let wind = scene.wind.as_ref();
        let wind = wind.map_or([0.0; 3], |wind| wind.direction.map(|d| wind.strength * d));
        let mut effects: Vec<&str> = system.effects().iter().map(|(row, _)| row.id).collect();
        // What a program does not know it refuses, constraints too.
        effects.extend(system.rods().map(|_| "rods"));
        effects.extend(system.strain_limiter().map(|_| "strain_limit"));
        effects.extend((!scene.colliders.is_empty()).then_some("colliders"));
        effects.extend(scene.contact.as_ref().map(|_| "contact"));

        let mut map = to.serialize_map(None)?;
        map.serialize_entry("schema_version", &SCHEMA_VERSION)?;
        map.serialize_entry("particles", &scene.particles.len())?;
        arrays(&mut map, scene, &PARTICLES)?;
        map.serialize_entry("springs", &Arrays(scene, &[&SPRINGS]))?;
        map.serialize_entry("rods", &Arrays(scene, &[&RODS]))?;
        map.serialize_entry("bending", &Arrays(scene, &[&BENDING]))?;
        map.serialize_entry("driven", &Arrays(scene, &[&DRIVEN, &SINE]))?;
        map.serialize_entry("damping_model", &scene.damping_model)?;
        map.serialize_entry("gravity", &scene.gravity())?;
        map.serialize_entry("wind_force", &wind)?;
        map.serialize_entry("air_velocity", &scene.air().velocity)?;
        map.serialize_entry("air_density", &scene.air().density)?;
        map.serialize_entry("triangles", &Arrays(scene, &[&TRIANGLES]))?;
        let field = scene
            .magnetic
            .as_ref()
            .map_or([0.0; 3], |magnetic| magnetic.field);
        map.serialize_entry("magnetic_field", &field)?;
        if scene.strain_limit.is_some() {
            map.serialize_entry("strain_limit", &Keys(scene, &STRAIN_LIMIT))?;
        }
        if !scene.colliders.is_empty() {
            map.serialize_entry("colliders", &Colliders(scene))?;
        }
        if scene.contact.is_some() {
            map.serialize_entry("contact", &Collisions(scene))?;
        }
        map.serialize_entry("gravitational", &Arrays(scene, &[&GRAVITATIONAL]))?;
        map.serialize_entry("effects", &effects)?;
        map.serialize_entry("timestep", &timestep)?;
        map.serialize_entry("duration", &scene.duration)?;
        map.serialize_entry("steps", &steps)?;
        map.end()
    }
}

/// How particles collide: its keys, those of the penalty where there is one, and the radii.
struct Collisions<'a>(&'a Scene);

impl Serialize for Collisions<'_> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let scene = self.0;
        let mut map = to.serialize_map(None)?;
        for row in CONTACT.rows.iter().filter(|row| row.flat.is_some()) {
            map.serialize_entry(row.key, &(row.get)(scene, 0, 0))?;
        }
        let penalty = scene
            .contact
            .as_ref()
            .and_then(|contact| contact.penalty.as_ref());
        if penalty.is_some() {
            map.serialize_entry("penalty", &Keys(scene, &PENALTY))?;
        }
        let radii: Vec<f64> = scene.particles.iter().map(|p| p.radius).collect();
        map.serialize_entry("radii", &radii)?;
        map.end()
    }
}

/// The obstacles: which shape each has, what all have, and the arrays of each shape, with zeros where it is another.
struct Colliders<'a>(&'a Scene);

impl Serialize for Colliders<'_> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let scene = self.0;
        let shapes = COLLIDERS.rows.iter().filter_map(|row| match row.kind {
            ValueKind::Part(part) if part.key != MOTION.key => Some((row.key, part)),
            _ => None,
        });
        let mut map = to.serialize_map(None)?;
        let has = |part: &Part, at| {
            part.rows
                .iter()
                .any(|row| (row.get)(scene, at, 0).is_some())
        };
        let shape = |at| {
            shapes
                .clone()
                .find(|(_, part)| has(part, at))
                .map(|(key, _)| key)
        };
        let of_each: Vec<_> = (0..scene.colliders.len()).map(shape).collect();
        map.serialize_entry("shapes", &of_each)?;
        let radii: Vec<f64> = scene.particles.iter().map(|p| p.radius).collect();
        map.serialize_entry("radii", &radii)?;
        arrays(&mut map, scene, &COLLIDERS)?;
        for (key, part) in shapes {
            map.serialize_entry(key, &Arrays(scene, &[part]))?;
        }
        map.serialize_entry("driven", &Arrays(scene, &[&MOTION, &MOTION_SINE]))?;
        map.end()
    }
}

/// Writes an array for each row of a part that influences the motion.
fn arrays<M: SerializeMap>(map: &mut M, scene: &Scene, part: &Part) -> Result<(), M::Error> {
    for row in part.rows {
        let Some(name) = row.flat else { continue };
        let count = (part.count)(scene);
        if let ValueKind::Table(width, ..) = row.kind {
            let rows = (0..count).map(|at| row.values(scene, at).count() / width);
            // A mesh has two tables.
            let key = if part.key == MESH.key {
                format!("{name}_rows")
            } else {
                "rows".to_owned()
            };
            map.serialize_entry(&key, &rows.collect::<Vec<_>>())?;
        }
        map.serialize_entry(name, &Array(scene, row, count))?;
    }
    Ok(())
}

/// The members of some parts, as a mapping of arrays.
struct Arrays<'a>(&'a Scene, &'a [&'a Part]);

impl Serialize for Arrays<'_> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let mut map = to.serialize_map(None)?;
        for part in self.1 {
            arrays(&mut map, self.0, part)?;
        }
        map.end()
    }
}

/// The keys of a part that the scene has once, each of one component.
struct Keys<'a>(&'a Scene, &'a Part);

impl Serialize for Keys<'_> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let Keys(scene, part) = *self;
        to.collect_map(
            part.rows
                .iter()
                .map(|row| (row.key, (row.get)(scene, 0, 0))),
        )
    }
}

/// One row for this many members. Components, as x, y, z, follow one another; a member without the key has zeros.
struct Array<'a>(&'a Scene, &'a Row, usize);

impl Serialize for Array<'_> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let Array(scene, row, count) = *self;
        let components = match row.kind {
            ValueKind::Number(_) => 1,
            ValueKind::Numbers(count, _) => count,
            _ => 0,
        };
        let member = |at| {
            let given = row.values(scene, at).count();
            let zeros = std::iter::repeat_n(Value::Number(0.0), components.saturating_sub(given));
            row.values(scene, at).chain(zeros)
        };
        to.collect_seq((0..count).flat_map(member))
    }
}
