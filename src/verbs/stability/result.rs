//! How large a step may be, as data.

use crate::measure::stability::{Cell, TightestLimit};
use crate::solvers::Kind;
use serde::{Deserialize, Serialize};

/// How large a step may be, on this scene.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Stability {
    /// Of the scene linearised about its start; null where nothing oscillates.
    pub omega_max_rad_s: Option<f64>,
    /// `omega_max_rad_s` is null because nobody knows it.
    pub unsure: bool,
    /// Up to when the trajectory was searched for the tightest limit, s; the whole duration where
    /// every force is linear, since the limit is then the same everywhere.
    pub horizon_s: f64,
    /// The step at which growth is taken, and whose place beside the limits is told, s.
    pub timestep_s: f64,
    /// Every force is linear: a limit depends on no state, and prediction and measurement must agree.
    pub linear: bool,
    /// Modes left out of the prediction, in words.
    pub excluded: Vec<String>,
    pub rows: Vec<StabilityRow>,
    /// Timestep against a quantity of the scene; null where none was asked for.
    pub map: Option<StabilityMap>,
    /// Where a step does not enlarge the force of a spring; null where it was not asked for.
    pub admissible: Option<Admissible>,
}

/// One engine's limit.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct StabilityRow {
    pub engine: String,
    pub kind: Kind,
    /// The engine does not take the scene: `reason` says why, and nothing was searched.
    pub unsupported: bool,
    /// About the start; 0 where no step is stable; null where every step is (`unconditional`) and
    /// where none is known (`reason`).
    pub predicted_limit_s: Option<f64>,
    /// By running; 0 and null likewise.
    pub measured_limit_s: Option<f64>,
    /// Where the search ended before it knew better: the largest step found stable and the smallest
    /// found unstable, s; null where the limit was found, or nothing was.
    pub measured_between_s: Option<[f64; 2]>,
    /// Stable at every step: predicted.
    pub unconditional: bool,
    /// Stable at every step tried.
    pub measured_unconditional: bool,
    /// ln(spectral radius) / h of the amplitude at `timestep_s`, predicted; null where stable.
    pub growth_per_s: Option<f64>,
    /// The same, measured.
    pub measured_growth_per_s: Option<f64>,
    /// Where nothing oscillates: the largest step, s, at which every mode decays without changing
    /// sign, predicted and measured; null where something oscillates in truth.
    pub smooth_below_s: Option<f64>,
    pub measured_smooth_below_s: Option<f64>,
    /// Along the trajectory.
    pub tightest: Option<TightestLimit>,
    /// What there is to say, sentence after sentence.
    pub reason: Option<String>,
    /// The same sentences one by one, for reports that say equal ones once.
    pub remarks: Vec<String>,
}

impl StabilityRow {
    /// The limit to go by, seconds: measured, else predicted. Infinite where every step is stable;
    /// None where neither is known. Of a bracket its lower end.
    pub fn limit(&self) -> Option<f64> {
        let endless = |yes: bool| yes.then_some(f64::INFINITY);
        self.measured_limit_s
            .or(endless(self.measured_unconditional))
            .or(self.measured_between_s.map(|[low, _]| low))
            .or(self.predicted_limit_s)
            .or(endless(self.unconditional))
    }

    /// Whether a step, s, is stable with all smaller ones; None where no limit is known.
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

/// What becomes of a run at each of several timesteps, as one quantity of the scene varies.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct StabilityMap {
    /// The key that varies, such as `springs.stiffness` or `particles[1].mass`.
    pub vary: String,
    /// Of the values.
    pub unit: String,
    /// Ascending.
    pub values: Vec<f64>,
    /// Ascending, s.
    pub timesteps_s: Vec<f64>,
    /// Steps each cell may take, as the budget has it.
    pub steps_per_cell: u64,
    /// In the order of the rows.
    pub engines: Vec<MapPanel>,
}

/// One engine's part of a map.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct MapPanel {
    pub engine: String,
    /// By value, then by timestep; null where the engine does not take the scene.
    pub cells: Vec<Vec<Option<Cell>>>,
    /// By value: about the varied scene's start; 0 where no step is stable, null where every step is
    /// or no limit is known.
    pub predicted_limit_s: Vec<Option<f64>>,
}

/// Of two free particles on one spring, let go at rest: from where one step does not enlarge the
/// spring's force.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Admissible {
    /// The method, whose first two steps are taken: the first moves nothing.
    pub engine: String,
    pub timestep_s: f64,
    pub masses_kg: [f64; 2],
    pub rest_length_m: f64,
    /// Positions along the line, m, ascending; the two axes share no difference that is 0 or the rest
    /// length, where nothing moves.
    pub x1_m: Vec<f64>,
    pub x2_m: Vec<f64>,
    pub panels: Vec<AdmissiblePanel>,
}

/// One stiffness.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct AdmissiblePanel {
    pub stiffness_n_m: f64,
    /// Of all places, 0 to 1.
    pub share: f64,
    /// By x2, a character for each x1: `1` where the force does not grow, else `0`.
    pub admitted: Vec<String>,
}
