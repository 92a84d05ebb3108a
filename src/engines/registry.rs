//! The reference engines, a row each. Integrators are not among them: each method of
//! `integrators::REGISTRY` is an engine too, by [`IntegratorEngine`](super::IntegratorEngine).

use super::rapier::{self, Settings};
use super::{Engine, Unsupported};
use crate::outcome::Kind;
use crate::scene::Scene;
use crate::system::ParticleSystem;
use std::borrow::Cow;

/// One reference engine's facts.
#[derive(Clone)]
pub struct EngineRow {
    /// The id reports and the command line use.
    pub id: Cow<'static, str>,
    pub summary: &'static str,
    pub kind: Kind,
    /// Why a run loses energy by this engine's design, `{n}` standing for its substeps; None where
    /// it should not.
    pub dissipates: Option<&'static str>,
    /// The method whose step each of its substeps is, as the twin proof holds it to; None where it
    /// only comes near one.
    pub equals: Option<&'static str>,
    /// What its solver is told.
    pub settings: Settings,
    /// Runs unless the command line says otherwise.
    pub default: bool,
    /// Trajectories are compared with it.
    pub reference: bool,
    /// Called through [`build`](Self::build).
    pub construct: Construct,
}

/// From scene, system, timestep in seconds and settings.
pub type Construct =
    fn(&Scene, ParticleSystem, f64, &Settings) -> Result<Box<dyn Engine>, Unsupported>;

impl EngineRow {
    /// A fresh engine at the scene's start. `timestep` in seconds, positive: the whole step, which
    /// the engine may divide into [`substeps`](Self::substeps).
    ///
    /// # Errors
    /// [`Unsupported`] when the engine has no honest counterpart of something in the scene.
    pub fn build(
        &self,
        scene: &Scene,
        system: ParticleSystem,
        timestep: f64,
    ) -> Result<Box<dyn Engine>, Unsupported> {
        (self.construct)(scene, system, timestep, &self.settings)
    }

    /// Steps it takes inside one timestep: its own h is the timestep divided by this.
    pub fn substeps(&self) -> u32 {
        self.settings.iterations.max(1)
    }
}

impl std::fmt::Debug for EngineRow {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("EngineRow").field("id", &self.id).finish()
    }
}

/// Every reference engine, in the order reports list them.
pub static REGISTRY: &[EngineRow] = &[rapier::RAPIER, rapier::FORCES, rapier::CONVERGED];

/// The engine of this id.
pub fn find(id: &str) -> Option<&'static EngineRow> {
    REGISTRY.iter().find(|row| row.id == id)
}

/// All ids, in registry order.
pub fn ids() -> Vec<&'static str> {
    REGISTRY.iter().map(|row| row.id.as_ref()).collect()
}

/// One more row: rapier with settings of the user's own, named after those that are not its
/// defaults.
pub fn rapier_with(settings: Settings) -> EngineRow {
    EngineRow {
        id: Cow::Owned(format!("rapier({})", settings.changes())),
        summary: "rapier with settings of your own",
        settings,
        ..rapier::RAPIER
    }
}
