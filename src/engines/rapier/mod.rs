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
pub use settings::Settings;

use super::{Engine, EngineRow};
use crate::outcome::Kind;
use std::borrow::Cow;

/// rapier as it ships.
pub(super) const RAPIER: EngineRow = EngineRow {
    id: Cow::Borrowed("rapier"),
    summary: "rapier at its defaults: spring joints, 4 substeps, one sweep each",
    kind: Kind::Rapier,
    dissipates: Some(
        "rapier's spring joint is linearly implicit Euler at h = dt/{n}, which loses energy by \
         design: distance from it is no error of yours",
    ),
    equals: None,
    settings: Settings::DEFAULT,
    default: true,
    reference: true,
    construct: |scene, system, timestep, settings| {
        let engine = RapierEngine::new(scene, system, timestep, settings)?;
        Ok(Box::new(engine) as Box<dyn Engine>)
    },
};

/// rapier's scene, solved to the end.
pub(super) const CONVERGED: EngineRow = EngineRow {
    id: Cow::Borrowed("rapier-converged"),
    summary: "rapier's spring joints swept until they converge: linearly implicit Euler",
    equals: Some("linearized_implicit_material"),
    settings: Settings::CONVERGED,
    default: false,
    ..RAPIER
};

/// rapier's bodies under our forces.
pub(super) const FORCES: EngineRow = EngineRow {
    id: Cow::Borrowed("rapier-forces"),
    summary: "rapier's bodies under this program's forces: symplectic Euler",
    dissipates: None,
    equals: Some("symplectic_euler"),
    settings: Settings::FORCES,
    construct: |scene, system, timestep, _| {
        let engine = RapierForces::new(scene, system, timestep)?;
        Ok(Box::new(engine) as Box<dyn Engine>)
    },
    ..RAPIER
};
