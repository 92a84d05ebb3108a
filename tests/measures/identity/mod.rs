//! Which scheme a trajectory follows, by one-step replay: over the registry, substeps, scenes,
//! roundings, and for schemes that are in no list.

mod coarse;
mod contact;
mod deviations;
mod edges;
mod methods;
mod positions;
mod rapier;
mod rods;
mod scenes;
mod strangers;
mod textbook;

use springcheck::integrators::{self, Settings};
use springcheck::measure::identify::{Found, Identity, Question, identify};
use springcheck::physics::ParticleSystem;
use springcheck::scene::Scene;
use springcheck::solvers::{Engine, IntegratorEngine};
use springcheck::trajectory::{Precision, Rows};

/// Every state of an engine over `steps` steps, as a file of doubles would give it.
fn record(engine: &mut dyn Engine, timestep: f64, steps: u64) -> Rows {
    let mut rows = Rows {
        timestep,
        dim: engine.state().x.len(),
        steps: (0..=steps).collect(),
        x: Vec::new(),
        v: None,
        precision: Precision::Double,
        precision_v: Precision::Double,
        cut: false,
    };
    let mut v = Vec::new();
    for step in 0..=steps {
        if step > 0 {
            engine.step().expect("a step");
        }
        rows.x.extend_from_slice(&engine.state().x);
        v.extend_from_slice(&engine.state().v);
    }
    rows.v = Some(v);
    rows
}

fn engine(scene: &Scene, method: &str, timestep: f64) -> IntegratorEngine {
    let method = integrators::find(method).expect("a method");
    let system = ParticleSystem::new(scene);
    IntegratorEngine::new(scene, system, method, &Settings::default(), timestep)
}

/// Rows of a method at `substeps` of the scene's timestep.
fn run(scene: &Scene, method: &str, substeps: u32, steps: u64) -> Rows {
    let h = scene.solver.timestep;
    let mut engine = engine(scene, method, h / f64::from(substeps));
    every(
        &record(&mut engine, h, steps * u64::from(substeps)),
        substeps as usize,
    )
}

/// Each `n`-th row, as neighbours one step apart.
fn every(rows: &Rows, n: usize) -> Rows {
    let keep = |values: &[f64]| {
        let rows = values.chunks(rows.dim).step_by(n);
        rows.flatten().copied().collect::<Vec<f64>>()
    };
    Rows {
        steps: (0..rows.len().div_ceil(n) as u64).collect(),
        x: keep(&rows.x),
        v: rows.v.as_deref().map(keep),
        ..rows.clone()
    }
}

fn name(scene: &Scene, rows: &Rows) -> Identity {
    name_of(scene, rows, None).expect("something to replay")
}

fn name_of(scene: &Scene, rows: &Rows, transitions: Option<usize>) -> Option<Identity> {
    found(scene, rows, transitions).identity
}

fn found(scene: &Scene, rows: &Rows, transitions: Option<usize>) -> Found {
    found_within(u64::MAX, scene, rows, transitions)
}

fn found_within(budget: u64, scene: &Scene, rows: &Rows, transitions: Option<usize>) -> Found {
    identify(&Question {
        scene,
        system: &ParticleSystem::new(scene),
        rows,
        settings: Settings::default(),
        transitions,
        budget,
        hint: None,
    })
}
