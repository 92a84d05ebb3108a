//! The result of `stability`: how large a step may be, as data.

use crate::measure::stability::{Cell, TightestLimit};
use crate::solvers::SolverKind;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How large a step may be, on this scene.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
pub struct Stability {
    /// The largest frequency of the scene linearised about its start; null where nothing oscillates.
    pub omega_max_rad_s: Option<f64>,
    /// Whether `omega_max_rad_s` is null because it could not be found.
    pub unsure: bool,
    /// The trajectory was searched for the tightest limit up to here, s. It is the whole duration where
    /// every force is linear, since the limit is then the same everywhere.
    pub horizon_s: f64,
    /// The timestep at which growth is taken and which is compared with the limits, s.
    pub timestep_s: f64,
    /// Whether every force is linear: then limits do not depend on the state, and prediction and
    /// measurement must agree.
    pub linear: bool,
    /// Modes left out of the prediction, in words.
    pub excluded: Vec<String>,
    /// One for each engine.
    pub rows: Vec<StabilityRow>,
    /// Timestep against a quantity of the scene; null without one.
    pub map: Option<StabilityMap>,
    /// How large one quantity may be at the timestep; null where it was not asked for.
    pub largest: Option<Box<Largest>>,
    /// Where a step does not enlarge the force of a spring; null without the picture.
    pub admissible: Option<Admissible>,
}

/// One engine's limit.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
pub struct StabilityRow {
    /// The engine's id.
    pub engine: String,
    /// What kind of solver it is.
    pub kind: SolverKind,
    /// Whether the engine refuses the scene: `reason` says why, and nothing was searched.
    pub unsupported: bool,
    /// The predicted limit about the start, s: 0 where no step is stable; null where every step is
    /// (`unconditional`), or where it is not known (`reason`).
    pub predicted_limit_s: Option<f64>,
    /// The limit found by running, s; 0 and null mean the same.
    pub measured_limit_s: Option<f64>,
    /// The bracket where the search ended early: the largest step found stable and the smallest found
    /// unstable, s; null where the limit was found, or no bracket was.
    pub measured_between_s: Option<[f64; 2]>,
    /// Whether every step is predicted stable.
    pub unconditional: bool,
    /// Whether every step tried was stable.
    pub measured_unconditional: bool,
    /// ln(spectral radius) / h of the amplitude at `timestep_s`, predicted; null where stable.
    pub growth_per_s: Option<f64>,
    /// The measured growth; null where stable.
    pub measured_growth_per_s: Option<f64>,
    /// Where nothing oscillates: the largest step, s, at which every mode decays without changing
    /// sign, predicted and measured; null where something oscillates in truth.
    pub smooth_below_s: Option<f64>,
    /// The same, measured by running, s.
    pub measured_smooth_below_s: Option<f64>,
    /// The tightest predicted limit along the trajectory.
    pub tightest: Option<TightestLimit>,
    /// All remarks as one text.
    pub reason: Option<String>,
    /// The remarks one by one, for reports that group equal ones.
    pub remarks: Vec<String>,
}

impl StabilityRow {
    /// The least limit that is known, s: measured (of a bracket the lower end), predicted at the start or where the
    /// motion leads. Growth that ends, or is too slow to show over the steps of a search, is unstable all the same.
    /// Infinite where every step is stable; None where nothing is known.
    pub fn limit(&self) -> Option<f64> {
        let endless = |yes: bool| yes.then_some(f64::INFINITY);
        let known = [
            self.measured_limit_s,
            endless(self.measured_unconditional),
            self.measured_between_s.map(|[low, _]| low),
            self.predicted_limit_s,
            endless(self.unconditional),
            self.tightest.as_ref().map(|tightest| tightest.limit_s),
        ];
        known.into_iter().flatten().reduce(f64::min)
    }

    /// Whether a step, s, and all smaller ones are stable; None where no limit is known.
    pub fn holds(&self, timestep: f64) -> Option<bool> {
        if let Some([low, high]) = self.measured_between_s
            && (low..high).contains(&timestep)
        {
            return None;
        }
        // A limit is known to a thousandth of itself.
        self.limit().map(|limit| timestep <= limit * 1.001)
    }
}

/// The largest value of one quantity of the scene at which a step is within the predicted limit.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
pub struct Largest {
    /// The key, such as `springs.stiffness`.
    pub vary: String,
    /// The unit of the values.
    pub unit: String,
    /// The step that has to be stable, s.
    pub timestep_s: f64,
    /// The smallest and the largest value tried.
    pub tried: [f64; 2],
    /// In the order of the rows.
    pub rows: Vec<LargestRow>,
}

/// One engine's largest value.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
pub struct LargestRow {
    /// The engine's id.
    pub engine: String,
    /// What the search found.
    pub found: LargestFound,
    /// The largest value that is stable; null unless one was found.
    pub value: Option<f64>,
    /// Why it is not known; else null.
    pub reason: Option<String>,
}

/// What the search for a largest value found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LargestFound {
    /// Up to this one values are stable.
    Value,
    /// The step is stable at every value tried.
    EveryValue,
    /// It is stable at none.
    NoValue,
    /// The limit that it follows from is not known.
    NotKnown,
}

/// The outcomes of runs at several timesteps, as one quantity of the scene varies.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
pub struct StabilityMap {
    /// The key that varies, such as `springs.stiffness` or `particles[1].mass`.
    pub vary: String,
    /// The unit of the values.
    pub unit: String,
    /// Ascending.
    pub values: Vec<f64>,
    /// Ascending, s.
    pub timesteps_s: Vec<f64>,
    /// Steps each cell may take within the budget.
    pub steps_per_cell: u64,
    /// In the order of the rows.
    pub engines: Vec<MapPanel>,
}

/// One engine's part of a map.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
pub struct MapPanel {
    /// The engine's id.
    pub engine: String,
    /// Indexed by value, then by timestep; null where the engine refuses the scene.
    pub cells: Vec<Vec<Option<Cell>>>,
    /// The limit about the varied scene's start, for each value; 0 where no step is stable, null where
    /// every step is or no limit is known.
    pub predicted_limit_s: Vec<Option<f64>>,
}

/// The admissible region of two free particles on one spring: the places at rest from where one step does
/// not enlarge the spring's force.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
pub struct Admissible {
    /// The method. Its first two steps are taken, since the first moves nothing.
    pub engine: String,
    /// The step, s.
    pub timestep_s: f64,
    /// The masses of the two particles, kg.
    pub masses_kg: [f64; 2],
    /// The spring's rest length, m.
    pub rest_length_m: f64,
    /// Positions along the line, m, ascending; no difference between the two axes is 0 or the rest
    /// length, where nothing moves.
    pub x1_m: Vec<f64>,
    /// The same of the second particle, m.
    pub x2_m: Vec<f64>,
    /// One for each stiffness.
    pub panels: Vec<AdmissiblePanel>,
}

/// The region at one stiffness.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
pub struct AdmissiblePanel {
    /// The spring's stiffness, N/m.
    pub stiffness_n_m: f64,
    /// The admitted fraction of all places, 0 to 1.
    pub share: f64,
    /// A line for each x2 with a character for each x1: `1` where the force does not grow, else `0`.
    pub admitted: Vec<String>,
}
