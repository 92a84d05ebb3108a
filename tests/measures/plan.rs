//! A row of the caller's own in a plan.

use crate::testkit::scenes::shipped;
use springcheck::integrators::{self, Settings};
use springcheck::scene::Scene;
use springcheck::solvers::Kind;
use springcheck::solvers::Solver;
use springcheck::verbs::Report;
use springcheck::verbs::run::Outcome;
use springcheck::verbs::run::{Choice, Plan};
use springcheck::verbs::session::Quiet;

fn circle() -> Scene {
    shipped("oscillator/circle.yml")
}

/// The default rows and `mine`, which is this method.
fn with(scene: &Scene, id: &str) -> Report {
    let method = integrators::find(id).expect(id);
    let mine = Solver::own("mine", move || method.build(&Settings::default()));
    Plan::new(scene, &Choice::default_for(scene).with(mine))
        .execute(&Quiet)
        .expect("nothing is saved")
}

/// What an outcome says but for its name, its times and what only a registry row lets it say.
fn told(report: &Report, engine: &str) -> String {
    let mut outcome: Outcome = report
        .outcomes()
        .iter()
        .find(|outcome| outcome.engine == engine)
        .expect(engine)
        .clone();
    outcome.engine.clear();
    outcome.remarks.clear();
    outcome.work.wall_s = None;
    format!("{outcome:?}")
}

#[test]
fn a_row_of_ones_own_is_told_like_the_registrys() {
    let scene = circle();
    let report = with(&scene, "symplectic_euler");
    assert_eq!(told(&report, "mine"), told(&report, "symplectic_euler"));
    // Another integrator is another row.
    let other = with(&scene, "symplectic_euler_drift_first");
    assert_ne!(told(&other, "mine"), told(&other, "symplectic_euler"));
}

#[test]
fn it_stands_after_the_integrators_and_its_evaluations_count() {
    let scene = circle();
    let without = Plan::new(&scene, &Choice::default_for(&scene))
        .execute(&Quiet)
        .expect("nothing is saved");
    let report = with(&scene, "symplectic_euler");
    let at = report
        .outcomes()
        .iter()
        .position(|o| o.engine == "mine")
        .expect("a row");
    assert_eq!(report.outcomes().len(), without.outcomes().len() + 1);
    assert!(
        report.outcomes()[..=at]
            .iter()
            .all(|o| o.kind == Kind::Integrator)
    );
    assert!(
        report.outcomes()[at + 1..]
            .iter()
            .all(|o| o.kind == Kind::Rapier)
    );
    let evaluations = |report: &Report| report.header.scene.effects[0].evaluations;
    assert_eq!(evaluations(&report), evaluations(&without) + 500);
}
