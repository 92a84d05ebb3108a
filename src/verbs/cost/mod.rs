//! What accuracy costs: every chosen engine runs at a range of settings, and each run's error against
//! the truth stands beside its cost, counted and timed.
//!
//! Errors are found in parallel. Then the settings that completed are timed one after the other, with
//! nothing else running. Only wall times, and what is chosen by them, differ between two runs.

mod answer;
mod args;
mod diagram;
mod figures;
mod panels;
pub mod rank;
mod result;
mod runs;
mod samples;
mod settings;
mod text;

pub use args::{Args, cost};
pub(super) use figures::FIGURES;
pub use result::{
    Cost, CostCurve, CostLine, CostPanel, CostPanels, CostPoint, CostRank, CostReached, CostTarget,
};
pub(super) use text::{page, view};

use crate::integrators;
use crate::physics::ParticleSystem;
use crate::report::Header;
use crate::scene::Scene;
use crate::solvers::rapier::RapierSettings;
use crate::solvers::{self, Setting, Solver};
use crate::truth::{self, Demand};
use crate::verbs::session::{Label, Session, TimeEstimate};
use crate::verbs::{Body, Report, Series, SeriesState, facts};
use rayon::prelude::*;
use runs::{Curve, Setup};
use settings::Sweep;

/// The question: which solvers, at which settings, held against which targets.
#[derive(Debug, Clone)]
pub struct CostChoice {
    /// In the order of the curves. Adaptive pairs run at a range of tolerances, the others at a range of
    /// timesteps, so a timestep of their own is ignored.
    pub solvers: Vec<Solver>,
    /// Errors to reach, m.
    pub targets: Vec<f64>,
    /// Settings of each solver, at least 2. A few more are run where a target lies between two of them.
    pub settings: usize,
    /// Time all runs together may take, in seconds of a nominal machine: work is counted, so that every
    /// machine tries the same settings.
    pub budget_s: f64,
    /// Exactly these steps, s, instead of a range; adaptive pairs, which choose theirs, are left out.
    pub timesteps: Option<Vec<f64>>,
    /// The truth that errors are measured against.
    pub truth: Demand,
}

/// Errors to reach when none are named, m.
pub const TARGETS: [f64; 3] = [1e-3, 1e-6, 1e-9];
/// Settings of each engine when their number is not given.
pub const SETTINGS: usize = 12;
/// The budget when none is given, s.
pub const BUDGET_S: f64 = 30.0;
/// rapier's iterations that are tried beside its default.
const ITERATIONS: [u32; 2] = [1, 16];

impl CostChoice {
    /// Every method and pair, and rapier at three numbers of iterations.
    pub fn default_for(scene: &Scene) -> Self {
        let others = ITERATIONS.map(|iterations| {
            Solver::rapier(RapierSettings {
                iterations,
                ..RapierSettings::DEFAULT
            })
        });
        let mut solvers = crate::solvers::methods(&scene.solver.method);
        solvers.extend(integrators::pairs().iter().map(Solver::method));
        solvers.extend(solvers::find("rapier").into_iter().chain(others));
        Self {
            solvers,
            targets: TARGETS.to_vec(),
            settings: SETTINGS,
            budget_s: BUDGET_S,
            timesteps: None,
            truth: Demand::Auto,
        }
    }
}

/// The settings planned for every engine on one scene.
pub struct CostPlan<'a> {
    scene: &'a Scene,
    system: ParticleSystem,
    choice: CostChoice,
    sweeps: Vec<Sweep>,
}

impl<'a> CostPlan<'a> {
    pub fn new(scene: &'a Scene, choice: &CostChoice) -> Self {
        let system = ParticleSystem::new(scene);
        let sweeps = settings::plan(scene, &system, choice);
        Self {
            scene,
            system,
            choice: choice.clone(),
            sweeps,
        }
    }

    /// The planned work, nominal microseconds: the total that [`Session::progress`] counts towards.
    pub fn work(&self) -> u64 {
        self.sweeps.iter().map(Sweep::work).sum()
    }

    /// How long each engine will take, from its nominal work.
    pub fn estimate(&self) -> Vec<TimeEstimate> {
        let estimate = |sweep: &Sweep| TimeEstimate {
            label: Label {
                engine: sweep.solver.id.to_string(),
                timestep: sweep.settings.last().map_or(0.0, Setting::timestep),
                steps: sweep.settings.iter().map(Setting::steps).sum(),
                particles: self.scene.particles.len(),
            },
            seconds: 1e-6 * sweep.work() as f64,
        };
        self.sweeps.iter().map(estimate).collect()
    }

    /// Runs all settings, times them and ranks them. A run that diverges or fails is a point with its
    /// reason.
    pub fn execute(&self, session: &dyn Session) -> Report {
        let (scene, system) = (self.scene, &self.system);
        // The end of the longest run, s.
        let named = self.choice.timesteps.as_deref();
        let ends = named.unwrap_or_default().iter();
        let ends = ends.map(|h| scene.steps(*h) as f64 * h);
        let until = ends.fold(scene.duration, f64::max);
        let truth = truth::find(scene, system, self.choice.truth, until, session.store());
        let scale = facts::energy_scale(scene, system, &truth);
        let setup = Setup::new(scene, system, &truth, scale, session, named.is_some());
        let sweep = |sweep: &Sweep| setup.sweep(sweep, &self.choice.targets);
        let mut curves: Vec<Curve> = self.sweeps.par_iter().map(sweep).collect();
        for (sweep, curve) in self.sweeps.iter().zip(&mut curves) {
            setup.time(sweep, curve);
        }
        let counted = Curve::evaluations(&curves, &self.sweeps);
        let panels = named.map(|_| panels::panels(&setup, &self.sweeps, &curves));
        let cost = answer::answer(&setup, &self.choice, &self.sweeps, curves);
        Report {
            header: Header {
                scene: facts::scene(scene, system, counted, scale),
                truth: facts::truth(&truth),
                checks: facts::no_scale(scale).into_iter().collect(),
                advice: Vec::new(),
            },
            body: Body::Cost { outcomes: [], cost },
            series: panels.map_or(SeriesState::Nothing, |panels| {
                SeriesState::Loaded(Series::Panels(panels))
            }),
        }
    }
}
