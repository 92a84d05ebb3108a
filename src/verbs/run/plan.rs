//! The plan of a run: each chosen solver at each timestep.

use crate::integrators;
use crate::physics::ParticleSystem;
use crate::scene::Scene;
use crate::solvers::{self, Run, Setting, Solver, SolverKind, Unsupported};
use crate::truth::Demand;
use crate::verbs::session::{Label, TimeEstimate};
use std::time::{Duration, Instant};

/// The caller's choice of solvers and measures. [`Choice::default_for`] is that of a run without flags.
#[derive(Debug, Clone)]
pub struct Choice {
    /// The solvers, in the order outcomes are listed. Adaptive pairs, which choose their steps, are not among them.
    pub solvers: Vec<Solver>,
    /// Timesteps, s; every solver without a timestep of its own runs at each.
    pub timesteps: Vec<f64>,
    /// The kind of truth that errors are measured against.
    pub truth: Demand,
    /// Whether every method's order is measured.
    pub order: Orders,
    /// Whether replays say which scheme each outcome follows.
    pub identify: bool,
    /// Whether the twin proof is made.
    pub prove: bool,
    /// Whether the scene's `expect` is judged.
    pub expectations: Expectations,
}

/// Whether a scene's expectations of its engines are judged.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum Expectations {
    /// Not judged, and no check says so.
    #[default]
    Ignored,
    /// Judged: a check for each, as [`expect::check`](super::expect::check) makes it.
    Judged,
    /// Not judged, because the caller changed the run they are stated for: one skipped check gives this reason.
    Skipped(String),
}

/// When orders are measured. Measuring costs about two more runs of each method.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Orders {
    Never,
    /// Where the scene's own run is short.
    #[default]
    WhereCheap,
    /// However long the run.
    Always,
}

/// The reference engines that run by default.
const DEFAULT_ENGINES: &[&str] = &["rapier", "rapier-forces"];

impl Choice {
    /// The scene's own integrator, the default ones, and the default engines, at the scene's timestep.
    pub fn default_for(scene: &Scene) -> Self {
        let usual = integrators::USUAL
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

    /// Adds a solver after the others of its kind, such as an integrator of the caller's own.
    #[must_use]
    pub fn with(mut self, solver: Solver) -> Self {
        let last = self.solvers.iter().rposition(|s| s.kind == solver.kind);
        let none = if solver.kind == SolverKind::Integrator {
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
    /// Returns [`Unsupported`] where [`Solver::start`] does.
    pub fn start(&self, plan: &Plan) -> Result<Run, Unsupported> {
        let Label {
            timestep, steps, ..
        } = self.label;
        let setting = Setting::Steps { timestep, steps };
        self.solver.start(plan.scene, &plan.system, &setting)
    }
}

/// What is done beside the runs, each in their units.
#[derive(Debug, Clone, Copy, Default)]
pub struct Beside {
    pub truth: u64,
    pub proofs: u64,
    pub orders: u64,
    /// Replays and predicted limits.
    pub judging: u64,
    pub saving: u64,
}

impl Beside {
    /// Each with the name that an announcement gives it.
    pub fn named(self) -> [(&'static str, u64); 5] {
        [
            ("the truth", self.truth),
            ("the twin proof", self.proofs),
            ("orders", self.orders),
            ("replays and limits", self.judging),
            ("saving", self.saving),
        ]
    }
}

/// The cases of one scene, in the order of the report.
pub struct Plan<'a> {
    pub scene: &'a Scene,
    pub system: ParticleSystem,
    pub cases: Vec<Case>,
    /// The choice the plan is made from.
    pub choice: Choice,
    /// Whether outcomes state tensions and reactions.
    pub loads: bool,
    /// Whether the motion is kept for a page that plays it.
    pub played: bool,
    /// What is done beside the runs, for the progress; nothing until [`Plan::expecting`] says it.
    pub beside: Beside,
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
            loads: false,
            played: false,
            beside: Beside::default(),
        }
    }

    /// All that is counted by [`Session::progress`](crate::verbs::session::Session::progress), in steps of one
    /// particle under explicit forces.
    pub fn units(&self) -> u64 {
        let beside = self.beside.named().map(|(_, effort)| effort);
        beside.into_iter().fold(self.effort(), u64::saturating_add)
    }

    /// Estimates the wall time of each case from its first few steps, and of what is done beside the runs. External
    /// programs have no estimate.
    pub fn estimate(&self) -> Vec<TimeEstimate> {
        // One after the other: cases that run at the same time would slow each other down.
        let estimate = |case| Some((case, estimate(self, case)?));
        let runs: Vec<(&Case, Timed)> = self.cases.iter().filter_map(estimate).collect();
        // The method that does least beside its evaluations shows best how long one takes.
        let evaluations = runs.iter().filter_map(|(_, timed)| timed.evaluation);
        let unit = evaluations.reduce(f64::min).unwrap_or(NOMINAL);
        let integrators = runs
            .iter()
            .filter(|(case, _)| case.solver.kind == SolverKind::Integrator);
        let integrators: f64 = integrators.map(|(_, timed)| timed.estimate.seconds).sum();
        let run = integrators / self.effort_of_integrators().max(1) as f64;
        let units = [unit, unit, run, unit, unit];
        let beside = self.beside.named().into_iter().zip(units);
        let beside = beside.filter(|((_, effort), _)| *effort > 0);
        let beside = beside.map(|((what, effort), unit)| TimeEstimate {
            label: Label {
                engine: what.to_owned(),
                timestep: self.scene.solver.timestep,
                steps: 0,
                particles: self.scene.particles.len(),
            },
            seconds: unit * effort as f64,
        });
        let runs = runs.into_iter().map(|(_, timed)| timed.estimate);
        runs.chain(beside).collect()
    }
}

/// The duration of one timing sample: longer than the clock's resolution and too short to be noticed.
const SAMPLE: Duration = Duration::from_millis(1);
const SAMPLES: usize = 2;

/// The largest step, in steps of one particle under explicit forces, that is taken to see how long it takes: about
/// a second. A tenth of that is timed once.
const TRIED: u64 = 30_000_000;
/// Seconds of such a step of one particle, about, where none is taken.
const NOMINAL: f64 = 30e-9;

/// A case, and what its sample shows.
struct Timed {
    estimate: TimeEstimate,
    /// Seconds of a step for each evaluation in it, and each particle; None where nobody counts them.
    evaluation: Option<f64>,
}

fn estimate(plan: &Plan, case: &Case) -> Option<Timed> {
    let step = case.step(plan.scene);
    let of_all = |each: f64| TimeEstimate {
        label: case.label.clone(),
        seconds: each * case.label.steps as f64,
    };
    if step > TRIED {
        return Some(Timed {
            estimate: of_all(NOMINAL * step as f64),
            evaluation: None,
        });
    }
    let mut run = case.start(plan).ok()?;
    // The first step also allocates and orders matrices, so it is not timed.
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
        // Without a step that is no time at all.
        start.elapsed().as_secs_f64() / steps as f64
    };
    // The least, since a disturbance can only lengthen a sample.
    let samples = if 10 * step > TRIED { 1 } else { SAMPLES };
    let each = (0..samples).map(|_| sample()).fold(f64::INFINITY, f64::min);
    if !each.is_finite() {
        return None;
    }
    let evaluations = run.counts().force_evaluations.filter(|count| *count > 0);
    let particles = plan.scene.particles.len() as f64;
    let evaluation =
        evaluations.map(|count| each * run.taken() as f64 / (count as f64 * particles));
    Some(Timed {
        estimate: of_all(each),
        evaluation,
    })
}
