//! Whatever can advance a scene: our integrators, rapier's worlds, and other programs.

mod adaptive;
pub mod external;
mod integrator;
pub mod rapier;
mod registry;
mod simulate;

pub use adaptive::AdaptiveEngine;
pub use integrator::IntegratorEngine;
pub use registry::{EngineRow, REGISTRY, find, ids, rapier_with};
pub use simulate::{Ended, Limits, Observer, adapt, simulate};

use crate::integrators::StepError;
use crate::system::State;

/// A scene being advanced step by step.
///
/// Two engines built from the same scene and timestep give the same bits.
pub trait Engine: Send {
    /// Advances by one timestep, or by a step of the engine's own where it chooses them.
    ///
    /// # Errors
    /// [`StepError`] when an implicit step cannot be solved, or no step is short enough for a
    /// tolerance; the state is then the last good one.
    fn step(&mut self) -> Result<(), StepError>;

    /// The state now: all particles, fixed ones included; t is not kept here but by the caller,
    /// who counts steps, except by an [`AdaptiveEngine`], whose steps are of any length.
    fn state(&self) -> &State;

    /// What has been computed so far.
    fn counts(&self) -> Counts;
}

/// Work that can be counted; None where an engine does not tell.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// Full evaluations of all forces.
    pub force_evaluations: Option<u64>,
    /// Evaluations of the velocity-dependent effects alone (inside exact damping flows).
    pub damping_evaluations: Option<u64>,
    pub linear_solves: Option<u64>,
    pub newton_iterations: Option<u64>,
}

impl Counts {
    /// What a run's forces cost: full evaluations and passes over damping alone, which cost about
    /// as much where there is damping at all.
    pub fn all_force_passes(&self) -> Option<u64> {
        self.force_evaluations
            .map(|full| full + self.damping_evaluations.unwrap_or(0))
    }
}

/// Why an engine cannot run a scene. An answer, not a fault.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{reason}")]
pub struct Unsupported {
    /// What the scene has that the engine cannot mirror.
    pub reason: String,
}
