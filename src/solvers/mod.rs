//! Everything that can run a scene: the [`catalogue`] of solvers, and the [`Run`] that takes their steps.

pub mod external;
mod integrator;
mod memory;
pub mod rapier;
mod run;
mod setting;
mod solver;

pub use integrator::{AdaptiveEngine, IntegratorEngine, advance};
pub use run::{Ended, Limits, Run, Status, Tally};
pub use setting::Setting;
pub use solver::{BuildIntegrator, Solver, SolverKind, catalogue, find, methods, own_first};

use crate::integrators::StepError;
use crate::physics::constraints::Corrections;
use crate::physics::{Refused, State};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A scene that advances step by step. Only a [`Run`] takes its steps.
///
/// Two engines built from the same scene and timestep give the same bits.
pub trait Engine: Send {
    /// Advances by one timestep, or by a step of the engine's own where it chooses them.
    ///
    /// # Errors
    /// [`StepError`] when an implicit step cannot be solved, or no step is short enough for a
    /// tolerance; the state is then the last good one.
    fn step(&mut self) -> Result<(), StepError>;

    /// The present state: all particles, fixed ones included, and the time.
    fn state(&self) -> &State;

    /// The work counted so far.
    fn counts(&self) -> Counts;

    /// Whether it has reached its own end, as an adaptive pair does.
    fn done(&self) -> bool {
        false
    }

    /// The number of rejected steps. Their evaluations are counted with the others.
    fn rejected(&self) -> u64 {
        0
    }
}

/// Work that is counted; None where an engine does not report it.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Counts {
    /// Evaluations of all forces.
    pub force_evaluations: Option<u64>,
    /// Evaluations of the velocity-dependent effects alone (inside exact damping flows).
    pub damping_evaluations: Option<u64>,
    pub linear_solves: Option<u64>,
    pub newton_iterations: Option<u64>,
    /// What the strain limit corrected; None without one.
    pub corrections: Option<Corrections>,
    /// What a rapier world was built of.
    pub world: Option<Built>,
}

/// What a scene called for in a rapier world.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Built {
    /// Bodies: one a particle, and one for the air where drag is a joint.
    pub bodies: u64,
    /// Joints: one for each spring, damper and drag that rapier has itself.
    pub joints: u64,
}

impl Counts {
    /// All force evaluations of a run: full ones and those of damping alone, which cost about as much where
    /// there is damping.
    pub fn all_force_passes(&self) -> Option<u64> {
        self.force_evaluations
            .map(|full| full + self.damping_evaluations.unwrap_or(0))
    }
}

/// The reason why an engine cannot run a scene. This is a valid outcome, not a fault.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{reason}")]
pub struct Unsupported {
    /// The part of the scene that the engine cannot mirror.
    pub reason: String,
}

impl From<Refused> for Unsupported {
    fn from(refused: Refused) -> Self {
        let reason = refused.reason();
        Self { reason }
    }
}
