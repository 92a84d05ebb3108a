//! What accuracy costs: laws of the sweep and its answers on counts.

mod adaptive;
mod sweep;
mod theory;

use springcheck::crosscheck::cost::{CostChoice, CostPlan};
use springcheck::engines::Solver;
use springcheck::crosscheck::{self, Quiet};
use springcheck::integrators::{self, Method};
use springcheck::outcome::{Cost, CostCurve};
use springcheck::scene::{self, Scene};
use springcheck::truth::Demand;
use std::path::Path;

/// A scene of this repository.
fn read(name: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("scenes")
        .join(name);
    scene::read(&path, crosscheck::names()).expect("a valid scene")
}

/// These methods over a small budget, no engines.
fn choice(methods: Vec<&'static Method>) -> CostChoice {
    CostChoice {
        solvers: methods.into_iter().map(Solver::method).collect(),
        targets: vec![1e-2, 1e-3, 1e-4],
        settings: 10,
        budget_s: 4.0,
        timesteps: None,
        truth: Demand::Auto,
    }
}

fn all() -> Vec<&'static Method> {
    integrators::REGISTRY.iter().collect()
}

fn cost(scene: &Scene, choice: &CostChoice) -> Cost {
    CostPlan::new(scene, choice)
        .execute(&Quiet)
        .cost()
        .expect("the cost of a sweep")
        .clone()
}

fn of<'a>(cost: &'a Cost, engine: &str) -> &'a CostCurve {
    let mut curves = cost.curves.iter();
    curves
        .find(|curve| curve.engine == engine)
        .expect("a curve")
}
