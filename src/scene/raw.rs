//! The file's shape, as YAML gives it: known keys, right kinds of values, nothing judged yet.
//!
//! Never through a free-form value, whose aliases and nesting a hostile file can multiply.

use super::entries::{Entries, RawWanted, Word};
use super::keys::{Keys, mapping};
use super::leaf::{Items, Numbers, Text, Truth};
use super::locate::{self, Fault};
use super::number::Number;
use super::refusal;
use serde::de::Deserialize;

mapping! {
    /// The whole file.
    RawScene: "a scene: a mapping with `solver` and `particles`";
    "name" => name: Text,
    "description" => description: Text,
    "solver" => solver: RawSolver,
    "duration" => duration: Number,
    "up" => up: Text,
    "damping_model" => damping_model: Text,
    "plot" => plot: RawPlot,
    "particles" => particles: Items<RawParticle>,
    "springs" => springs: Items<RawSpring>,
    "gravitational" => gravitational: Items<RawPair>,
    "wind" => wind: RawWind,
    "expect" => expect: Entries<Entries<RawWanted>>,
    later &["air", "bending", "colliders", "driven", "magnetic", "objects", "rods", "strain_limit"]
}

mapping! {
    RawSolver: "a mapping with `type` and `timestep`";
    "type" => method: Text,
    "timestep" => timestep: Number,
    "gravity" => gravity: Number,
    "tolerance" => tolerance: Number,
    later &[]
}

mapping! {
    RawPlot: "a mapping with `particle_id` and `dof`";
    "particle_id" => particle: Number,
    "dof" => dof: Number,
    "y_range" => y_range: Numbers<2>,
    later &[]
}

mapping! {
    RawParticle: "a particle: a mapping with `pos` and `mass`";
    "pos" => position: Numbers<3>,
    "vel" => velocity: Numbers<3>,
    "fixed" => fixed: Truth,
    "mass" => mass: Number,
    "radius" => radius: Number,
    "drag" => drag: Number,
    later &[]
}

mapping! {
    RawSpring: "a spring: a mapping with `particle_ids` and `stiffness`";
    "particle_ids" => ends: Numbers<2>,
    "stiffness" => stiffness: Number,
    "cubic" => cubic: Number,
    "damping" => damping: Number,
    "rest_length" => rest_length: Number,
    later &[]
}

mapping! {
    RawPair: "a pair: a mapping with `particle_ids` and `G`";
    "particle_ids" => ends: Numbers<2>,
    "G" => g: Number,
    later &[]
}

mapping! {
    RawWind: "a mapping with `direction` and `strength`";
    "direction" => direction: Numbers<3>,
    "strength" => strength: Number,
    later &["velocity", "density", "profile"]
}

mapping! {
    RawBounds: "bounds, such as {below: 1e-3}";
    "below" => below: Number,
    "above" => above: Number,
    "contains" => contains: Word,
    later &[]
}

/// Reads the one document the file holds.
pub(super) fn document(text: &str) -> Result<RawScene, Fault> {
    let mut documents = serde_yaml::Deserializer::from_str(text);
    let first = match documents.next() {
        Some(document) => Option::deserialize(document).map_err(|e| refusal::fault(&e, text))?,
        None => None,
    };
    if let Some(second) = documents.next() {
        return Err(locate::second_document(second, text));
    }
    first.ok_or_else(|| Fault {
        offset: 0,
        key: String::new(),
        message: "the file holds no scene".into(),
        help: "a scene needs at least `solver` and `particles`".into(),
    })
}
