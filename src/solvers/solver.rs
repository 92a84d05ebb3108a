//! The catalogue of solvers: everything that can run a scene, with its facts and a way to start a fresh run.

use super::external::Program;
use super::integrator::{AdaptiveEngine, IntegratorEngine};
use super::rapier::{self, RapierEngine, RapierForces};
use super::run::Run;
use super::setting::Setting;
use super::{Engine, Unsupported, memory};
use crate::integrators::{self, Coefficients, Integrator, Method, Settings};
use crate::physics::constraints::contact::Obstacles;
use crate::physics::{ParticleSystem, System};
use crate::scene::Scene;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::sync::Arc;

/// The kind of a solver, as reports state it. An adaptive pair is an integrator.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SolverKind {
    Integrator,
    Rapier,
    External,
}

/// Something that can run a scene: an integrator, an adaptive pair, a rapier world, another program.
#[derive(Clone)]
pub struct Solver {
    /// The id that reports and the command line use.
    pub id: Cow<'static, str>,
    pub kind: SolverKind,
    /// One line for lists.
    pub summary: &'static str,
    /// The method that each of its substeps follows; None where it follows none, or where that is unknown.
    pub follows: Option<&'static Method>,
    /// The number of steps of that method, or of solves, in one timestep: rapier's iterations, else 1.
    pub substeps: u32,
    /// Whether other solvers report their distance from it.
    pub reference: bool,
    /// Its own timestep, s; None where it takes the common one.
    pub timestep: Option<f64>,
    /// The reason why it loses energy by design; `{n}` stands for its substeps.
    dissipates: Option<&'static str>,
    /// The reason why it gains energy by design, likewise.
    gains: Option<&'static str>,
    source: Source,
}

/// The source of a solver's trajectory.
#[derive(Clone)]
enum Source {
    Method(&'static Method),
    Own(Arc<BuildIntegrator>),
    /// A rapier world with rapier's own joints and gravity.
    Joints(rapier::RapierSettings),
    /// rapier's bodies under forces computed here.
    Forces(rapier::RapierSettings),
    /// rapier's contact, written here.
    Contact(rapier::RapierSettings),
    Program(Arc<dyn Program>),
}

/// Makes a fresh integrator for each run.
pub type BuildIntegrator = dyn Fn() -> Box<dyn Integrator> + Send + Sync;

impl Solver {
    /// A solver for a method of the registry; a pair chooses its own steps.
    pub fn method(method: &'static Method) -> Self {
        Self {
            follows: method.pair().is_none().then_some(method),
            ..Self::integrator(method.id.into(), method.name, Source::Method(method))
        }
    }

    /// A solver for an integrator of the caller's own, under a name that no other solver has. It makes no
    /// claims; [`conformance::check`](crate::conformance::check) tests those.
    pub fn own(
        name: &str,
        build: impl Fn() -> Box<dyn Integrator> + Send + Sync + 'static,
    ) -> Self {
        let source = Source::Own(Arc::new(build));
        Self::integrator(name.to_owned().into(), "an integrator of your own", source)
    }

    /// A solver for another program, under a name that no other solver has. It gives whole trajectories.
    pub fn program(name: &str, program: Arc<dyn Program>) -> Self {
        Self {
            kind: SolverKind::External,
            ..Self::integrator(
                name.to_owned().into(),
                "another program",
                Source::Program(program),
            )
        }
    }

    /// rapier's spring joints with the caller's settings. Its id lists those that differ from the defaults.
    pub fn rapier(settings: rapier::RapierSettings) -> Self {
        Self {
            id: format!("rapier({})", settings.changes()).into(),
            summary: "rapier with settings of your own",
            ..joints(settings)
        }
    }

    fn integrator(id: Cow<'static, str>, summary: &'static str, source: Source) -> Self {
        Self {
            id,
            kind: SolverKind::Integrator,
            summary,
            follows: None,
            substeps: 1,
            reference: false,
            timestep: None,
            dissipates: None,
            gains: None,
            source,
        }
    }

    /// The method, if the solver is one of fixed steps.
    pub fn as_method(&self) -> Option<&'static Method> {
        self.row().filter(|method| method.pair().is_none())
    }

    /// The method, if the solver is an adaptive pair.
    pub fn as_pair(&self) -> Option<&'static Method> {
        self.row().filter(|method| method.pair().is_some())
    }

    fn row(&self) -> Option<&'static Method> {
        match self.source {
            Source::Method(method) => Some(method),
            _ => None,
        }
    }

    /// The scheme that its rows follow in this scene, by its id and number of substeps, as identity by replay
    /// names it; None where that is not known beforehand. rapier's joints follow theirs as far as their sweeps
    /// have converged.
    pub fn law(&self, scene: &Scene) -> Option<(&'static str, u32)> {
        match &self.source {
            Source::Method(method) if method.pair().is_none() => Some((method.id, 1)),
            // Its contact has a law of its own.
            Source::Forces(_) | Source::Joints(_) if scene.collides() => None,
            Source::Method(_) | Source::Own(_) | Source::Contact(_) | Source::Program(_) => None,
            // Forces are set once a step and held over its substeps.
            Source::Forces(_) if self.substeps > 1 => {
                Some(("forces_held(symplectic_euler)", self.substeps))
            }
            Source::Forces(_) => Some(("symplectic_euler", 1)),
            // Its rods are stiff joints, whose law is no row of ours.
            Source::Joints(_) if !scene.rods.is_empty() => None,
            Source::Joints(_) => {
                let solves =
                    !scene.springs.is_empty() || scene.particles.iter().any(|p| p.drag > 0.0);
                let id = if solves {
                    "linearized_implicit_material"
                } else {
                    "symplectic_euler"
                };
                Some((id, self.substeps))
            }
        }
    }

    /// The program, if the solver is another program.
    pub fn as_program(&self) -> Option<&dyn Program> {
        match &self.source {
            Source::Program(program) => Some(program.as_ref()),
            _ => None,
        }
    }

    /// The order of its method on a system; None where it has no method.
    pub fn order(&self, system: &ParticleSystem) -> Option<u32> {
        self.row().map(|row| row.order_on(system))
    }

    /// The reason why the solver loses energy by design, or gains it; None where it should not.
    pub fn by_design(&self, gains: bool) -> Option<String> {
        let why = if gains { self.gains } else { self.dissipates }?;
        Some(why.replace("{n}", &self.substeps.to_string()))
    }

    /// A fresh run at the scene's start.
    ///
    /// # Errors
    /// [`Unsupported`] where the solver has no true counterpart of something in the scene, where it would take more
    /// memory than it may, and for another program, which takes no single steps.
    pub fn start(
        &self,
        scene: &Scene,
        system: &ParticleSystem,
        setting: &Setting,
    ) -> Result<Run, Unsupported> {
        Ok(Run::new(self.engine(scene, system, setting)?, *setting))
    }

    /// The bare engine that a [`Run`] steps, so that laws can test it.
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
                    if matches!(method.coefficients, Coefficients::Implicit(_)) {
                        memory::fits_factor(scene)?;
                    }
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
                memory::fits_rapier(scene, scene.springs.len() + scene.rods.len())?;
                let shipped = self.id == rapier::IDS[0] && !scene.rods.is_empty();
                let settings = if shipped {
                    &rapier::RapierSettings::RODS
                } else {
                    settings
                };
                Box::new(RapierEngine::new(scene, system, timestep, settings)?)
            }
            Source::Contact(settings) => {
                let integrator = settings.contact();
                system.admits(&self.id, integrator.takes())?;
                lone_contact(scene, &system)?;
                memory::fits_factor(scene)?;
                let integrator = Box::new(integrator);
                Box::new(IntegratorEngine::with(scene, system, integrator, timestep))
            }
            Source::Forces(settings) => {
                memory::fits_rapier(scene, 0)?;
                Box::new(RapierForces::new(scene, system, timestep, settings)?)
            }
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

/// What [`RapierContact`](crate::integrators::RapierContact) is not the law of.
fn lone_contact(scene: &Scene, system: &ParticleSystem) -> Result<(), Unsupported> {
    rapier::takes_obstacles(scene)?;
    let reason = if system.strain_limiter().is_some() {
        "rapier has no strain limit"
    } else if scene.colliders.is_empty() {
        "there are no obstacles: without contact it is linearized_implicit_material in 4 substeps"
    } else if scene.colliders.iter().any(|one| one.mesh.is_some()) {
        "rapier takes the edges out of a mesh, which is not written here: planes, balls, boxes and capsules are"
    } else if system.obstacles().is_some_and(Obstacles::among_particles) {
        "contact of particles with each other is not written here: rapier has it"
    } else {
        return Ok(());
    };
    Err(Unsupported {
        reason: reason.to_owned(),
    })
}

/// rapier's worlds at fixed settings, and its contact.
fn worlds() -> [Solver; 5] {
    let converged = Solver {
        id: rapier::IDS[2].into(),
        summary: "rapier's spring joints swept until they converge: linearly implicit Euler",
        follows: integrators::find("linearized_implicit_material"),
        ..joints(rapier::RapierSettings::CONVERGED)
    };
    let own_forces = Solver {
        id: rapier::IDS[1].into(),
        summary: "rapier's bodies under this program's forces: symplectic Euler",
        follows: integrators::find("symplectic_euler"),
        ..forces(rapier::RapierSettings::FORCES)
    };
    let user_forces = Solver {
        id: rapier::IDS[3].into(),
        summary: "rapier's bodies at its defaults under this program's forces, once a step: gains energy",
        gains: Some(
            "it holds the forces of a step's start over {n} substeps, which multiplies an undamped \
             oscillator's energy by 1 + 3/8 z² a step: take one substep, or new forces in each",
        ),
        ..forces(rapier::RapierSettings::DEFAULT)
    };
    let contact = Solver {
        id: rapier::IDS[4].into(),
        summary: "rapier's soft contact as a step of this program: bounces, slides and rests as in `rapier`",
        source: Source::Contact(rapier::RapierSettings::DEFAULT),
        ..joints(rapier::RapierSettings::DEFAULT)
    };
    let defaults = joints(rapier::RapierSettings::DEFAULT);
    [defaults, own_forces, converged, user_forces, contact]
}

/// rapier's bodies under forces computed here.
fn forces(settings: rapier::RapierSettings) -> Solver {
    Solver {
        dissipates: None,
        source: Source::Forces(settings),
        ..joints(settings)
    }
}

/// rapier's spring joints with these settings; its texts describe the defaults.
fn joints(settings: rapier::RapierSettings) -> Solver {
    Solver {
        kind: SolverKind::Rapier,
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
    catalogue().find(|solver| solver.id == integrators::meant(id))
}

/// The integrator of the id `own`, which a scene names, and then the other methods.
pub fn own_first(own: &str, methods: impl Iterator<Item = Solver>) -> Vec<Solver> {
    let own = integrators::meant(own);
    let first = integrators::fixed().iter().find(|method| method.id == own);
    (first.map(Solver::method).into_iter())
        .chain(methods.filter(|method| method.id != own))
        .collect()
}

/// Every method of fixed steps, first the one with the id `own`.
pub fn methods(own: &str) -> Vec<Solver> {
    own_first(own, integrators::fixed().iter().map(Solver::method))
}
