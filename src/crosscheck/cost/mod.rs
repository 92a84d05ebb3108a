//! What accuracy costs: every chosen engine over a range of settings, its error against the truth, and
//! what it took, counted and timed.
//!
//! Errors are found in parallel; then, with nothing else running, what completed is timed one after the
//! other. Only wall times, and what is chosen by them, differ between two runs.

mod answer;
mod clock;
mod entrant;
mod explain;
mod ladder;
mod lane;
mod panels;
mod price;
mod refine;
mod runner;
mod setting;
mod sweep;
mod witness;

use super::{Choice, ChosenEngine, Estimate, Host, Label, ledger, truths};
use crate::engines::rapier::Settings;
use crate::engines::{self, Limits};
use crate::integrators::adaptive::{self, Pair};
use crate::integrators::{Integrator, Method};
use crate::measure;
use crate::outcome::{Figures, Report, SCHEMA_VERSION};
use crate::scene::Scene;
use crate::system::ParticleSystem;
use crate::truth::{self, Demand};
use lane::Lane;
use rayon::prelude::*;
use setting::Setting;
use std::sync::Arc;
use sweep::{Ground, Swept};
use witness::Witness;

/// What is asked.
#[derive(Debug, Clone)]
pub struct CostChoice {
    /// In the order of the curves.
    pub methods: Vec<&'static Method>,
    /// Integrators of the caller's own, after the methods.
    pub own: Vec<OwnIntegrator>,
    /// Adaptive pairs, swept over their tolerance.
    pub pairs: Vec<&'static Pair>,
    /// After all integrators. A timestep of their own is not looked at: the step is what is swept.
    pub engines: Vec<ChosenEngine>,
    /// Errors somebody wants to reach, m.
    pub targets: Vec<f64>,
    /// Settings of each engine, at least 2; a few more where a target lies between two of them.
    pub settings: usize,
    /// What the whole may take, in seconds of a nominal machine: work is counted, so that every machine
    /// tries the same settings.
    pub budget_s: f64,
    /// Exactly these steps, s, instead of a range; adaptive pairs, which choose theirs, are left out.
    pub timesteps: Option<Vec<f64>>,
    /// What errors are measured against.
    pub truth: Demand,
}

/// An integrator of the caller's own, and what reports call it. Nothing is claimed of it here;
/// `conformance::check` is for that.
#[derive(Clone)]
pub struct OwnIntegrator {
    pub name: String,
    /// A fresh one for each run.
    pub build: Arc<dyn Fn() -> Box<dyn Integrator> + Send + Sync>,
}

impl std::fmt::Debug for OwnIntegrator {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("OwnIntegrator").field(&self.name).finish()
    }
}

/// Errors to reach when none are named, m.
pub const TARGETS: [f64; 3] = [1e-3, 1e-6, 1e-9];
/// Settings of each engine when their number is not given.
pub const SETTINGS: usize = 12;
/// The budget when none is given, s.
pub const BUDGET_S: f64 = 30.0;
/// rapier's iterations that are swept beside its default.
const ITERATIONS: [u32; 2] = [1, 16];

impl CostChoice {
    /// Every method and pair, and rapier at three numbers of iterations.
    pub fn default_for(scene: &Scene) -> Self {
        let rapier = engines::find("rapier").map(ChosenEngine::from);
        let others = ITERATIONS.map(|iterations| {
            let settings = Settings {
                iterations,
                ..Settings::DEFAULT
            };
            ChosenEngine::from(&engines::rapier_with(settings))
        });
        Self {
            methods: Choice::all_methods(scene),
            own: Vec::new(),
            pairs: adaptive::REGISTRY.iter().collect(),
            engines: rapier.into_iter().chain(others).collect(),
            targets: TARGETS.to_vec(),
            settings: SETTINGS,
            budget_s: BUDGET_S,
            timesteps: None,
            truth: Demand::Auto,
        }
    }
}

/// The settings of every engine on one scene.
pub struct CostPlan<'a> {
    scene: &'a Scene,
    system: ParticleSystem,
    choice: CostChoice,
    lanes: Vec<Lane>,
}

impl<'a> CostPlan<'a> {
    pub fn new(scene: &'a Scene, choice: &CostChoice) -> Self {
        let system = ParticleSystem::new(scene);
        let lanes = lane::lanes(scene, &system, choice);
        Self {
            scene,
            system,
            choice: choice.clone(),
            lanes,
        }
    }

    /// What a progress bar counts against and [`Host::progress`] is told: nominal microseconds.
    pub fn work(&self) -> u64 {
        self.lanes.iter().map(Lane::work).sum()
    }

    /// How long each engine will take, from its nominal work.
    pub fn estimate(&self) -> Vec<Estimate> {
        let estimate = |lane: &Lane| Estimate {
            label: Label {
                engine: lane.entrant.id.clone(),
                timestep: lane.ladder.last().map_or(0.0, Setting::timestep),
                steps: lane.ladder.iter().map(Setting::steps).sum(),
                particles: self.scene.particles.len(),
            },
            seconds: 1e-6 * lane.work() as f64,
        };
        self.lanes.iter().map(estimate).collect()
    }

    /// Sweeps, times and judges. Whatever an engine does is a point with its reason.
    pub fn execute(&self, host: &dyn Host) -> Report {
        let (scene, system) = (self.scene, &self.system);
        let truth = truth::find(scene, system, self.choice.truth, self.until(), host.store());
        let scale = measure::energy_scale(scene, system, truths::peak(system, &truth));
        // When a run stops must not depend on whether a truth was asked for.
        let before = measure::energy_scale(scene, system, None);
        let limit = measure::divergence_limit(scene, before);
        let limits = Limits::new(system.clone(), limit).now_and_then();
        let witness = Witness::new(scene, system, &truth, scale);
        let named = self.choice.timesteps.is_some();
        let ground = Ground {
            scene,
            system,
            witness: &witness,
            limits: &limits,
            host,
            panels: named,
        };
        let sweep = |lane: &Lane| {
            let mut swept = ground.sweep(lane, !named);
            if !named {
                refine::toward(&ground, lane, &mut swept, &self.choice.targets);
            }
            swept
        };
        let mut swept: Vec<Swept> = self.lanes.par_iter().map(sweep).collect();
        for (lane, swept) in self.lanes.iter().zip(&mut swept) {
            clock::time(&ground, lane, swept);
        }
        let counted = Swept::evaluations(&swept, &self.lanes);
        let panels = named.then(|| panels::panels(scene, &witness, &self.lanes, &swept));
        let facts = ledger::facts(scene, ledger::effects(scene, system, counted), scale);
        let cost = answer::answer(scene, &witness, &self.choice, &self.lanes, swept, panels);
        Report {
            schema_version: SCHEMA_VERSION,
            scene: facts,
            truth: truths::facts(&truth),
            outcomes: Vec::new(),
            checks: ledger::no_scale(scale).into_iter().collect(),
            fault: None,
            stability: None,
            cost: Some(cost),
            figures: Figures::default(),
        }
    }

    /// When the last run ends, s.
    fn until(&self) -> f64 {
        let asked = self.choice.timesteps.iter().flatten();
        let ends = asked.map(|h| self.scene.steps(*h) as f64 * h);
        ends.fold(self.scene.duration, f64::max)
    }
}
