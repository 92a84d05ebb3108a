//! What accuracy costs: laws of the sweep and its answers on counts.

mod adaptive;
mod edges;
mod sweep;
mod theory;

use springcheck::integrators::{self, Method};
use springcheck::scene::Scene;
use springcheck::solvers::Solver;
use springcheck::truth::Demand;
use springcheck::verbs::cost::{Cost, CostCurve};
use springcheck::verbs::cost::{CostChoice, CostPlan};
use springcheck::verbs::session::Quiet;

/// These methods over a small budget, no engines.
fn choice(methods: Vec<&'static Method>) -> CostChoice {
    CostChoice {
        solvers: methods.into_iter().map(Solver::method).collect(),
        targets: vec![1e-2, 1e-3, 1e-4],
        settings: 10,
        budget_s: 1.5,
        timesteps: None,
        truth: Demand::Auto,
    }
}

fn all() -> Vec<&'static Method> {
    integrators::fixed().iter().collect()
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
