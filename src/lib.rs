//! Cross-checks particle-spring integrators against rapier.

pub mod effects;
pub mod engines;
pub mod integrators;
pub mod scene;
pub mod system;
