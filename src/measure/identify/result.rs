//! The result of an identification, as data.

use super::bounce::Bounce;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// The scheme a trajectory follows, exactly or nearly, by one-step replay.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Identity {
    /// Id of a method, of a composed scheme, or of a common mistake.
    pub method: String,
    /// Steps it takes inside one timestep.
    pub substeps: u32,
    /// What it does, where its name does not say it.
    #[serde(default)]
    pub says: Option<Cow<'static, str>>,
    /// Largest distance of a replayed row from the recorded one, in units of what rounding explains, over the
    /// transitions that follow the scheme; the median over all where it is only near.
    pub defect: f64,
    /// The median of the same distance in parts of what a transition moves.
    #[serde(default)]
    pub relative: Option<f64>,
    /// The nearest candidate that is told from it, as `method` or `method/substeps`.
    pub runner_up: Option<String>,
    /// Its defect over the transitions that told it apart.
    pub runner_up_defect: Option<f64>,
    /// Whether it explains the data to rounding, and no other candidate does.
    pub decisive: bool,
    /// The candidates that the data cannot tell from it, each method once with the fewest substeps:
    /// `heun`, `implicit_euler/4`.
    pub equivalent: Vec<String>,
    /// Why it is not decisive; null where it is.
    pub undecided: Option<Undecided>,
    /// Candidates that were not tried, for want of time.
    #[serde(default)]
    pub left_out: Vec<String>,
    /// What it does at contact; absent where nothing was touched in the replayed steps, and for springcheck's own engines,
    /// whose contact is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact: Option<Treated>,
    /// Whether it is a known mistake.
    #[serde(skip)]
    pub mistake: bool,
    /// Transitions replayed.
    #[serde(skip)]
    pub transitions: usize,
    /// How many of them follow the scheme.
    #[serde(skip)]
    pub followed: usize,
}

impl Identity {
    /// The id, and after a slash the substeps if there are several.
    pub fn label(&self) -> String {
        super::candidate::label(&self.method, self.substeps)
    }

    /// Whether rounding explains it as the scheme of this label, by name or among equals.
    pub fn is(&self, label: &str) -> bool {
        let named = self.label() == label;
        let listed = self.equivalent.iter().any(|id| id == label);
        (named || listed) && self.undecided != Some(Undecided::Near)
    }
}

/// How a trajectory's program treats contact with obstacles, by replay of steps beside them.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Treated {
    /// `impulse` at the impact, `flip_at_end`, `flip_at_start`, `flip_after_kick`, `flip_before_kick`, `penalty`,
    /// `soft_step`, or another id, and after each + what else is not as usual: `flip_at_end+clamped`; null where no known treatment
    /// explains the steps.
    pub treatment: Option<String>,
    /// Whether nothing can be said of it: without velocities, and where there are too many treatments to try.
    #[serde(default)]
    pub unjudged: bool,
    /// What it does, after "at contact it"; empty for the impulse at the impact. Where there is no treatment, why.
    pub says: String,
    /// The ids of what is wrong about it.
    pub mistakes: Vec<String>,
    /// How deep a particle is inside an obstacle in the recorded instants, m.
    pub deepest_m: f64,
    /// Of a penalty, found from the steps, N/m; else null.
    pub stiffness_n_m: Option<f64>,
    /// Of a penalty, found from the steps, N s/m; else null.
    pub damping_n_s_m: Option<f64>,
    /// Steps beside obstacles that were replayed.
    pub steps: usize,
    /// Treatments that these steps cannot tell from it; with another scheme where that is said.
    pub equivalent: Vec<String>,
    /// Its rows.
    #[serde(skip)]
    pub bounce: Option<Bounce>,
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
    /// The fewest changes that explain the trajectory; where nothing does, those that lower the difference most.
    pub deviations: Vec<Deviation>,
    /// Other schemes that as few changes explain it under, and as plain ones.
    #[serde(default)]
    pub equivalent: Vec<String>,
}

/// One thing that acts otherwise than the scene says.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Deviation {
    /// `gravity`, `springs.stiffness`, `springs.damping`, `springs.rest_length`, `springs.cubic`, `bending.stiffness`,
    /// `bending.rest_angle`, `bending.damping`, `drag`, `quadratic_drag`, `air_drag`, `air.velocity`, `charge`, `wind`,
    /// `gravitational`, `driven.sine.amplitude`, `driven.sine.omega`, `driven.sine.phase`, `driven.velocity`, `mass`, `velocity`, `timestep`, `axis`, `contact`,
    /// or what a known mistake changes.
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
