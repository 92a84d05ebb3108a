//! What will run: each chosen solver at each timestep.

use crate::integrators;
use crate::physics::ParticleSystem;
use crate::scene::Scene;
use crate::solvers::{self, Kind, Run, Setting, Solver, Unsupported};
use crate::truth::Demand;
use crate::verbs::session::{Estimate, Label};
use std::time::{Duration, Instant};

/// What the caller wants run; [`Choice::default_for`] is what a run without flags does.
#[derive(Debug, Clone)]
pub struct Choice {
    /// In the order outcomes are listed. Not adaptive pairs, which take steps of their own.
    pub solvers: Vec<Solver>,
    /// Seconds; every solver without a timestep of its own runs at each.
    pub timesteps: Vec<f64>,
    /// What errors are measured against.
    pub truth: Demand,
    /// Whether every method's order is measured.
    pub order: Orders,
    /// Whether replays say which scheme each outcome follows.
    pub identify: bool,
    /// Whether the twin proof is made.
    pub prove: bool,
    /// What becomes of the scene's `expect`.
    pub expectations: Expectations,
}

/// What becomes of what a scene expects of its engines.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum Expectations {
    /// They are not asked for: no check.
    #[default]
    Ignored,
    /// A check for each, as [`expect::check`](super::expect::check) makes them.
    Judged,
    /// One check that is skipped, and why: the caller changed what they are about.
    Skipped(String),
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

/// Beside the scene's own integrator.
const DEFAULT_METHODS: &[&str] = &[
    "explicit_euler",
    "symplectic_euler",
    "midpoint",
    "velocity_verlet",
    "rk4",
    "implicit_euler",
];

/// Reference engines beside the integrators.
const DEFAULT_ENGINES: &[&str] = &["rapier", "rapier-forces"];

impl Choice {
    /// The scene's own integrator, the usual ones, and the default engines, at the scene's timestep.
    pub fn default_for(scene: &Scene) -> Self {
        let usual = DEFAULT_METHODS
            .iter()
            .filter_map(|id| integrators::find(id));
        let mut solvers = solvers::own_first(&scene.solver.method, usual.map(Solver::method));
        solvers.extend(DEFAULT_ENGINES.iter().filter_map(|id| solvers::find(id)));
        Self {
            solvers,
            timesteps: vec![scene.solver.timestep],
            truth: Demand::Auto,
            order: Orders::WhereCheap,
            identify: true,
            prove: true,
            expectations: Expectations::Ignored,
        }
    }

    /// One more solver, after the others of its kind, such as an integrator of the caller's own.
    #[must_use]
    pub fn with(mut self, solver: Solver) -> Self {
        let last = self.solvers.iter().rposition(|s| s.kind == solver.kind);
        let none = if solver.kind == Kind::Integrator {
            0
        } else {
            self.solvers.len()
        };
        self.solvers.insert(last.map_or(none, |at| at + 1), solver);
        self
    }
}

/// One solver at one timestep.
#[derive(Debug, Clone)]
pub struct Case {
    pub solver: Solver,
    pub label: Label,
}

impl Case {
    /// A fresh run from the plan's start.
    ///
    /// # Errors
    /// [`Unsupported`] as [`Solver::start`] has it.
    pub fn start(&self, plan: &Plan) -> Result<Run, Unsupported> {
        let Label {
            timestep, steps, ..
        } = self.label;
        let setting = Setting::Steps { timestep, steps };
        self.solver.start(plan.scene, &plan.system, &setting)
    }
}

/// The cases of one scene, in the order of the report.
pub struct Plan<'a> {
    pub scene: &'a Scene,
    pub system: ParticleSystem,
    pub cases: Vec<Case>,
    /// What it is made from.
    pub choice: Choice,
}

impl<'a> Plan<'a> {
    pub fn new(scene: &'a Scene, choice: &Choice) -> Self {
        let mut cases = Vec::new();
        for solver in &choice.solvers {
            let own = solver.timestep.as_ref().map(std::slice::from_ref);
            for &timestep in own.unwrap_or(&choice.timesteps) {
                cases.push(Case {
                    solver: solver.clone(),
                    label: Label {
                        engine: solver.id.to_string(),
                        timestep,
                        steps: scene.steps(timestep),
                        particles: scene.particles.len(),
                    },
                });
            }
        }
        Self {
            scene,
            system: ParticleSystem::new(scene),
            cases,
            choice: choice.clone(),
        }
    }

    /// How long each case will take, from its first few steps. Nobody knows it of a program.
    pub fn estimate(&self) -> Vec<Estimate> {
        // One after the other: neighbours on the machine would make every case look slow.
        let estimate = |case| estimate(self, case);
        self.cases.iter().filter_map(estimate).collect()
    }
}

/// A sample is longer than the clock's grain and too short to be noticed.
const SAMPLE: Duration = Duration::from_millis(1);
const SAMPLES: usize = 2;

fn estimate(plan: &Plan, case: &Case) -> Option<Estimate> {
    let mut run = case.start(plan).ok()?;
    // The first step allocates and orders matrices; it stands for no other.
    run.advance(1).ok()?;
    let mut sample = || {
        let start = Instant::now();
        let mut steps = 0;
        while steps < case.label.steps && start.elapsed() < SAMPLE {
            if run.advance(1).is_err() {
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
