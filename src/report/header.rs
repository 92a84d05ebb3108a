//! The header that the reports of all verbs have: the scene, the truth, the checks.

use crate::measure::Check;
use crate::scene::object::Body;
use crate::truth::TruthKind;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The mark of the integrator the scene names.
pub const OWN: char = '▸';
/// The mark of an engine that is explained, not ranked.
pub const UNRANKED: char = '†';

/// The scene, the truth and the checks of a report.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
pub struct Header {
    /// The scene in numbers.
    pub scene: SceneFacts,
    /// The motion that errors are measured against.
    pub truth: TruthFacts,
    /// Findings held against their bounds.
    pub checks: Vec<Check>,
    /// Commands to try next, the most useful first.
    #[serde(default)]
    pub advice: Vec<String>,
}

impl Header {
    /// Whether this is the integrator the scene names.
    pub fn is_own(&self, engine: &str) -> bool {
        engine == self.scene.own_integrator
    }

    /// The mark before the name of a ranked engine.
    pub fn mark(&self, engine: &str) -> char {
        if self.is_own(engine) { OWN } else { ' ' }
    }
}

#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
pub struct SceneFacts {
    /// As the scene states it.
    pub name: String,
    /// As the command line named it.
    pub file: String,
    /// How many.
    pub particles: usize,
    /// The particles that have names, by the objects that made them; left out where there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub objects: Vec<Body>,
    /// How many.
    pub springs: usize,
    /// How many; left out where there are none.
    #[serde(default, skip_serializing_if = "none")]
    pub rods: usize,
    /// The effects that act in this scene.
    pub effects: Vec<EffectUse>,
    /// The scene's own timestep, seconds.
    pub timestep: f64,
    /// The duration, seconds.
    pub duration: f64,
    /// The scale S that energy errors are relative to, joules; null where the scene has none.
    pub energy_scale_j: Option<f64>,
    /// Free text from the file, for headings.
    pub description: Option<String>,
    /// The id of the integrator the file names.
    pub own_integrator: String,
}

/// Whether there are none, so that JSON leaves them out.
fn none(members: &usize) -> bool {
    *members == 0
}

/// One line of the effect ledger.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
pub struct EffectUse {
    /// The effect's id.
    pub id: String,
    /// The number of particles, springs or pairs it acts on.
    pub members: usize,
    /// The number of evaluations, summed over the hand-written integrators of this run.
    pub evaluations: u64,
    /// The measured time of one evaluation, nanoseconds.
    pub wall_ns: Option<f64>,
}

#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
pub struct TruthFacts {
    /// A closed form, a converged reference, or none.
    pub kind: TruthKind,
    /// The closed form, or the reference's methods and steps.
    pub method: Option<String>,
    /// The largest error bar of positions up to the horizon, m.
    pub error_bound_m: Option<f64>,
    /// Positions are meaningful up to here, s.
    pub horizon_s: Option<f64>,
    /// Why there is no truth, or why this closed form applies.
    pub reason: Option<String>,
}
