//! How large a step may be: the limit of every chosen engine, predicted and measured, predicted again
//! along the trajectory, and as a map.

mod admissible;
mod args;
mod explain;
mod figures;
mod largest;
mod map;
mod path;
mod range;
mod result;
mod rows;
mod text;
mod vary;

pub(super) use figures::FIGURES;
pub use map::MapPlan;
pub use range::{COUNT, Range, VaryError};
pub(super) use text::{page, view};
pub use vary::{VariedKey, Vary};

pub(in crate::verbs) use args::estimates;
pub use args::{Args, stability};
pub use result::{
    Admissible, AdmissiblePanel, Largest, LargestFound, LargestRow, MapPanel, Stability,
    StabilityMap, StabilityRow,
};

use crate::measure::stability::{Effort, Linearised, is_linear};
use crate::physics::{ParticleSystem, System};
use crate::report::Header;
use crate::scene::Scene;
use crate::solvers::{self, Solver, Tally};
use crate::truth::Truth;
use crate::verbs::session::Session;
use crate::verbs::{Body, Report, SeriesState, facts};
use rayon::prelude::*;
use std::sync::Arc;

/// The question about one scene: the solvers whose limits to find, and the pictures to draw.
#[derive(Debug, Clone)]
pub struct StabilityPlan<'a> {
    pub scene: &'a Scene,
    /// In the order of the rows. A timestep of their own is ignored: the step is searched for.
    pub solvers: Vec<Solver>,
    /// The timestep at which growth is taken, seconds.
    pub timestep: f64,
    pub map: Option<MapPlan>,
    /// The quantity whose largest stable value at `timestep` is wanted.
    pub largest: Option<VariedKey>,
    /// Stiffnesses, N/m, at which to draw where a step does not enlarge a spring's force; empty for no
    /// picture.
    pub admissible: Vec<f64>,
}

impl<'a> StabilityPlan<'a> {
    /// Every method and rapier, at the scene's step, without pictures.
    pub fn default_for(scene: &'a Scene) -> Self {
        let mut solvers = solvers::methods(&scene.solver.method);
        solvers.extend(solvers::find("rapier"));
        Self {
            scene,
            solvers,
            timestep: scene.solver.timestep,
            map: None,
            largest: None,
            admissible: Vec::new(),
        }
    }
}

/// The linearised scene and its path, which all rows use.
pub struct Shared<'a> {
    pub plan: &'a StabilityPlan<'a>,
    pub system: ParticleSystem,
    /// The scene linearised about its start.
    pub linearised: Linearised,
    /// Whether every force is linear.
    pub linear: bool,
    pub path: path::Path,
    /// Evaluations of the integrators, over all runs.
    pub tally: Arc<Tally>,
}

impl Shared<'_> {
    /// Whether particles may collide by impulses, which are no part of what is predicted.
    fn bounces(&self) -> bool {
        let obstacles = self.system.obstacles();
        obstacles.is_some_and(|obstacles| obstacles.penalty().is_none())
    }
}

impl StabilityPlan<'_> {
    /// Finds rows, map and picture in parallel, with the same bits on any number of threads. An engine
    /// without an answer is a row with its reason.
    ///
    /// # Errors
    /// Before anything runs: the budget leaves the map's cells too few steps, objects with a value of the map cannot be
    /// made, or a picture is wanted of a scene that is not two free particles on one spring.
    pub fn execute(&self, session: &dyn Session) -> Result<Report, StabilityError> {
        let scene = self.scene;
        if scene.strain_limit.is_some() {
            let free = StabilityPlan {
                scene: &scene.without_strain_limit(),
                ..self.clone()
            };
            return free.execute(session).map(left_out);
        }
        let admissible = self.picture()?;
        let [_, steps_per_cell] = self.cells()?;
        let varied = self.map.as_ref().map(|map| map.scenes(scene)).transpose()?;
        let system = ParticleSystem::new(scene);
        let start = ParticleSystem::initial_state(scene);
        let linearised = Linearised::new(&system, &start, Effort::FULL);
        let linear = is_linear(scene);
        let shared = Shared {
            plan: self,
            path: path::of(self, &system, &linearised, linear),
            system,
            linearised,
            linear,
            tally: Arc::default(),
        };
        let (solvers, tally) = (&self.solvers, &shared.tally);
        let row = |solver| rows::row(&shared, solver, session);
        let rows = solvers.par_iter().map(row).collect();
        let map = self.map.iter().zip(&varied).next();
        let map = map
            .map(|(map, varied)| map.run(scene, varied, solvers, steps_per_cell, tally, session));
        let largest = self.largest.as_ref();
        let pressed = shared.path.pressed.as_ref();
        let largest =
            largest.map(|key| Box::new(largest::find(key, scene, solvers, self.timestep, pressed)));
        let Shared {
            system, linearised, ..
        } = &shared;
        let stability = Stability {
            omega_max_rad_s: linearised.omega_max().filter(|w| w.is_finite()),
            unsure: linearised.is_unsure(),
            horizon_s: shared.path.until,
            timestep_s: self.timestep,
            linear,
            excluded: linearised.excluded().to_vec(),
            rows,
            map,
            largest,
            admissible,
        };
        let truth = Truth::none("stability compares nothing with a truth");
        let scale = facts::energy_scale(scene, system, &truth);
        Ok(Report {
            header: Header {
                scene: facts::scene(scene, system, tally.evaluations(), scale),
                truth: facts::truth(&truth),
                checks: Vec::new(),
                advice: Vec::new(),
            },
            body: Body::Stability {
                outcomes: [],
                stability,
            },
            series: SeriesState::Nothing,
        })
    }

    /// The most steps that may be taken. The progress bar counts towards them, and times are estimated from
    /// them.
    ///
    /// # Errors
    /// The budget leaves the map's cells too few steps.
    pub fn steps(&self) -> Result<u64, StabilityError> {
        let [cells, each] = self.cells()?;
        let rows: u64 = self.steps_by_row().iter().sum();
        Ok(rows.saturating_add(cells.saturating_mul(each)))
    }

    /// The picture of a stiff spring, where it is asked for.
    ///
    /// # Errors
    /// Fails where the scene is not two free particles on one spring.
    pub fn picture(&self) -> Result<Option<Admissible>, StabilityError> {
        match self.admissible.as_slice() {
            [] => Ok(None),
            stiffnesses => admissible::draw(self.scene, self.timestep, stiffnesses).map(Some),
        }
    }

    /// The map's cells and the steps each may take; 0 without a map.
    fn cells(&self) -> Result<[u64; 2], StabilityError> {
        let cells = |map: &MapPlan| map.cells(self.scene, self.solvers.len());
        self.map.as_ref().map_or(Ok([0, 0]), cells)
    }

    /// The steps of the trajectory that is followed before the rows; 0 where every force is linear.
    pub fn steps_followed(&self) -> u64 {
        if is_linear(self.scene) {
            0
        } else {
            path::steps(self.scene)
        }
    }

    /// The steps each row's search usually takes, in the order of the rows.
    pub fn steps_by_row(&self) -> Vec<u64> {
        let usual = |solver| rows::usual_steps(self.scene, solver, self.timestep);
        self.solvers.iter().map(usual).collect()
    }
}

/// Says that the strain limit is left out: what it does in a step depends on the last, and takes energy out of any run.
fn left_out(mut report: Report) -> Report {
    if let Body::Stability { stability, .. } = &mut report.body {
        let what = "the strain limit: steps are those of the springs alone";
        stability.excluded.push(what.to_owned());
    }
    report
}

/// Why a plan cannot be carried out.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StabilityError {
    /// A budget too small for its map.
    #[error(
        "a budget of {budget} leaves each of {cells} cells {steps} steps of {particles} particles, and \
         fewer than {} tell nothing: {needed} would do, or fewer values, steps or engines",
        map::MIN_STEPS
    )]
    Budget {
        budget: u64,
        cells: u64,
        steps: u64,
        particles: u64,
        needed: u64,
    },
    /// A value that objects cannot have.
    #[error(transparent)]
    Vary(#[from] VaryError),
    /// A scene the picture cannot be drawn for, and what it has instead.
    #[error(
        "the admissible region is a picture of two free particles and one spring with a rest length, \
         and of nothing else that acts: {0}"
    )]
    NotAdmissible(String),
}
