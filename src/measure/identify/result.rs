//! The result of an identification, as data.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The scheme a trajectory follows, by one-step replay.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
pub struct Identified {
    /// A method's id, a composed scheme's, or a common mistake's.
    pub method: String,
    /// Steps it takes inside one timestep.
    pub substeps: u32,
    /// What it does, where its name does not say it.
    #[serde(default)]
    pub says: Option<String>,
    /// Largest distance of a replayed step from the recorded one over the steps that follow the
    /// scheme, in units of what rounding explains; the median over all where the scheme is only near.
    pub defect: f64,
    /// The median of the same distance in parts of what a step moves.
    #[serde(default)]
    pub relative: Option<f64>,
    /// The nearest scheme that is not equivalent, as `method` or `method/substeps`.
    pub runner_up: Option<String>,
    /// Its defect, in the same units.
    pub runner_up_defect: Option<f64>,
    /// Whether one scheme and no other explains the data.
    pub decisive: bool,
    /// Other schemes that explain the data as well.
    pub equivalent: Vec<String>,
    /// Why it is not decisive; null where it is.
    pub undecided: Option<Undecided>,
    /// Schemes that were not tried, to keep judging a run cheaper than the run.
    #[serde(default)]
    pub left_out: Vec<String>,
}

/// The reason why a trajectory's scheme is not decided.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Undecided {
    /// The equivalent ones are the same map where this trajectory goes: no data could tell.
    SameMap,
    /// They differ by less than the data is rounded.
    DataTooCoarse,
    /// Rounding does not explain it: the trajectory is only near this scheme.
    Near,
}

/// What makes a trajectory differ from a scheme that it was meant to follow.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Explained {
    /// The scheme that the deviations belong to; `truth` where every step is exact to rounding, so that none can be
    /// told; null where nothing explains the trajectory.
    pub scheme: Option<String>,
    /// What they leave: the median distance of a replayed step from the recorded one, in units of what
    /// rounding explains.
    pub residual: f64,
    /// The step that they leave most of, zero-based; null where rounding explains every step.
    pub largest_at: Option<u64>,
    /// The fewest changes that explain the trajectory.
    pub deviations: Vec<Deviation>,
}

/// One thing that acts otherwise than the scene says.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Deviation {
    /// `gravity`, `springs.stiffness`, `springs.damping`, `springs.rest_length`, `springs.cubic`, `drag`, `wind`,
    /// `gravitational`, `mass`, `velocity`, `timestep`, `axis`, or what a known mistake changes.
    pub what: String,
    /// How many times the scene's; of a velocity, the factor of each step.
    pub factor: f64,
    /// The member of the scene, the axis or the part of the step; null where it is all of them.
    #[serde(rename = "where")]
    pub place: Option<String>,
    /// The change in words.
    pub sentence: String,
}

/// The first step of a trajectory that does not follow its scheme.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Fault {
    /// Step n leads from t_n to t_n+1, zero-based; of rows several steps apart, the first of the
    /// steps between them.
    pub step: u64,
    /// t_n, seconds.
    pub t_s: f64,
    /// The particle that is off farthest.
    pub particle: usize,
    /// The quantity that `expected` and `found` give of it, x, y, z, at the end of the step or of the span.
    pub quantity: Quantity,
    /// The value by the scheme, from the row before.
    pub expected: [f64; 3],
    /// The value recorded; null where it is not a finite number.
    pub found: [Option<f64>; 3],
    /// The change that explains it, when it acts, and how many particles are off.
    pub explanation: String,
}

/// The quantity that a fault shows in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Quantity {
    #[serde(rename = "position_m")]
    Position,
    #[serde(rename = "velocity_m_s")]
    Velocity,
}
