//! The results of `run` and `compare` as data: an [`Outcome`] for each engine and timestep, and the series its
//! figures are drawn from.

use crate::measure::identify::{Explained, Identity};
use crate::measure::{
    Constrained, Contact, Deviation, Energy, ErrorSummary, Loads, Momentum, Strain,
};
use crate::report::page::playback::Playback;
use crate::solvers::{Built, SolverKind, Status};
use crate::verbs::clock::WallTime;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The outcome of one engine at one timestep.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
pub struct Outcome {
    /// The id of an integrator, of an engine, or the name of a program.
    pub engine: String,
    /// What kind of solver it is.
    pub kind: SolverKind,
    /// Seconds between recorded steps of this engine.
    pub timestep: f64,
    /// The step that the scheme takes, s: rapier's dt / iterations, else the timestep.
    pub substep: f64,
    /// How the run ended.
    pub status: Status,
    /// The time at which the run ended early, s; null if it did not.
    pub stopped_at_s: Option<f64>,
    /// The reason why it ended early or is unsupported.
    pub reason: Option<String>,
    /// The error against the truth; null where there is none.
    pub position_error_m: Option<ErrorSummary>,
    /// The same for velocities.
    pub velocity_error_m_s: Option<ErrorSummary>,
    /// The deviation from each reference engine that ran at this timestep.
    pub deviation_m: BTreeMap<String, Deviation>,
    /// Null when nothing was recorded (unsupported) or no velocities are known.
    pub energy: Option<Energy>,
    /// How far it is off the scene's rods, and how they pull; left out without rods, and where nothing was recorded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rods: Option<Constrained>,
    /// Null where the scene keeps neither, or nothing was recorded.
    pub momentum: Option<Momentum>,
    /// Contact with obstacles; null where the scene has none, or nothing was recorded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact: Option<Contact>,
    /// The strain of springs; null where the scene has no strain limit, or nothing was recorded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub strain: Option<Strain>,
    /// Tensions of springs and reactions of fixed particles; null where they were not asked for, or velocities are not
    /// known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub loads: Option<Loads>,
    /// What the run took.
    pub work: WorkSummary,
    /// The scheme it follows by replay; null where there is nothing to replay.
    pub identified: Option<Identity>,
    /// What it deviates in, where it follows no scheme exactly; null where it does.
    pub explained: Option<Explained>,
    /// Plain sentences for the table's foot.
    pub remarks: Vec<String>,
}

/// The computational work of one run: counts and wall time. Not the work that forces do, `physics::Work`.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
pub struct WorkSummary {
    /// Timesteps taken.
    pub steps: u64,
    /// Evaluations of all forces; null where the engine does not report them (rapier's joints).
    pub force_evaluations: Option<u64>,
    /// Linear systems solved; null where the engine does not report them.
    pub linear_solves: Option<u64>,
    /// What a rapier world was built of; null for every other engine.
    #[serde(default)]
    pub world: Option<Built>,
    /// Wall time of a run, s; null where it was not timed.
    pub wall_s: Option<WallTime>,
}

/// The series that the figures of `run` and `compare` are drawn from.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct RunSeries {
    /// The curves of each outcome that recorded anything, in the outcomes' order.
    pub curves: Vec<Curves>,
    /// The truth, up to its horizon.
    pub truth: Option<Box<TruthCurves>>,
    /// The axis of the scene's `plot`: its label and range.
    pub plot: Option<PlotAxis>,
    /// The two coordinates (0, 1, 2) trajectories are projected on: the widest, `up` vertical.
    pub plane: [usize; 2],
    /// The coordinate of the phase portrait, such as `particle 1, z`: that of `plot`, else the one that moves most.
    #[serde(default)]
    pub phase: Option<String>,
    /// Fixed particles on that plane, drawn as squares.
    pub fixed: Vec<[f64; 2]>,
    /// The motion in 3D; None where no page is written, or it would be too large.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub playback: Option<Box<Playback>>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct PlotAxis {
    /// Such as `particle 1, z (m)`.
    pub label: String,
    pub y_range: Option<[f64; 2]>,
}

/// Series over the recorded instants of one outcome; all finite, equally long where not empty.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Curves {
    /// Index into the report's outcomes.
    pub outcome: usize,
    /// Seconds.
    pub t: Vec<f64>,
    /// (B - B(0)) / S, or joules where the scene has no scale; empty where no velocities are known.
    pub energy: Vec<f64>,
    /// The largest distance of a particle from the truth, m, up to the truth's horizon; empty without a truth.
    #[serde(default)]
    pub errors: Vec<f64>,
    /// The largest error of a rod's length, m; empty without rods.
    #[serde(default)]
    pub rods: Vec<f64>,
    /// The coordinate that `plot` names, m; empty without one.
    pub plot: Vec<f64>,
    /// A few particles' paths projected on [`RunSeries::plane`]: one polyline each.
    pub paths: Vec<Vec<[f64; 2]>>,
    /// The coordinate that [`RunSeries::phase`] names and its velocity, m and m/s; empty where velocities are not known.
    #[serde(default)]
    pub phase: Vec<[f64; 2]>,
}

/// Series of the truth over some instants; all finite, equally long.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct TruthCurves {
    /// Seconds.
    pub t: Vec<f64>,
    /// The coordinate that `plot` names, m, as in [`Curves`].
    pub plot: Vec<f64>,
    /// The paths of the same particles as in [`Curves`].
    pub paths: Vec<Vec<[f64; 2]>>,
    /// As in [`Curves`].
    #[serde(default)]
    pub phase: Vec<[f64; 2]>,
}
