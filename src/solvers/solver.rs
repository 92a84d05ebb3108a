//! The catalogue: whatever can run a scene, with its facts, and how to make a fresh one.

use super::external::Program;
use super::integrator::{AdaptiveEngine, IntegratorEngine};
use super::rapier::{self, RapierEngine, RapierForces};
use super::run::Run;
use super::{Engine, Unsupported};
use crate::integrators::adaptive::{self, Pair};
use crate::integrators::{self, Integrator, Method, Settings};
use crate::outcome::Kind;
use crate::physics::ParticleSystem;
use crate::scene::Scene;
use std::borrow::Cow;
use std::sync::Arc;

/// Something that can run a scene: an integrator, an adaptive pair, a rapier world, another program.
#[derive(Clone)]
pub struct Solver {
    /// What reports and the command line call it.
    pub id: Cow<'static, str>,
    pub kind: Kind,
    /// A line for lists.
    pub summary: &'static str,
    /// The method whose step each of its substeps is; None where it is none, or nobody knows.
    pub follows: Option<&'static Method>,
    /// Steps of that method, or solves, inside one timestep: rapier's iterations, else 1.
    pub substeps: u32,
    /// Others report their distance from it.
    pub reference: bool,
    /// The timestep it takes whatever others take, s.
    pub timestep: Option<f64>,
    /// Why it loses energy by design, `{n}` standing for its substeps.
    pub(super) dissipates: Option<&'static str>,
    pub(super) source: Source,
}

/// Where a solver's trajectory comes from.
#[derive(Clone)]
pub(super) enum Source {
    Method(&'static Method),
    Own(Arc<BuildIntegrator>),
    Pair(&'static Pair),
    /// rapier's world in its own terms.
    Joints(rapier::Settings),
    /// rapier's bodies under forces computed here.
    Forces,
    Program(Arc<dyn Program>),
}

/// Makes a fresh integrator for each run.
pub type BuildIntegrator = dyn Fn() -> Box<dyn Integrator> + Send + Sync;

/// What a solver runs at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Setting {
    /// A number of equal steps of this size, s.
    Steps { timestep: f64, steps: u64 },
    /// The tolerance of an adaptive pair, relative to the scene's size.
    Tolerance {
        tolerance: f64,
        /// When the run ends, s.
        duration: f64,
        /// About how many steps it takes.
        steps: u64,
        /// It is stopped after so many, accepted or not.
        most: u64,
    },
}

impl Setting {
    /// A fixed step, s, for as long as the caller goes on.
    pub fn step(timestep: f64) -> Self {
        Self::Steps {
            timestep,
            steps: u64::MAX,
        }
    }

    /// `steps` equal steps over a duration, s.
    pub fn divided(duration: f64, steps: u64) -> Self {
        Self::Steps {
            timestep: duration / steps as f64,
            steps,
        }
    }

    /// The step, s; of a pair about the mean one.
    pub fn timestep(&self) -> f64 {
        match self {
            Self::Steps { timestep, .. } => *timestep,
            Self::Tolerance {
                duration, steps, ..
            } => duration / *steps as f64,
        }
    }

    /// Steps to the end; of a pair about so many.
    pub fn steps(&self) -> u64 {
        match self {
            Self::Steps { steps, .. } | Self::Tolerance { steps, .. } => *steps,
        }
    }

    /// Of a pair; None for a fixed step.
    pub fn tolerance(&self) -> Option<f64> {
        match self {
            Self::Steps { .. } => None,
            Self::Tolerance { tolerance, .. } => Some(*tolerance),
        }
    }

    /// Whether it is as coarse as another setting of the same solver, or coarser.
    pub fn is_no_finer(&self, other: &Self) -> bool {
        match (self.tolerance(), other.tolerance()) {
            (Some(own), Some(other)) => own >= other,
            _ => self.steps() <= other.steps(),
        }
    }
}

impl Solver {
    /// A fixed-step method of the registry.
    pub fn method(method: &'static Method) -> Self {
        Self {
            follows: Some(method),
            ..Self::integrator(method.id.into(), method.name, Source::Method(method))
        }
    }

    /// An adaptive pair: it chooses its own steps.
    pub fn pair(pair: &'static Pair) -> Self {
        Self::integrator(pair.id.into(), pair.name, Source::Pair(pair))
    }

    /// An integrator of the caller's own, under a name no other solver has. Nothing is claimed of it:
    /// [`conformance::check`](crate::conformance::check) is for that.
    pub fn own(
        name: &str,
        build: impl Fn() -> Box<dyn Integrator> + Send + Sync + 'static,
    ) -> Self {
        let source = Source::Own(Arc::new(build));
        Self::integrator(name.to_owned().into(), "an integrator of your own", source)
    }

    /// Another program, under a name no other solver has. It gives whole trajectories.
    pub fn program(name: &str, program: Arc<dyn Program>) -> Self {
        Self {
            kind: Kind::External,
            ..Self::integrator(
                name.to_owned().into(),
                "another program",
                Source::Program(program),
            )
        }
    }

    /// rapier's spring joints with settings of the caller's own, named after those that are not rapier's
    /// defaults.
    pub fn rapier(settings: rapier::Settings) -> Self {
        Self {
            id: format!("rapier({})", settings.changes()).into(),
            summary: "rapier with settings of your own",
            ..rapier::joints(settings)
        }
    }

    pub(super) fn integrator(id: Cow<'static, str>, summary: &'static str, source: Source) -> Self {
        Self {
            id,
            kind: Kind::Integrator,
            summary,
            follows: None,
            substeps: 1,
            reference: false,
            timestep: None,
            dissipates: None,
            source,
        }
    }

    /// Its row, for a method of the registry.
    pub fn as_method(&self) -> Option<&'static Method> {
        match self.source {
            Source::Method(method) => Some(method),
            _ => None,
        }
    }

    /// Its row, for an adaptive pair.
    pub fn as_pair(&self) -> Option<&'static Pair> {
        match self.source {
            Source::Pair(pair) => Some(pair),
            _ => None,
        }
    }

    /// What gives its trajectory, for another program.
    pub fn as_program(&self) -> Option<&dyn Program> {
        match &self.source {
            Source::Program(program) => Some(program.as_ref()),
            _ => None,
        }
    }

    /// The order its row states for a scene with or without damping; None where nothing is stated.
    pub fn order(&self, damped: bool) -> Option<u32> {
        match self.source {
            Source::Method(method) if damped => Some(method.order_damped),
            Source::Method(method) => Some(method.order),
            Source::Pair(pair) => Some(pair.order),
            _ => None,
        }
    }

    /// Why a run loses energy by this solver's design; None where it should not.
    pub fn dissipates(&self) -> Option<String> {
        let why = self.dissipates?;
        Some(why.replace("{n}", &self.substeps.to_string()))
    }

    /// A fresh run at the scene's start.
    ///
    /// # Errors
    /// [`Unsupported`] where the solver has no honest counterpart of something in the scene, and for
    /// another program, which takes no single steps.
    pub fn start(
        &self,
        scene: &Scene,
        system: &ParticleSystem,
        setting: &Setting,
    ) -> Result<Run, Unsupported> {
        Ok(Run::new(self.engine(scene, system, setting)?, *setting))
    }

    /// What a [`Run`] takes the steps of, bare: to hold an engine itself against a law.
    ///
    /// # Errors
    /// As [`start`](Self::start).
    pub fn engine(
        &self,
        scene: &Scene,
        system: &ParticleSystem,
        setting: &Setting,
    ) -> Result<Box<dyn Engine>, Unsupported> {
        let (system, timestep) = (system.clone(), setting.timestep());
        Ok(match &self.source {
            Source::Method(method) => {
                system.admits(&self.id, method.takes())?;
                let settings = Settings::stated(scene.solver.tolerance);
                let engine = IntegratorEngine::new(scene, system, method, &settings, timestep);
                Box::new(engine)
            }
            Source::Own(build) => {
                let integrator = build();
                system.admits(&self.id, integrator.takes())?;
                Box::new(IntegratorEngine::with(scene, system, integrator, timestep))
            }
            Source::Pair(pair) => {
                let tolerance = setting.tolerance().unwrap_or(f64::EPSILON);
                let engine = AdaptiveEngine::new(scene, system, pair, tolerance, scene.duration);
                Box::new(engine)
            }
            Source::Joints(settings) => {
                Box::new(RapierEngine::new(scene, system, timestep, settings)?)
            }
            Source::Forces => Box::new(RapierForces::new(scene, system, timestep)?),
            Source::Program(_) => {
                return Err(Unsupported {
                    reason: "another program takes no single steps".to_owned(),
                });
            }
        })
    }
}

impl std::fmt::Debug for Solver {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("Solver").field(&self.id).finish()
    }
}

/// Every solver that ships, in the order reports list them: methods, adaptive pairs, rapier's worlds.
pub fn catalogue() -> impl Iterator<Item = Solver> {
    let methods = integrators::REGISTRY.iter().map(Solver::method);
    let pairs = adaptive::REGISTRY.iter().map(Solver::pair);
    methods.chain(pairs).chain(rapier::solvers())
}

/// The solver of this id.
pub fn find(id: &str) -> Option<Solver> {
    catalogue().find(|solver| solver.id == id)
}
