//! Who takes part: something that makes a fresh engine for each setting.

use super::explain;
use super::runner::Runner;
use super::setting::Setting;
use crate::crosscheck::ChosenEngine;
use crate::engines::{AdaptiveEngine, Engine, IntegratorEngine, Unsupported};
use crate::integrators::adaptive::Pair;
use crate::integrators::{self, Integrator, Method, Settings};
use crate::outcome::Kind;
use crate::scene::Scene;
use crate::system::ParticleSystem;
use std::sync::Arc;

/// One line of the diagram.
pub(super) struct Entrant {
    pub id: String,
    pub kind: Kind,
    /// Order on this scene; None for reference engines.
    pub order: Option<u32>,
    /// The method whose stability its substeps have; None where it is none.
    pub follows: Option<&'static Method>,
    /// How many of them a step is.
    pub substeps: u32,
    /// What makes a reference engine's line what it is.
    pub explanation: Option<String>,
    source: Source,
}

enum Source {
    Method(&'static Method),
    Own(Arc<Build>),
    Pair(&'static Pair),
    Engine(ChosenEngine),
}

/// Makes a fresh integrator of the caller's own.
pub(super) type Build = dyn Fn() -> Box<dyn Integrator> + Send + Sync;

impl Entrant {
    pub fn method(method: &'static Method, damped: bool) -> Self {
        let order = if damped {
            method.order_damped
        } else {
            method.order
        };
        Self {
            follows: Some(method),
            ..Self::integrator(method.id, Some(order), Source::Method(method))
        }
    }

    pub fn pair(pair: &'static Pair) -> Self {
        Self::integrator(pair.id, Some(pair.order), Source::Pair(pair))
    }

    /// Of the caller's own; nothing is known of it.
    pub fn own(name: &str, build: Arc<Build>) -> Self {
        Self::integrator(name, None, Source::Own(build))
    }

    fn integrator(id: &str, order: Option<u32>, source: Source) -> Self {
        Self {
            id: id.to_owned(),
            kind: Kind::Integrator,
            order,
            follows: None,
            substeps: 1,
            explanation: None,
            source,
        }
    }

    pub fn engine(chosen: &ChosenEngine) -> Self {
        let row = &chosen.row;
        Self {
            id: row.id.to_string(),
            kind: row.kind,
            order: None,
            follows: row.equals.and_then(integrators::find),
            substeps: row.substeps(),
            explanation: Some(explain::engine(row)),
            source: Source::Engine(chosen.clone()),
        }
    }

    /// Of a pair: how fast errors fall with its steps.
    pub fn adapts(&self) -> Option<u32> {
        match &self.source {
            Source::Pair(pair) => Some(pair.order),
            _ => None,
        }
    }

    /// A fresh one at the scene's start.
    pub fn make(
        &self,
        scene: &Scene,
        system: &ParticleSystem,
        setting: &Setting,
    ) -> Result<Runner, Unsupported> {
        let (system, timestep) = (system.clone(), setting.timestep());
        let engine: Box<dyn Engine> = match &self.source {
            Source::Method(method) => {
                let settings = Settings::stated(scene.solver.tolerance);
                Box::new(IntegratorEngine::new(
                    scene, system, method, &settings, timestep,
                ))
            }
            Source::Own(build) => {
                Box::new(IntegratorEngine::with(scene, system, build(), timestep))
            }
            Source::Engine(chosen) => chosen.row.build(scene, system, timestep)?,
            Source::Pair(pair) => {
                let tolerance = setting.tolerance().unwrap_or(f64::EPSILON);
                let engine = AdaptiveEngine::new(scene, system, pair, tolerance, scene.duration);
                return Ok(Runner::Adaptive(Box::new(engine)));
            }
        };
        Ok(Runner::Fixed(engine))
    }
}
