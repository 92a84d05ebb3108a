//! What will run: each chosen engine at each timestep.

use crate::engines::external::Program;
use crate::engines::{self, Engine, EngineRow, IntegratorEngine, Unsupported};
use crate::integrators::{self, Integrator, Method, Settings};
use crate::outcome::Kind;
use crate::scene::Scene;
use crate::system::ParticleSystem;
use crate::truth::Demand;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// What the caller wants run; [`Choice::default_for`] is what a run without flags does.
#[derive(Debug, Clone)]
pub struct Choice {
    /// In the order outcomes are listed.
    pub methods: Vec<&'static Method>,
    pub engines: Vec<ChosenEngine>,
    /// Other people's programs, after all others.
    pub programs: Vec<ChosenProgram>,
    /// Seconds; every method and program runs at each, and every engine without a timestep of its own.
    pub timesteps: Vec<f64>,
    /// What errors are measured against.
    pub truth: Demand,
    /// Whether every method's order is measured.
    pub order: Orders,
    /// Whether replays say which scheme each outcome follows.
    pub identify: bool,
    /// Whether the twin proof is made.
    pub prove: bool,
}

/// When orders are measured, which costs about two more runs of each method.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Orders {
    Never,
    /// Where the scene's own run is short.
    #[default]
    WhereCheap,
    /// However long the run.
    Always,
}

/// A reference engine, or one more rapier row with settings of the user's own.
#[derive(Debug, Clone)]
pub struct ChosenEngine {
    pub row: EngineRow,
    /// Seconds, where it differs from everybody's.
    pub timestep: Option<f64>,
}

impl From<&EngineRow> for ChosenEngine {
    fn from(row: &EngineRow) -> Self {
        Self {
            row: row.clone(),
            timestep: None,
        }
    }
}

/// Another program, and what reports call it: a name no integrator and no engine has.
#[derive(Clone)]
pub struct ChosenProgram {
    pub name: String,
    pub program: Arc<dyn Program>,
}

impl std::fmt::Debug for ChosenProgram {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("ChosenProgram").field(&self.name).finish()
    }
}

/// Beside the scene's own integrator.
const DEFAULT_METHODS: &[&str] = &[
    "explicit_euler",
    "symplectic_euler",
    "midpoint",
    "velocity_verlet",
    "rk4",
    "implicit_euler",
];

impl Choice {
    /// The scene's own integrator, the usual ones, and the default engines, at the scene's timestep.
    pub fn default_for(scene: &Scene) -> Self {
        Self {
            methods: with_own_first(
                scene,
                DEFAULT_METHODS
                    .iter()
                    .filter_map(|id| integrators::find(id)),
            ),
            engines: engines::REGISTRY
                .iter()
                .filter(|row| row.default)
                .map(ChosenEngine::from)
                .collect(),
            programs: Vec::new(),
            timesteps: vec![scene.solver.timestep],
            truth: Demand::Auto,
            order: Orders::WhereCheap,
            identify: true,
            prove: true,
        }
    }

    /// Every method of the registry, the scene's own first.
    pub fn all_methods(scene: &Scene) -> Vec<&'static Method> {
        with_own_first(scene, integrators::REGISTRY.iter())
    }
}

fn with_own_first(
    scene: &Scene,
    methods: impl Iterator<Item = &'static Method>,
) -> Vec<&'static Method> {
    let own = integrators::find(&scene.solver.method);
    own.into_iter()
        .chain(methods.filter(|method| method.id != scene.solver.method))
        .collect()
}

/// One engine at one timestep.
pub struct Case<'a> {
    pub label: Label,
    pub kind: Kind,
    /// Scheme steps per timestep: rapier's iterations, else 1.
    pub substeps: u32,
    /// The row, for one of our integrators.
    pub method: Option<&'static Method>,
    /// Why it loses energy by design, if it does.
    pub dissipates: Option<String>,
    /// Others report their distance from it.
    pub reference: bool,
    pub source: Source<'a>,
}

/// Where a case's trajectory comes from.
pub enum Source<'a> {
    /// A fresh engine at the scene's start, advanced here step by step, as often as wanted.
    Engine(Build<'a>),
    /// Everything at once, from a program that runs once.
    Program(Arc<dyn Program>),
}

/// Makes an engine, or says why there can be none.
pub type Build<'a> = Box<dyn Fn() -> Result<Box<dyn Engine>, Unsupported> + Send + Sync + 'a>;

impl<'a> Source<'a> {
    /// What makes the engine, where there is one.
    pub fn engine(&self) -> Option<&Build<'a>> {
        match self {
            Self::Engine(build) => Some(build),
            Self::Program(_) => None,
        }
    }
}

/// Which run something belongs to.
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    pub engine: String,
    /// Seconds.
    pub timestep: f64,
    pub steps: u64,
    pub particles: usize,
}

impl Label {
    /// When the run ends, s.
    pub fn end(&self) -> f64 {
        self.steps as f64 * self.timestep
    }
}

/// The cases of one scene, in the order of the report.
pub struct Plan<'a> {
    pub scene: &'a Scene,
    pub system: ParticleSystem,
    pub cases: Vec<Case<'a>>,
    pub demand: Demand,
    /// As [`Choice::order`].
    pub order: Orders,
    /// As [`Choice::identify`].
    pub identify: bool,
    /// As [`Choice::prove`].
    pub prove: bool,
}

impl<'a> Plan<'a> {
    pub fn new(scene: &'a Scene, choice: &Choice) -> Self {
        let system = ParticleSystem::new(scene);
        let mut cases = Vec::new();
        for &method in &choice.methods {
            for &timestep in &choice.timesteps {
                cases.push(integrator_case(scene, &system, method, timestep));
            }
        }
        for chosen in &choice.engines {
            let own = chosen.timestep.as_ref().map(std::slice::from_ref);
            let timesteps = own.unwrap_or(&choice.timesteps);
            for &timestep in timesteps {
                cases.push(engine_case(scene, &system, &chosen.row, timestep));
            }
        }
        for chosen in &choice.programs {
            for &timestep in &choice.timesteps {
                cases.push(program_case(scene, chosen, timestep));
            }
        }
        Self {
            scene,
            system,
            cases,
            demand: choice.truth,
            order: choice.order,
            identify: choice.identify,
            prove: choice.prove,
        }
    }

    /// When the last run ends, s.
    pub fn until(&self) -> f64 {
        let ends = self.cases.iter().map(|case| case.label.end());
        ends.fold(0.0, f64::max)
    }

    /// One more row after the other integrators: one of the caller's own, under this name, at this
    /// timestep, s. `build` makes a fresh one for each run.
    ///
    /// Nothing is claimed of it here; `conformance::check` is for that.
    #[must_use]
    pub fn with_integrator(
        mut self,
        name: &str,
        timestep: f64,
        build: impl Fn() -> Box<dyn Integrator> + Send + Sync + 'a,
    ) -> Self {
        let (scene, system) = (self.scene, self.system.clone());
        let case = Case {
            label: label(scene, name, timestep),
            kind: Kind::Integrator,
            substeps: 1,
            method: None,
            dissipates: None,
            reference: false,
            source: Source::Engine(Box::new(move || {
                let engine = IntegratorEngine::with(scene, system.clone(), build(), timestep);
                Ok(Box::new(engine))
            })),
        };
        let integrators = self.cases.iter().rposition(|c| c.kind == Kind::Integrator);
        self.cases.insert(integrators.map_or(0, |at| at + 1), case);
        self
    }

    /// How long each case will take, from its first few steps. Nobody knows it of a program.
    pub fn estimate(&self) -> Vec<Estimate> {
        // One after the other: neighbours on the machine would make every case look slow.
        self.cases.iter().filter_map(estimate).collect()
    }
}

fn label(scene: &Scene, engine: &str, timestep: f64) -> Label {
    Label {
        engine: engine.to_owned(),
        timestep,
        steps: scene.steps(timestep),
        particles: scene.particles.len(),
    }
}

fn integrator_case<'a>(
    scene: &'a Scene,
    system: &ParticleSystem,
    method: &'static Method,
    timestep: f64,
) -> Case<'a> {
    let system = system.clone();
    let settings = Settings::stated(scene.solver.tolerance);
    Case {
        label: label(scene, method.id, timestep),
        kind: Kind::Integrator,
        substeps: 1,
        method: Some(method),
        dissipates: None,
        reference: false,
        source: Source::Engine(Box::new(move || {
            let engine = IntegratorEngine::new(scene, system.clone(), method, &settings, timestep);
            Ok(Box::new(engine))
        })),
    }
}

fn engine_case<'a>(
    scene: &'a Scene,
    system: &ParticleSystem,
    row: &EngineRow,
    timestep: f64,
) -> Case<'a> {
    let (row, system) = (row.clone(), system.clone());
    Case {
        label: label(scene, &row.id, timestep),
        kind: row.kind,
        substeps: row.substeps(),
        method: None,
        dissipates: row
            .dissipates
            .map(|why| why.replace("{n}", &row.substeps().to_string())),
        reference: row.reference,
        source: Source::Engine(Box::new(move || row.build(scene, system.clone(), timestep))),
    }
}

fn program_case<'a>(scene: &Scene, chosen: &ChosenProgram, timestep: f64) -> Case<'a> {
    Case {
        label: label(scene, &chosen.name, timestep),
        kind: Kind::External,
        substeps: 1,
        method: None,
        dissipates: None,
        reference: false,
        source: Source::Program(Arc::clone(&chosen.program)),
    }
}

/// Expected wall time of one case.
#[derive(Debug, Clone)]
pub struct Estimate {
    pub label: Label,
    pub seconds: f64,
}

/// Long enough to be above the clock's grain, short enough not to be felt, and taken as often.
const SAMPLE: Duration = Duration::from_millis(1);
const SAMPLES: usize = 2;

fn estimate(case: &Case) -> Option<Estimate> {
    let mut engine = case.source.engine()?().ok()?;
    // The first step allocates and orders matrices; it stands for no other.
    engine.step().ok()?;
    let mut sample = || {
        let start = Instant::now();
        let mut steps = 0;
        while steps < case.label.steps && start.elapsed() < SAMPLE {
            if engine.step().is_err() {
                break;
            }
            steps += 1;
        }
        start.elapsed().as_secs_f64() / f64::max(1.0, steps as f64)
    };
    // The least: what disturbs a sample only ever lengthens it.
    let each = (0..SAMPLES).map(|_| sample()).fold(f64::INFINITY, f64::min);
    Some(Estimate {
        label: case.label.clone(),
        seconds: each * case.label.steps as f64,
    })
}
