//! The catalogue: whatever can run a scene, with its facts, and how to make a fresh one.

use super::external::Program;
use super::integrator::{AdaptiveEngine, IntegratorEngine};
use super::rapier::{self, RapierEngine, RapierForces};
use super::run::Run;
use super::setting::Setting;
use super::{Engine, Unsupported};
use crate::integrators::{self, Integrator, Method, Settings};
use crate::physics::ParticleSystem;
use crate::scene::Scene;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::sync::Arc;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    Integrator,
    Rapier,
    External,
}

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
    dissipates: Option<&'static str>,
    source: Source,
}

/// Where a solver's trajectory comes from.
#[derive(Clone)]
enum Source {
    Method(&'static Method),
    Own(Arc<BuildIntegrator>),
    /// rapier's world in its own terms.
    Joints(rapier::Settings),
    /// rapier's bodies under forces computed here.
    Forces,
    Program(Arc<dyn Program>),
}

/// Makes a fresh integrator for each run.
pub type BuildIntegrator = dyn Fn() -> Box<dyn Integrator> + Send + Sync;

impl Solver {
    /// A method of the registry; a pair chooses its own steps.
    pub fn method(method: &'static Method) -> Self {
        Self {
            follows: method.pair().is_none().then_some(method),
            ..Self::integrator(method.id.into(), method.name, Source::Method(method))
        }
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
            ..joints(settings)
        }
    }

    fn integrator(id: Cow<'static, str>, summary: &'static str, source: Source) -> Self {
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

    /// Its row, for a method of fixed steps.
    pub fn as_method(&self) -> Option<&'static Method> {
        self.row().filter(|method| method.pair().is_none())
    }

    /// Its row, for an adaptive pair.
    pub fn as_pair(&self) -> Option<&'static Method> {
        self.row().filter(|method| method.pair().is_some())
    }

    fn row(&self) -> Option<&'static Method> {
        match self.source {
            Source::Method(method) => Some(method),
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
        let of = |row: &Method| if damped { row.order_damped } else { row.order };
        self.row().map(of)
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
                if let Some(pair) = method.pair() {
                    let tolerance = setting.tolerance().unwrap_or(f64::EPSILON);
                    let until = scene.duration;
                    Box::new(AdaptiveEngine::new(scene, system, pair, tolerance, until))
                } else {
                    let settings = Settings::stated(scene.solver.tolerance);
                    let engine = IntegratorEngine::new(scene, system, method, &settings, timestep);
                    Box::new(engine)
                }
            }
            Source::Own(build) => {
                let integrator = build();
                system.admits(&self.id, integrator.takes())?;
                Box::new(IntegratorEngine::with(scene, system, integrator, timestep))
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

/// rapier's worlds at fixed settings.
fn worlds() -> [Solver; 3] {
    let converged = Solver {
        id: rapier::IDS[2].into(),
        summary: "rapier's spring joints swept until they converge: linearly implicit Euler",
        follows: integrators::find("linearized_implicit_material"),
        ..joints(rapier::Settings::CONVERGED)
    };
    let forces = Solver {
        id: rapier::IDS[1].into(),
        summary: "rapier's bodies under this program's forces: symplectic Euler",
        follows: integrators::find("symplectic_euler"),
        substeps: rapier::Settings::FORCES.iterations,
        dissipates: None,
        source: Source::Forces,
        ..joints(rapier::Settings::FORCES)
    };
    [joints(rapier::Settings::DEFAULT), forces, converged]
}

/// rapier's spring joints under these settings; only at the defaults is it what people ship.
fn joints(settings: rapier::Settings) -> Solver {
    Solver {
        kind: Kind::Rapier,
        substeps: settings.iterations.max(1),
        reference: true,
        dissipates: Some(
            "rapier's spring joint is linearly implicit Euler at h = dt/{n}, which loses energy by \
             design: distance from it is no error of yours",
        ),
        ..Solver::integrator(
            rapier::IDS[0].into(),
            "rapier at its defaults: spring joints, 4 substeps, one sweep each",
            Source::Joints(settings),
        )
    }
}

/// Every solver that ships, in the order reports list them: methods, adaptive pairs, rapier's worlds.
pub fn catalogue() -> impl Iterator<Item = Solver> {
    let methods = integrators::REGISTRY.iter().map(Solver::method);
    methods.chain(worlds())
}

/// The solver of this id.
pub fn find(id: &str) -> Option<Solver> {
    catalogue().find(|solver| solver.id == id)
}

/// These methods after the integrator of the id `own`, which a scene names.
pub fn own_first(own: &str, methods: impl Iterator<Item = Solver>) -> Vec<Solver> {
    let first = integrators::fixed().iter().find(|method| method.id == own);
    (first.map(Solver::method).into_iter())
        .chain(methods.filter(|method| method.id != own))
        .collect()
}

/// Every method of fixed steps, the one with the id `own` first.
pub fn methods(own: &str) -> Vec<Solver> {
    own_first(own, integrators::fixed().iter().map(Solver::method))
}
