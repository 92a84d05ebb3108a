//! What the reports of all verbs have: the scene, the truth, the checks.

use crate::measure::Check;
use crate::truth::TruthKind;
use serde::{Deserialize, Serialize};

/// Marks the integrator the scene names.
pub const OWN: char = '▸';
/// Marks an engine that is explained, not ranked.
pub const UNRANKED: char = '†';

/// What the reports of all verbs have.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Header {
    pub scene: SceneFacts,
    pub truth: TruthFacts,
    pub checks: Vec<Check>,
}

impl Header {
    /// Whether this is the integrator the scene names.
    pub fn is_own(&self, engine: &str) -> bool {
        engine == self.scene.own_integrator
    }

    /// What stands before the name of an engine that is ranked.
    pub fn mark(&self, engine: &str) -> char {
        if self.is_own(engine) { OWN } else { ' ' }
    }
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct SceneFacts {
    pub name: String,
    pub file: String,
    pub particles: usize,
    pub springs: usize,
    /// Only what the scene calls for.
    pub effects: Vec<EffectUse>,
    /// The scene's own timestep, seconds.
    pub timestep: f64,
    /// Seconds.
    pub duration: f64,
    /// The scale S that energy errors are relative to, joules; null where the scene has none.
    pub energy_scale_j: Option<f64>,
    /// Free text from the file, for headings.
    pub description: Option<String>,
    /// The id of the integrator the file names.
    pub own_integrator: String,
}

/// One line of the effect ledger.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct EffectUse {
    pub id: String,
    /// Particles, springs or pairs it acts on.
    pub members: usize,
    /// Times its force was evaluated, summed over the hand-written integrators of this run.
    pub evaluations: u64,
    /// Nanoseconds one evaluation takes, measured.
    pub wall_ns: Option<f64>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct TruthFacts {
    pub kind: TruthKind,
    /// The form, or the reference's methods and steps.
    pub method: Option<String>,
    /// Largest error bar of positions up to the horizon.
    pub error_bound_m: Option<f64>,
    /// Until when positions mean anything.
    pub horizon_s: Option<f64>,
    /// Why there is none, or why this form applies.
    pub reason: Option<String>,
}
