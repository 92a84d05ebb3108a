//! What `rest` finds.

use crate::measure::Reaction;
use crate::scene::Scene;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Where a scene comes to rest, and what refining its objects does to that.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AtRest {
    /// Why no rest was found; null where one was.
    pub reason: Option<String>,
    /// The rest; null where none was found.
    pub found: Option<Balance>,
    /// The same scene with its links cut into more; empty where nobody asked.
    pub refined: Vec<Refined>,
    /// What each quantity tends to, of each scaling; empty where nobody asked.
    pub trends: Vec<Trend>,
}

/// The scene at rest and where it started, which the picture is drawn from.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct RestShape {
    /// In the file as YAML, without the names of particles.
    #[serde(with = "written")]
    pub scene: Box<Scene>,
    /// Where each particle started, m, three a particle.
    pub start: Vec<f64>,
}

mod written {
    use crate::scene::{self, Scene};
    use crate::verbs;
    use serde::{Deserialize, Deserializer, Serializer, de::Error};

    pub fn serialize<S: Serializer>(scene: &Scene, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&scene::yaml(scene))
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Box<Scene>, D::Error> {
        let text = String::deserialize(from)?;
        let scene = scene::parse(text.as_bytes(), "", verbs::names());
        scene.map(Box::new).map_err(D::Error::custom)
    }
}

/// A state in which no force is left.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Balance {
    /// The particle that is farthest from its start; null where none has moved.
    pub farthest: Option<Moved>,
    /// The largest force left on a free particle, N.
    pub force_left_n: f64,
    /// Iterations of Newton's method.
    pub newton_iterations: u64,
    /// The potential energy of each effect at the start and at rest, J.
    pub potential_j: BTreeMap<String, [f64; 2]>,
    /// The largest pull of a spring or rod; null without any.
    pub tension_max: Option<Pull>,
    /// The smallest: below 0 where a spring pushes.
    pub tension_min: Option<Pull>,
    /// What holds each fixed particle.
    pub reactions: Vec<Reaction>,
    /// The slowest oscillations about it, without dampers, ascending in frequency; those that grow come first.
    pub oscillations: Vec<Oscillation>,
    /// How many motions grow; of a large scene as far as they were found.
    pub growing: usize,
    /// How many motions cost no energy, at first; of a large scene as far as they were found.
    pub free: usize,
    /// Whether `growing` and `free` count all there are.
    pub counted: bool,
    /// What the oscillations leave out, in words; empty where nothing.
    pub left_out: Vec<String>,
}

/// How much a spring or a rod pulls on its ends.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Pull {
    /// N; below 0 where it pushes.
    pub tension_n: f64,
    /// Its place in the scene's list of springs; left out for a rod.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spring: Option<usize>,
    /// Its place in the scene's list of rods; left out for a spring.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rod: Option<usize>,
    /// The ids of its ends.
    pub particles: [usize; 2],
}

/// How far a particle is from its start.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Moved {
    /// Its id.
    pub particle: usize,
    /// m.
    pub by_m: [f64; 3],
}

impl Moved {
    /// m.
    pub fn distance(&self) -> f64 {
        let [x, y, z] = self.by_m;
        x.hypot(y).hypot(z)
    }

    /// The axis along which it has moved, where it is one: 0, 1, 2 for x, y, z.
    pub fn along(&self) -> Option<usize> {
        let length = self.distance();
        let mut parts = self.by_m.iter();
        parts.position(|c| c.abs() >= (1.0 - 1e-9) * length)
    }
}

/// One small oscillation about the rest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Oscillation {
    /// Angular frequency, rad/s; 0 where no force restores; null where it grows.
    pub omega_rad_s: Option<f64>,
    /// The rate at which it grows, 1/s; null where it does not.
    pub growth_per_s: Option<f64>,
    /// The particle that moves most.
    pub particle: usize,
    /// The axis along which `particle` moves: 0, 1, 2 for x, y, z.
    pub axis: usize,
}

/// The scene with its links cut into more.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Refined {
    /// `continuum` or `none`: what cutting a link does to stiffness and mass.
    pub scaling: String,
    /// How many links each link of the file becomes.
    pub links: u64,
    /// How many.
    pub particles: usize,
    /// How far the file's farthest particle is from its start, m; null where there is none, or no rest.
    pub moved_m: Option<f64>,
    /// The lowest frequencies other than 0, each once, rad/s.
    pub omega_rad_s: Vec<f64>,
    /// Why no rest was found; null where one was.
    pub reason: Option<String>,
}

/// How one quantity changes as links become more.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Trend {
    /// `continuum` or `none`.
    pub scaling: String,
    /// `moved_m`, or `omega_rad_s` and its place there, from 0.
    pub quantity: String,
    /// The power of 1/links that differences fall with, from the three finest; null where they do not tell.
    pub order: Option<f64>,
    /// What the quantity tends to by that order; null where it tends to nothing.
    pub limit: Option<f64>,
}
