//! Cross-checks particle-spring integrators against rapier.

pub mod crosscheck;
pub mod effects;
pub mod engines;
pub mod integrators;
pub mod measure;
pub mod outcome;
pub mod report;
pub mod scene;
pub mod system;
pub mod trajectory;
