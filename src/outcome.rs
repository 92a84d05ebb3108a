//! What a verb found, as data: the JSON contract (`docs/contract.md`) as types, and beside it the
//! series that figures are drawn from. Everything that is printed or drawn is a function of this.
//!
//! Every number that could be missing is an `Option`; no field ever holds NaN or infinity.

mod cost;
mod series;
mod stability;

pub use cost::{Cost, CostCurve, CostPoint, CostRank, CostReached, CostTarget};
pub use series::{
    Beside, CostLine, CostPanel, CostPanels, Curves, Figures, PlotAxis, Series, TruthCurves,
};
pub use stability::{
    Admissible, AdmissiblePanel, Cell, MapPanel, Stability, StabilityMap, StabilityRow,
    TightestLimit,
};

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Everything one verb found of one scene: complete when it is made, and equal after it was written
/// as JSON and read again.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Report {
    #[serde(flatten)]
    pub header: Header,
    #[serde(flatten)]
    pub body: Body,
    /// What only figures need. The JSON says whether there is any; it lies in a file beside it.
    #[serde(rename = "series", default)]
    pub beside: Beside,
}

/// What the reports of all verbs have.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Header {
    pub scene: SceneFacts,
    pub truth: Truth,
    pub checks: Vec<Check>,
}

/// What one verb found. The JSON's key `verb` says which it is.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(tag = "verb", rename_all = "snake_case")]
pub enum Body {
    Run {
        outcomes: Vec<Outcome>,
    },
    Compare {
        outcomes: Vec<Outcome>,
        /// The first step that leaves the scheme; null where none does.
        fault: Option<Fault>,
    },
    Stability {
        /// There for readers that look for outcomes in every report.
        outcomes: [(); 0],
        stability: Stability,
    },
    Cost {
        /// As in `Stability`.
        outcomes: [(); 0],
        cost: Cost,
    },
}

impl Report {
    /// One for each engine and timestep; none where the verb has other answers.
    pub fn outcomes(&self) -> &[Outcome] {
        match &self.body {
            Body::Run { outcomes } | Body::Compare { outcomes, .. } => outcomes,
            Body::Stability { .. } | Body::Cost { .. } => &[],
        }
    }

    /// Of `stability` alone.
    pub fn stability(&self) -> Option<&Stability> {
        match &self.body {
            Body::Stability { stability, .. } => Some(stability),
            _ => None,
        }
    }

    /// Of `cost` alone.
    pub fn cost(&self) -> Option<&Cost> {
        match &self.body {
            Body::Cost { cost, .. } => Some(cost),
            _ => None,
        }
    }
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct SceneFacts {
    pub name: String,
    pub file: String,
    pub particles: usize,
    pub springs: usize,
    /// Only what the scene calls for.
    pub effects: Vec<EffectUse>,
    /// The scene's own timestep, seconds.
    pub timestep: f64,
    /// Seconds.
    pub duration: f64,
    /// The scale S that energy errors are relative to, joules; null where the scene has none.
    pub energy_scale_j: Option<f64>,
    /// Free text from the file, for headings.
    pub description: Option<String>,
    /// The id of the integrator the file names.
    pub own_integrator: String,
}

/// One line of the effect ledger.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct EffectUse {
    pub id: String,
    /// Particles, springs or pairs it acts on.
    pub members: usize,
    /// Times its force was evaluated, summed over the hand-written integrators of this run.
    pub evaluations: u64,
    /// Nanoseconds one evaluation takes, measured.
    pub wall_ns: Option<f64>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Truth {
    pub kind: TruthKind,
    /// The form, or the reference's methods and steps.
    pub method: Option<String>,
    /// Largest error bar of positions up to the horizon.
    pub error_bound_m: Option<f64>,
    /// Until when positions mean anything.
    pub horizon_s: Option<f64>,
    /// Why there is none, or why this form applies.
    pub reason: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TruthKind {
    ClosedForm,
    Converged,
    None,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    Integrator,
    Rapier,
    External,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    Completed,
    Diverged,
    Failed,
    Unsupported,
}

/// One engine at one timestep.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Outcome {
    pub engine: String,
    pub kind: Kind,
    /// Seconds between recorded steps of this engine.
    pub timestep: f64,
    /// The step the scheme really takes: rapier's dt / iterations, else the timestep.
    pub substep: f64,
    pub status: Status,
    /// Null unless the run ended early.
    pub stopped_at_s: Option<f64>,
    /// Why it ended early or is unsupported.
    pub reason: Option<String>,
    /// Against the truth; null where there is none.
    pub position_error_m: Option<Spread>,
    pub velocity_error_m_s: Option<Spread>,
    /// Against each reference engine that ran at this timestep.
    pub deviation_m: BTreeMap<String, Deviation>,
    /// Null when nothing was recorded (unsupported) or no velocities are known.
    pub energy: Option<Energy>,
    pub momentum: Option<Momentum>,
    pub work: Work,
    /// Null where there is nothing to replay.
    pub identified: Option<Identified>,
    /// Plain sentences for the table's foot.
    pub remarks: Vec<String>,
}

/// Largest distance of a particle from where it truly is (m) or from its true velocity (m/s), over
/// the recorded instants up to the truth's horizon.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Spread {
    /// At the last of these instants.
    #[serde(rename = "final")]
    pub last: f64,
    pub max: f64,
    pub rms: f64,
}

/// Largest distance over the particles, metres, over the instants both engines recorded.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Deviation {
    #[serde(rename = "final")]
    pub last: f64,
    pub max: f64,
    /// When it first passed the tolerance (1 % of the scene's size); null if never.
    pub first_exceeds_s: Option<f64>,
}

/// The energy balance B = E + dissipated - injected.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Energy {
    pub initial_j: Option<f64>,
    pub final_j: Option<f64>,
    /// max |B - B(0)| / S.
    pub relative_error_max: Option<f64>,
    /// Fitted trend of B, in units of S per second.
    pub drift_per_s: Option<f64>,
    /// 99.9 % interval of the trend, autocorrelation accounted for.
    pub drift_per_s_ci: Option<[f64; 2]>,
    /// Half the peak-to-peak of what the trend leaves, in units of S.
    pub fluctuation: Option<f64>,
    pub class: Option<EnergyClass>,
    /// Kinetic energy at the end.
    pub kinetic_final_j: Option<f64>,
    /// Potential energy at the end, by the id of the effect that holds it.
    pub potential_final_j: BTreeMap<String, f64>,
    /// Taken out and put in by effects over the run; 0 where the scene has neither.
    pub dissipated_j: Option<f64>,
    pub injected_j: Option<f64>,
}

impl Energy {
    /// Whether less energy is left at the end than there was, both known. Not to be confused with the
    /// class, which judges the balance: where dampers are booked more than they took, that grows.
    pub fn lost(&self) -> bool {
        matches!((self.initial_j, self.final_j), (Some(initial), Some(last)) if last < initial)
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EnergyClass {
    Bounded,
    Drifting,
    Dissipating,
    Growing,
}

/// Largest departure from the initial value; null where the scene does not conserve it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Momentum {
    #[serde(rename = "linear_error_max_kg_m_s")]
    pub linear_error_max: Option<f64>,
    /// About the origin.
    #[serde(rename = "angular_error_max_kg_m2_s")]
    pub angular_error_max: Option<f64>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Work {
    pub steps: u64,
    /// Evaluations of all forces; null where the engine does not tell (rapier's joints).
    pub force_evaluations: Option<u64>,
    pub linear_solves: Option<u64>,
    pub wall_s: Option<WallTime>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct WallTime {
    pub min: f64,
    pub median: f64,
    /// Median absolute deviation; null for a single run.
    pub mad: Option<f64>,
}

/// The scheme a trajectory follows, by one-step replay.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Identified {
    /// A method's id, or a common mistake's.
    pub method: String,
    /// Steps it takes inside one timestep.
    pub substeps: u32,
    /// Largest distance of a replayed step from the recorded one over the steps that follow the
    /// scheme, in units of what rounding explains; the median over all where nothing fits.
    pub defect: f64,
    /// The nearest scheme that is not equivalent, as `method` or `method/substeps`.
    pub runner_up: Option<String>,
    pub runner_up_defect: Option<f64>,
    /// One scheme and no other explains the data.
    pub decisive: bool,
    /// Others that explain it as well.
    pub equivalent: Vec<String>,
    /// Why it is not decisive; null where it is.
    pub undecided: Option<Undecided>,
}

/// Why a trajectory has not one scheme.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Undecided {
    /// The equivalent ones are the same map where this trajectory goes: no data could tell.
    SameMap,
    /// They differ by less than the data is rounded.
    DataTooCoarse,
    /// Rounding explains none.
    NothingFits,
}

/// The first step of a trajectory that does not follow its scheme.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fault {
    /// Step n leads from t_n to t_n+1, zero-based; of rows several steps apart, the first of the
    /// steps between them.
    pub step: u64,
    /// t_n, seconds.
    pub t_s: f64,
    /// The particle that is off farthest.
    pub particle: usize,
    /// What `expected` and `found` are of it, at the end of the step or of the span: x, y, z.
    pub quantity: Quantity,
    /// By the scheme, from the row before.
    pub expected: [f64; 3],
    /// As recorded; null where that is not a finite number.
    pub found: [Option<f64>; 3],
    /// The change that explains it, when it acts, and how many particles are off.
    pub explanation: String,
}

/// What a fault shows in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Quantity {
    #[serde(rename = "position_m")]
    Position,
    #[serde(rename = "velocity_m_s")]
    Velocity,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Check {
    pub id: String,
    pub subject: String,
    pub status: CheckStatus,
    pub measured: Option<f64>,
    pub bound: Option<f64>,
    pub derivation: String,
    pub message: String,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CheckStatus {
    Pass,
    Fail,
    Skip,
    Inconclusive,
}
