//! How large a step may be: of every chosen engine predicted and measured, along the trajectory, and
//! as a map.

mod admissible;
mod args;
mod explain;
mod figures;
mod map;
mod path;
mod result;
mod rows;
mod text;
mod vary;

pub use admissible::NotAdmissible;
pub(super) use figures::FIGURES;
pub use map::{BudgetError, MapPlan};
pub(super) use text::{page, view};
pub use vary::{COUNT, Range, Vary, VaryError};

pub use args::{Args, stability};
pub use result::{Admissible, AdmissiblePanel, MapPanel, Stability, StabilityMap, StabilityRow};

use crate::measure;
use crate::measure::stability::{Effort, Linearised, is_linear};
use crate::physics::ParticleSystem;
use crate::report::{Header, TruthFacts};
use crate::scene::Scene;
use crate::solvers::{Solver, Tally};
use crate::truth::TruthKind;
use crate::verbs::host::Host;
use crate::verbs::run::ledger;
use crate::verbs::{Beside, Body, Report};
use rayon::prelude::*;
use std::sync::Arc;

/// What is asked of one scene.
#[derive(Debug, Clone)]
pub struct StabilityPlan<'a> {
    pub scene: &'a Scene,
    /// In the order of the rows. A timestep of their own is not looked at: the step is what is searched.
    pub solvers: Vec<Solver>,
    /// Where growth is taken, seconds.
    pub timestep: f64,
    pub map: Option<MapPlan>,
    /// Stiffnesses, N/m, of the pictures of where a step does not enlarge a spring's force; empty for
    /// none.
    pub admissible: Vec<f64>,
}

/// What all rows share.
pub struct Asked<'a> {
    pub plan: &'a StabilityPlan<'a>,
    pub system: &'a ParticleSystem,
    pub linearised: &'a Linearised,
    pub linear: bool,
    pub path: &'a path::Path,
    /// What integrators evaluated, over all runs.
    pub tally: &'a Arc<Tally>,
}

impl StabilityPlan<'_> {
    /// Rows, map and picture, in parallel; the same bits on any number of threads. What cannot be
    /// answered is a row with its reason.
    ///
    /// # Errors
    /// Before anything runs: a budget that leaves the map's cells too few steps, or a picture of a
    /// scene that is not two free particles on one spring.
    pub fn execute(&self, host: &dyn Host) -> Result<Report, StabilityError> {
        let scene = self.scene;
        let pair = match self.admissible.as_slice() {
            [] => None,
            stiffnesses => Some(admissible::draw(scene, self.timestep, stiffnesses)?),
        };
        let tally = Arc::new(Tally::default());
        let map = match &self.map {
            Some(map) => Some(map.cells(scene, self.solvers.len())?),
            None => None,
        };
        let system = ParticleSystem::new(scene);
        let start = ParticleSystem::initial_state(scene);
        let linearised = Linearised::new(&system, &start, Effort::FULL);
        let linear = is_linear(scene);
        let path = path::of(self, &system, &linearised, linear);
        let asked = Asked {
            plan: self,
            system: &system,
            linearised: &linearised,
            linear,
            path: &path,
            tally: &tally,
        };
        let rows = self
            .solvers
            .par_iter()
            .map(|solver| rows::row(&asked, solver, host))
            .collect();
        let map = map.map(|cells| cells.run(scene, &self.solvers, &tally, host));
        let stability = Stability {
            omega_max_rad_s: linearised.omega_max().filter(|w| w.is_finite()),
            unsure: linearised.is_unsure(),
            horizon_s: path.until,
            timestep_s: self.timestep,
            linear,
            excluded: linearised.excluded().to_vec(),
            rows,
            map,
            admissible: pair,
        };
        let scale = measure::energy_scale(scene, &system, None);
        Ok(Report {
            header: Header {
                scene: ledger::facts(
                    scene,
                    ledger::effects(scene, &system, tally.evaluations()),
                    scale,
                ),
                truth: TruthFacts {
                    kind: TruthKind::None,
                    method: None,
                    error_bound_m: None,
                    horizon_s: None,
                    reason: Some("stability compares nothing with a truth".to_owned()),
                },
                checks: Vec::new(),
            },
            body: Body::Stability {
                outcomes: [],
                stability,
            },
            beside: Beside::Nothing,
        })
    }

    /// Steps that may be taken at most: what a progress bar counts against, and times are guessed from.
    ///
    /// # Errors
    /// A budget that leaves the map's cells too few steps.
    pub fn steps(&self) -> Result<u64, BudgetError> {
        let of_map = match &self.map {
            Some(map) => map.cells(self.scene, self.solvers.len())?.steps(),
            None => 0,
        };
        Ok(self
            .steps_by_row()
            .iter()
            .sum::<u64>()
            .saturating_add(of_map))
    }

    /// Of each row's search, in the order of the rows: what it mostly takes.
    pub fn steps_by_row(&self) -> Vec<u64> {
        let usual = |solver| rows::usual(self.scene, solver, self.timestep);
        self.solvers.iter().map(usual).collect()
    }
}

/// Why a plan cannot be carried out.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StabilityError {
    #[error(transparent)]
    Budget(#[from] BudgetError),
    #[error(transparent)]
    NotAdmissible(#[from] NotAdmissible),
}
