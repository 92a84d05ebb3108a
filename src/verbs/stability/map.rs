//! The stability map: timestep against one quantity of the scene, with the outcome of a run in each cell.

use super::range::{COUNT, Range, VaryError};
use super::rows::{as_keys, predicted, start};
use super::vary::Vary;
use crate::measure::stability::{Cell, Effort, Linearised, classify};
use crate::physics::ParticleSystem;
use crate::scene::{Scene, limits};
use crate::solvers::{Solver, Tally};
use crate::verbs::session::Session;
use crate::verbs::stability::{MapPanel, StabilityError, StabilityMap};
use rayon::prelude::*;
use std::sync::Arc;

/// Steps times particles of a whole map where no budget is given: some seconds.
const BUDGET: u64 = 40_000_000;
/// The fewest steps of a cell: fewer tell nothing.
pub(super) const MIN_STEPS: u64 = 100;
/// Steps of a cell in a large scene where no budget is given.
const DEFAULT_STEPS: u64 = 256;
/// The most steps of a cell: a run bounded over these is stable.
const MAX_STEPS: u64 = 20_000;

/// The axes and the budget of a map.
#[derive(Debug, Clone)]
pub struct MapPlan {
    pub vary: Vary,
    /// Timesteps, s; None for [`COUNT`] over the predicted limits and a decade on both sides.
    pub timesteps: Option<Range>,
    /// Steps times particles of all cells together; None for 4e7, or 256 steps a cell where that is
    /// more.
    pub budget: Option<u64>,
}

impl MapPlan {
    /// The cells of a map with this many panels, and the steps each may take.
    ///
    /// # Errors
    /// The budget leaves each cell too few steps.
    pub fn cells(&self, scene: &Scene, panels: usize) -> Result<[u64; 2], StabilityError> {
        let columns = self.timesteps.map_or(COUNT, |range| range.count);
        let cells = (panels.max(1) * self.vary.values.len() * columns) as u64;
        let particles = scene.particles.len().max(1) as u64;
        let each = cells.saturating_mul(particles).max(1);
        let steps = match self.budget {
            Some(budget) if budget / each < MIN_STEPS => {
                return Err(StabilityError::Budget {
                    budget,
                    cells,
                    steps: budget / each,
                    particles,
                    needed: each.saturating_mul(MIN_STEPS),
                });
            }
            Some(budget) => budget / each,
            None => (BUDGET / each).max(DEFAULT_STEPS),
        };
        Ok([cells, steps.min(MAX_STEPS)])
    }

    /// The scene with each value.
    ///
    /// # Errors
    /// Objects with one of these values cannot be made.
    pub fn scenes(&self, scene: &Scene) -> Result<Vec<Scene>, VaryError> {
        let values = self.vary.values.iter();
        values.map(|value| self.vary.apply(scene, *value)).collect()
    }

    /// Runs all cells: a panel for each solver. `scenes` come from [`scenes`](Self::scenes), and `steps_per_cell` from
    /// [`cells`](Self::cells).
    pub fn run(
        &self,
        scene: &Scene,
        scenes: &[Scene],
        solvers: &[Solver],
        steps_per_cell: u64,
        tally: &Arc<Tally>,
        session: &dyn Session,
    ) -> StabilityMap {
        let values = &self.vary.values;
        let linearised: Vec<Linearised> = scenes.par_iter().map(linearised).collect();
        // Indexed by solver, then by value.
        let limits: Vec<Vec<(Option<f64>, bool)>> = solvers
            .par_iter()
            .map(|solver| {
                let limit = |about: &Linearised| {
                    let prediction = predicted(about, solver, scene.solver.timestep);
                    prediction.map_or((None, false), |p| as_keys(&p.limit))
                };
                linearised.iter().map(limit).collect()
            })
            .collect();
        let range = self.timesteps.unwrap_or_else(|| {
            let (low, high) = decades(scene, &linearised, &limits);
            Range {
                low,
                high,
                count: COUNT,
            }
        });
        let timesteps = range.values();
        let places: Vec<(usize, usize, usize)> = (0..solvers.len())
            .flat_map(|s| (0..scenes.len()).map(move |v| (s, v)))
            .flat_map(|(s, v)| (0..timesteps.len()).map(move |h| (s, v, h)))
            .collect();
        let cells: Vec<Option<Cell>> = places
            .into_par_iter()
            .map(|(s, v, h)| {
                let (solver, scene, h) = (&solvers[s], &scenes[v], timesteps[h]);
                start(solver, scene, h, tally).ok()?;
                let make = |scene: &Scene, h| start(solver, scene, h, tally);
                let tick = |steps| session.progress(steps);
                Some(classify(scene, &make, h, steps_per_cell, &tick))
            })
            .collect();
        let mut rows = cells.chunks(timesteps.len().max(1)).map(<[_]>::to_vec);
        let engines = solvers
            .iter()
            .zip(limits)
            .map(|(solver, limits)| MapPanel {
                engine: solver.id.to_string(),
                cells: rows.by_ref().take(scenes.len()).collect(),
                predicted_limit_s: limits.into_iter().map(|(limit, _)| limit).collect(),
            })
            .collect();
        StabilityMap {
            vary: self.vary.id(),
            unit: self.vary.unit().to_owned(),
            values: values.clone(),
            timesteps_s: timesteps,
            steps_per_cell,
            engines,
        }
    }
}

fn linearised(scene: &Scene) -> Linearised {
    let system = ParticleSystem::new(scene);
    let start = ParticleSystem::initial_state(scene);
    Linearised::new(&system, &start, Effort::FULL)
}

/// Timesteps, s, from a decade below to a decade above the typical limits. The typical limit at a value is
/// the median over the engines that have one, else 2/ω; without any it is the scene's own step.
fn decades(
    scene: &Scene,
    linearised: &[Linearised],
    limits: &[Vec<(Option<f64>, bool)>],
) -> (f64, f64) {
    let typical = |value: usize| {
        let of_value = limits.iter().filter_map(|engine| engine.get(value)?.0);
        let mut found: Vec<f64> = of_value.filter(|h| *h > 0.0).collect();
        found.sort_by(f64::total_cmp);
        let median = found.get(found.len() / 2).copied();
        let frequency = linearised.get(value).and_then(Linearised::omega_max);
        median.or(frequency.map(|w| 2.0 / w))
    };
    let typical: Vec<f64> = (0..linearised.len())
        .filter_map(typical)
        .filter(|h| h.is_finite() && *h > 0.0)
        .collect();
    let low = typical.iter().copied().reduce(f64::min);
    let high = typical.iter().copied().reduce(f64::max);
    let own = scene.solver.timestep;
    let within = |h: f64| h.clamp(limits::TIMESTEP.low, limits::TIMESTEP.high);
    let (low, high) = (
        within(low.unwrap_or(own) / 10.0),
        within(high.unwrap_or(own) * 10.0),
    );
    (low.min(high / 2.0), high)
}
