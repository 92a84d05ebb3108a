//! How large a step may be: predicted from the linearised scene and a method's stability region,
//! and measured on the scene itself.

mod measured;
mod predicted;

pub use measured::{Cell, MakeRun, MeasuredLimit, classify, measure};
pub use predicted::{
    Effort, Linearised, LinearisedTrajectory, Prediction, TightestLimit, is_linear,
};

/// The largest step that is stable, with all smaller ones.
#[derive(Debug, Clone, PartialEq)]
pub enum Limit {
    /// No step is stable: the energy of some mode grows at every step size.
    Never,
    /// The largest stable step, s.
    At(f64),
    /// It lies between the largest step found stable and the smallest found unstable, s: the budget
    /// ended first.
    Between(f64, f64),
    /// Every step is stable.
    Unconditional,
    /// It was not found, and why.
    Unknown(String),
}

impl Limit {
    /// Whether a step of `h` seconds is stable, as far as is known.
    pub fn allows(&self, h: f64) -> bool {
        match self {
            Self::Unconditional => true,
            Self::At(limit) | Self::Between(limit, _) => h <= *limit,
            Self::Never | Self::Unknown(_) => false,
        }
    }
}
