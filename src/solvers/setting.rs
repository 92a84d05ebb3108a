//! What a solver runs at: a step or a tolerance.

/// What a solver runs at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Setting {
    /// A number of equal steps of this size, s.
    Steps { timestep: f64, steps: u64 },
    /// The tolerance of an adaptive pair, relative to the scene's size.
    Tolerance {
        tolerance: f64,
        /// When the run ends, s.
        duration: f64,
        /// About how many steps it takes.
        steps: u64,
        /// It is stopped after so many, accepted or not.
        most: u64,
    },
}

impl Setting {
    /// A fixed step, s, for as long as the caller goes on.
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

    /// The step, s; of a pair about the mean one.
    pub fn timestep(&self) -> f64 {
        match self {
            Self::Steps { timestep, .. } => *timestep,
            Self::Tolerance {
                duration, steps, ..
            } => duration / *steps as f64,
        }
    }

    /// Steps to the end; of a pair about so many.
    pub fn steps(&self) -> u64 {
        match self {
            Self::Steps { steps, .. } | Self::Tolerance { steps, .. } => *steps,
        }
    }

    /// Of a pair; None for a fixed step.
    pub fn tolerance(&self) -> Option<f64> {
        match self {
            Self::Steps { .. } => None,
            Self::Tolerance { tolerance, .. } => Some(*tolerance),
        }
    }

    /// Whether it is as coarse as another setting of the same solver, or coarser.
    pub fn is_no_finer(&self, other: &Self) -> bool {
        match (self.tolerance(), other.tolerance()) {
            (Some(own), Some(other)) => own >= other,
            _ => self.steps() <= other.steps(),
        }
    }
}
