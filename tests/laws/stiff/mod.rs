//! Stiff oscillation: what a method makes of motion that its step cannot follow.

mod chain;
mod modes;
mod resonance;
mod stages;

use springcheck::scene::{self, Scene};
use std::path::Path;

/// A shipped hard scene.
fn hard(name: &str) -> Scene {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/hard");
    scene::read(&root.join(name), springcheck::crosscheck::names()).expect("a valid scene")
}
