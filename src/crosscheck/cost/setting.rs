//! What an engine is run at: a step, or a tolerance.

/// One point of a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Setting {
    /// So many steps of this size, s.
    Step { timestep: f64, steps: u64 },
    /// A pair's tolerance, and about how many steps it will take over the duration, s.
    Tolerance {
        tolerance: f64,
        duration: f64,
        steps: u64,
        /// It is stopped after so many.
        most: u64,
    },
}

impl Setting {
    /// `steps` steps over the duration, s.
    pub fn of_steps(duration: f64, steps: u64) -> Self {
        Self::Step {
            timestep: duration / steps as f64,
            steps,
        }
    }

    /// Seconds; of a pair about.
    pub fn timestep(&self) -> f64 {
        match self {
            Self::Step { timestep, .. } => *timestep,
            Self::Tolerance {
                duration, steps, ..
            } => duration / *steps as f64,
        }
    }

    /// How many; of a pair about.
    pub fn steps(&self) -> u64 {
        match self {
            Self::Step { steps, .. } | Self::Tolerance { steps, .. } => *steps,
        }
    }

    /// After how many it is stopped.
    pub fn most(&self) -> u64 {
        match self {
            Self::Step { steps, .. } => *steps,
            Self::Tolerance { most, .. } => *most,
        }
    }

    pub fn tolerance(&self) -> Option<f64> {
        match self {
            Self::Step { .. } => None,
            Self::Tolerance { tolerance, .. } => Some(*tolerance),
        }
    }

    /// Whether it is as coarse as another of the same engine, or coarser.
    pub fn is_no_finer(&self, other: &Self) -> bool {
        match (self.tolerance(), other.tolerance()) {
            (Some(own), Some(other)) => own >= other,
            _ => self.steps() <= other.steps(),
        }
    }
}
