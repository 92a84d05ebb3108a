//! The scene reader: what it accepts, what it refuses and where, and that nothing upsets it.

mod accepted;
mod colliders;
mod refused;
mod rods;
mod schema;
mod table;
mod upset;
mod written;

use crate::testkit::scenes::{files, folders};
use springcheck::scene::{self, Names, Scene, SceneError};
use springcheck::verbs;
use std::sync::LazyLock;

/// The integrators `solver.type` may name here.
const METHODS: &[&str] = &[
    "explicit_euler",
    "symplectic_euler",
    "midpoint",
    "rk4",
    "velocity_verlet",
    "implicit_euler",
    "linearized_implicit_at_start",
];

/// With these few integrators, so that messages that list them stay as they are.
static NAMES: LazyLock<Names> = LazyLock::new(|| Names {
    methods: METHODS.to_vec(),
    ..verbs::names().clone()
});

/// What a row of bad input is, its text with `»` at the place of the error, and what the message must say.
type Row = (&'static str, &'static str, &'static [&'static str]);

fn parse(text: &str) -> Result<Scene, SceneError> {
    scene::parse(text.as_bytes(), "scenes/test.yml", &NAMES)
}

/// Adds what a scene needs and the text leaves out, below it, so that its lines keep their numbers.
fn complete(text: &str) -> String {
    let mut text = text.to_owned();
    let has = |text: &str, key: &str| text.contains(key);
    if !has(&text, "solver:") {
        text.push_str("\nsolver: {type: midpoint, timestep: 0.01}");
    }
    if !has(&text, "particles:") {
        text.push_str("\nparticles: [{pos: [0, 0, 0], fixed: true}, {pos: [1, 0, 0], mass: 2}]");
    }
    text
}

/// The bytes of every shipped scene, with its path.
fn shipped() -> Vec<(std::path::PathBuf, Vec<u8>)> {
    files(&folders())
        .into_iter()
        .map(|path| (path.clone(), std::fs::read(path).unwrap()))
        .collect()
}
