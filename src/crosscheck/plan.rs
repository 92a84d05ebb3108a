//! What will run: each chosen engine at each timestep.

use crate::engines::{self, Engine, EngineRow, IntegratorEngine, Unsupported};
use crate::integrators::{self, Method, Settings};
use crate::outcome::Kind;
use crate::scene::Scene;
use crate::system::ParticleSystem;
use std::time::{Duration, Instant};

/// What the caller wants run; [`Choice::default_for`] is what a run without flags does.
#[derive(Debug, Clone)]
pub struct Choice {
    /// In the order outcomes are listed.
    pub methods: Vec<&'static Method>,
    pub engines: Vec<ChosenEngine>,
    /// Seconds; every method runs at each, and every engine without a timestep of its own.
    pub timesteps: Vec<f64>,
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
            timesteps: vec![scene.solver.timestep],
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
    /// A fresh engine at the scene's start.
    pub build: Box<dyn Fn() -> Result<Box<dyn Engine>, Unsupported> + Send + Sync + 'a>,
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

/// The cases of one scene, in the order of the report.
pub struct Plan<'a> {
    pub scene: &'a Scene,
    pub system: ParticleSystem,
    pub cases: Vec<Case<'a>>,
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
        Self {
            scene,
            system,
            cases,
        }
    }

    /// How long each case will take, from its first few steps.
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
    let settings = Settings {
        tolerance: scene
            .solver
            .tolerance
            .unwrap_or(Settings::default().tolerance),
    };
    Case {
        label: label(scene, method.id, timestep),
        kind: Kind::Integrator,
        substeps: 1,
        method: Some(method),
        dissipates: None,
        reference: false,
        build: Box::new(move || {
            let engine = IntegratorEngine::new(scene, system.clone(), method, &settings, timestep);
            Ok(Box::new(engine))
        }),
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
        build: Box::new(move || row.build(scene, system.clone(), timestep)),
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
    let mut engine = (case.build)().ok()?;
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
