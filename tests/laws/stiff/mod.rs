//! Stiff oscillation: what a method makes of motion that its step cannot follow.

mod chain;
mod modes;
mod resonance;
mod stages;

use crate::testkit::scenes::shipped;
use springcheck::scene::Scene;

/// A shipped hard scene.
fn hard(name: &str) -> Scene {
    shipped(&format!("hard/{name}"))
}
