//! The gate: every sabotage turns it red by name, and nothing else does.

mod alarms;
mod sabotage;

use crate::testkit::mutants::{Step, mutant};
use crate::testkit::scenes::shipped;
use springcheck::integrators;
use springcheck::measure::{Check, CheckStatus};
use springcheck::scene::Scene;
use springcheck::solvers::Solver;
use springcheck::verbs::Report;
use springcheck::verbs::check::{Claim, Gate};
use springcheck::verbs::run::Choice;
use springcheck::verbs::session::Quiet;

fn failed(report: &Report) -> Vec<&Check> {
    let checks = report.header.checks.iter();
    checks
        .filter(|check| check.status == CheckStatus::Fail)
        .collect()
}

/// The scene's gate with one more integrator, which claims to be a method of the registry.
fn claiming(scene: &Scene, step: Step, method: &str) -> Report {
    let mut choice = Gate::choice(scene);
    choice = choice.with(Solver::own("mine", mutant(step)));
    judged(scene, &choice, method)
}

fn judged(scene: &Scene, choice: &Choice, method: &str) -> Report {
    let mut gate = Gate::of(scene, choice);
    gate.claims = vec![Claim {
        name: "mine".to_owned(),
        scheme: method.parse().expect("a scheme"),
        repeats: true,
    }];
    gate.run(&Quiet).expect("nothing is written")
}
