//! What a row is about: something that makes engines for any scene and step, and whose steps it takes.

use crate::crosscheck::ChosenEngine;
use crate::engines::{Counts, Engine, IntegratorEngine, Unsupported};
use crate::integrators::{self, Method, Settings, StepError};
use crate::outcome::Kind;
use crate::scene::Scene;
use crate::system::{ParticleSystem, State};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// One integrator or reference engine.
pub(super) struct Subject {
    pub id: String,
    pub kind: Kind,
    /// The method whose step it takes, as often as this in one timestep; None where it is no method.
    pub follows: Option<(&'static Method, u32)>,
    source: Source,
    tally: Arc<Tally>,
}

enum Source {
    Method(&'static Method),
    Engine(ChosenEngine),
}

/// What hand-written integrators evaluated, over all engines made.
#[derive(Debug, Default)]
pub(super) struct Tally {
    pub forces: AtomicU64,
    pub damping: AtomicU64,
}

impl Subject {
    pub fn method(method: &'static Method, tally: &Arc<Tally>) -> Self {
        Self {
            id: method.id.to_owned(),
            kind: Kind::Integrator,
            follows: Some((method, 1)),
            source: Source::Method(method),
            tally: Arc::clone(tally),
        }
    }

    pub fn engine(chosen: &ChosenEngine, tally: &Arc<Tally>) -> Self {
        let row = &chosen.row;
        let method = row.equals.and_then(integrators::find);
        Self {
            id: row.id.to_string(),
            kind: row.kind,
            follows: method.map(|method| (method, row.substeps())),
            source: Source::Engine(chosen.clone()),
            tally: Arc::clone(tally),
        }
    }

    /// A fresh engine at the scene's start.
    pub fn make(&self, scene: &Scene, timestep: f64) -> Result<Box<dyn Engine>, Unsupported> {
        let system = ParticleSystem::new(scene);
        match &self.source {
            Source::Method(method) => {
                let settings = Settings::stated(scene.solver.tolerance);
                Ok(Box::new(Counted {
                    engine: IntegratorEngine::new(scene, system, method, &settings, timestep),
                    tally: Arc::clone(&self.tally),
                }))
            }
            Source::Engine(chosen) => chosen.row.build(scene, system, timestep),
        }
    }
}

/// Hands its counts over when it is done with.
struct Counted {
    engine: IntegratorEngine,
    tally: Arc<Tally>,
}

impl Engine for Counted {
    fn step(&mut self) -> Result<(), StepError> {
        self.engine.step()
    }

    fn state(&self) -> &State {
        self.engine.state()
    }

    fn counts(&self) -> Counts {
        self.engine.counts()
    }
}

impl Drop for Counted {
    fn drop(&mut self) {
        let counts = self.engine.counts();
        let add = |sum: &AtomicU64, count: Option<u64>| {
            sum.fetch_add(count.unwrap_or(0), Ordering::Relaxed);
        };
        add(&self.tally.forces, counts.force_evaluations);
        add(&self.tally.damping, counts.damping_evaluations);
    }
}
