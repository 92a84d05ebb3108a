//! rapier worlds that mirror a scene.
//!
//! There are four worlds, since each answers another question. `rapier` is what people use.
//! `rapier-converged` proves that its world is the same scene: it takes enough sweeps for the joint solve to
//! converge. `rapier-forces` proves that the harness is unbiased: rapier only applies forces computed here.
//! `rapier-user-forces` is the other way people make springs: forces once a step, at rapier's own substeps.
//! `rapier_contact` is no world: it is rapier's contact written here, which proves that we know its law.
//! None of them is the truth; [`RapierEngine`] describes the method of rapier's joints.
//!
//! rapier uses glam; its types stay inside this folder.

mod forces;
mod joints;
mod mirrors;
mod obstacles;
mod settings;
mod world;

pub use forces::RapierForces;
pub use joints::RapierEngine;
pub use mirrors::stand_ins;
pub use obstacles::takes as takes_obstacles;
pub use settings::RapierSettings;

/// The ids of rapier's worlds at fixed settings and of its contact, in the order reports list them.
pub const IDS: [&str; 5] = [
    "rapier",
    "rapier-forces",
    "rapier-converged",
    "rapier-user-forces",
    "rapier_contact",
];
