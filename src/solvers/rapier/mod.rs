//! rapier worlds that mirror a scene.
//!
//! Three engines, because each answers another question: `rapier` is what people ship,
//! `rapier-converged` proves that its world is the same scene (its sweeps are raised until the
//! joint solve converges), `rapier-forces` proves that the harness is unbiased (rapier only adds
//! up forces computed here). None of them is the truth: see [`RapierEngine`] for the method that
//! rapier's joints are.
//!
//! rapier speaks glam; its types stay inside this folder.

mod forces;
mod joints;
mod mirrors;
mod settings;
mod world;

pub use forces::RapierForces;
pub use joints::RapierEngine;
pub use settings::RapierSettings;

/// The ids of rapier's worlds at fixed settings, in the order reports list them.
pub const IDS: [&str; 3] = ["rapier", "rapier-forces", "rapier-converged"];
