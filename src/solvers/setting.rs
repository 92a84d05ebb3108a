//! The setting of a solver: a step or a tolerance.

/// The setting at which a solver runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Setting {
    /// A number of equal steps of this size, s.
    Steps { timestep: f64, steps: u64 },
    /// The tolerance of an adaptive pair, relative to the scene's size.
    Tolerance {
        tolerance: f64,
        /// The time at which the run ends, s.
        duration: f64,
        /// The approximate number of steps.
        steps: u64,
        /// The number of steps, accepted or rejected, after which the run is stopped.
        max_steps: u64,
    },
}

impl Setting {
    /// A fixed step, s, for any number of steps.
    pub fn step(timestep: f64) -> Self {
        Self::Steps {
            timestep,
            steps: u64::MAX,
        }
    }

    /// `steps` equal steps over a duration, s.
    pub fn divided(duration: f64, steps: u64) -> Self {
        Self::Steps {
            timestep: duration / steps as f64,
            steps,
        }
    }

    /// The step, s; for a pair, about the mean step.
    pub fn timestep(&self) -> f64 {
        match self {
            Self::Steps { timestep, .. } => *timestep,
            Self::Tolerance {
                duration, steps, ..
            } => duration / *steps as f64,
        }
    }

    /// The number of steps to the end; approximate for a pair.
    pub fn steps(&self) -> u64 {
        match self {
            Self::Steps { steps, .. } | Self::Tolerance { steps, .. } => *steps,
        }
    }

    /// The tolerance of a pair; None for a fixed step.
    pub fn tolerance(&self) -> Option<f64> {
        match self {
            Self::Steps { .. } => None,
            Self::Tolerance { tolerance, .. } => Some(*tolerance),
        }
    }

    /// Whether it is at least as coarse as another setting of the same solver.
    pub fn is_no_finer(&self, other: &Self) -> bool {
        match (self.tolerance(), other.tolerance()) {
            (Some(own), Some(other)) => own >= other,
            _ => self.steps() <= other.steps(),
        }
    }
}
