//! A scene as flat arrays of numbers: what a program in any language reads in a few lines.

use super::Task;
use crate::scene::Scene;
use crate::scene::model::{GRAVITATIONAL, PARTICLES, Part, Row, SPRINGS};
use serde::ser::{Serialize, SerializeMap, Serializer};

/// Version of the keys and of what they mean.
const SCHEMA_VERSION: u32 = 1;

/// Everything that moves the particles, all defaults filled in; the JSON behind `{scene_json}`.
/// `docs/external.md` says what its keys mean. Numbers read back to the same bits. SI units.
///
/// What particles, springs and pairs have comes from the [table](crate::scene::model) of their
/// parameters: an array for each row that moves something, under its name.
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
        let mut gravity = [0.0; 3];
        gravity[scene.up.index()] = scene.solver.gravity;
        let wind = scene.wind.as_ref();
        let wind = wind.map_or([0.0; 3], |wind| wind.direction.map(|d| wind.strength * d));
        let effects: Vec<&str> = system.effects().iter().map(|(row, _)| row.id).collect();

        let mut map = to.serialize_map(None)?;
        map.serialize_entry("schema_version", &SCHEMA_VERSION)?;
        map.serialize_entry("particles", &scene.particles.len())?;
        arrays(&mut map, scene, &PARTICLES)?;
        map.serialize_entry("springs", &Arrays(scene, &SPRINGS))?;
        map.serialize_entry("damping_model", &scene.damping_model)?;
        map.serialize_entry("gravity", &gravity)?;
        map.serialize_entry("wind_force", &wind)?;
        map.serialize_entry("gravitational", &Arrays(scene, &GRAVITATIONAL))?;
        map.serialize_entry("effects", &effects)?;
        map.serialize_entry("timestep", &timestep)?;
        map.serialize_entry("duration", &scene.duration)?;
        map.serialize_entry("steps", &steps)?;
        map.end()
    }
}

/// The rows of a part that move something, an array each.
fn arrays<M: SerializeMap>(map: &mut M, scene: &Scene, part: &Part) -> Result<(), M::Error> {
    for row in part.rows {
        if let Some(name) = row.flat {
            map.serialize_entry(name, &Array(scene, row, (part.count)(scene)))?;
        }
    }
    Ok(())
}

/// All members of a part, as a mapping of arrays.
struct Arrays<'a>(&'a Scene, &'a Part);

impl Serialize for Arrays<'_> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let mut map = to.serialize_map(None)?;
        arrays(&mut map, self.0, self.1)?;
        map.end()
    }
}

/// One row of so many members; what is several numbers, as x, y, z, one after the other.
struct Array<'a>(&'a Scene, &'a Row, usize);

impl Serialize for Array<'_> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let Array(scene, row, count) = *self;
        to.collect_seq((0..count).flat_map(|at| row.values(scene, at)))
    }
}
