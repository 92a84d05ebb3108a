//! What a report says of energy where dampers are booked more than they took.

use super::{remembering, scene};
use crate::testkit::method;
use springcheck::measure::EnergyClass;
use springcheck::report;
use springcheck::solvers::Solver;
use springcheck::verbs::Report;
use springcheck::verbs::run::{Choice, Plan};

/// Explicit Euler as the scene's own integrator.
fn run(name: &str) -> Report {
    let mut scene = scene(name);
    "explicit_euler".clone_into(&mut scene.solver.method);
    let choice = Choice {
        solvers: vec![Solver::method(method("explicit_euler"))],
        ..Choice::default_for(&scene)
    };
    let report = Plan::new(&scene, &choice).execute(remembering());
    let report = report.expect("no files");
    let energy = report.outcomes()[0].energy.as_ref().expect("an energy");
    assert_eq!(energy.class, Some(EnergyClass::Growing));
    report
}

/// Its energy falls to nothing, and only its balance grows.
#[test]
fn a_growing_balance_is_not_called_a_gain() {
    let report = run("test_equation");
    let remarks = report.outcomes()[0].remarks.join(" ");
    assert!(
        remarks.contains("grows, though E itself falls"),
        "{remarks}"
    );
    let verdict = report::verdict::verdict(&report.view());
    assert!(verdict.contains("has a balance that grows by"), "{verdict}");
}

/// Here it winds a wheel up.
#[test]
fn a_gain_is() {
    let report = run("spin_axial");
    let remarks = report.outcomes()[0].remarks.join(" ");
    assert!(
        remarks.contains("energy grows as its law says"),
        "{remarks}"
    );
    let verdict = report::verdict::verdict(&report.view());
    assert!(verdict.contains(" gains "), "{verdict}");
}
