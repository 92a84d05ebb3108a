//! Closed forms: they are the motion of the system they are chosen for, their error bars hold and are
//! not wide, and they are not chosen where they do not hold.

mod bars;
mod choice;
mod driven;
mod edges;
mod exact;
mod fall;
mod families;
mod gauss;
mod motion;
mod pendulum;
mod pieces;

use springcheck::physics::ParticleSystem;
use springcheck::scene::Scene;
use springcheck::truth::Truth;
use springcheck::truth::closed::find;

/// The closed form of a scene up to `until`, if it has one.
fn form(scene: &Scene, until: f64) -> Option<Truth> {
    find(scene, &ParticleSystem::new(scene), until)
}
