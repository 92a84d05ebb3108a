//! A plan: a row of the caller's own, what judging may take, and the progress.

use crate::testkit::cloth::cloth;
use crate::testkit::scenes::shipped;
use springcheck::integrators::{self, Settings};
use springcheck::measure::{Check, CheckStatus};
use springcheck::scene::{DampingModel, Scene};
use springcheck::solvers::{self, Solver, SolverKind};
use springcheck::trajectory::SaveError;
use springcheck::truth::{Demand, NoStore};
use springcheck::verbs::Report;
use springcheck::verbs::run::Outcome;
use springcheck::verbs::run::{Choice, Plan};
use springcheck::verbs::session::{Label, Quiet, Saver, Session};
use std::sync::atomic::{AtomicU64, Ordering};

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
            .all(|o| o.kind == SolverKind::Integrator)
    );
    assert!(
        report.outcomes()[at + 1..]
            .iter()
            .all(|o| o.kind == SolverKind::Rapier)
    );
    let evaluations = |report: &Report| report.header.scene.effects[0].evaluations;
    assert_eq!(evaluations(&report), evaluations(&without) + 500);
}

/// The checks of a plan with these solvers and no truth.
fn checks(scene: &Scene, ids: &[&str]) -> Vec<Check> {
    let choice = Choice {
        solvers: ids.iter().filter_map(|id| solvers::find(id)).collect(),
        truth: Demand::None,
        ..Choice::default_for(scene)
    };
    let report = Plan::new(scene, &choice).execute(&Quiet);
    report.expect("nothing is saved").header.checks
}

#[test]
fn the_twin_proof_is_made_where_rapier_runs() {
    let scene = circle();
    let is_twin = |check: &&Check| check.id.starts_with("twin-");
    let proofs = |ids: &[&str]| checks(&scene, ids).iter().filter(is_twin).count();
    assert_eq!(proofs(&["rk4"]), 0);
    for rapier in ["rapier", "rapier-forces"] {
        assert_eq!(proofs(&["rk4", rapier]), 2, "{rapier}");
    }
    assert_eq!(proofs(&["rapier-user-forces"]), 3);
}

/// Predicting limits takes 1,700 steps of each particle, and judging may take 10,000,000 whatever the runs took:
/// enough for 5,882 particles. What is left out is named, once.
#[test]
fn what_would_take_longer_than_the_runs_is_left_out_and_named() {
    for (side, left_out) in [(76, false), (78, true)] {
        let mut scene = cloth(side, 0.0, DampingModel::Axial);
        scene.duration = 4.0 * scene.solver.timestep;
        let checks = checks(&scene, &["symplectic_euler"]);
        let judging = checks.iter().filter(|check| check.id == "judging");
        let said: Vec<&str> = judging
            .clone()
            .map(|check| check.message.as_str())
            .collect();
        assert_eq!(said.len(), usize::from(left_out), "{side}: {said:?}");
        assert!(
            said.iter().all(|said| said.contains("predicted limits")),
            "{said:?}"
        );
        assert!(
            judging
                .clone()
                .all(|check| check.status == CheckStatus::Skip)
        );
    }
    // A proof by 48 linear solves of 6,084 particles, beside four steps of rapier: it says itself that it is left out.
    let mut scene = cloth(78, 0.0, DampingModel::Axial);
    scene.duration = 4.0 * scene.solver.timestep;
    let checks = checks(&scene, &["rapier-forces"]);
    let proof = checks.iter().find(|check| check.id == "twin-joints");
    let said = proof.map(|check| (check.status, check.message.contains("left out")));
    assert_eq!(said, Some((CheckStatus::Skip, true)));
}

/// Orders are of integrators: what rapier takes beside them is no part of it. Mutant: all runs.
#[test]
fn measuring_orders_takes_two_runs_of_each_integrator() {
    let scene = shipped("contact/coulomb.yml");
    let orders = |ids: &[&str]| {
        let choice = Choice {
            solvers: ids.iter().filter_map(|id| solvers::find(id)).collect(),
            ..Choice::default_for(&scene)
        };
        let plan = Plan::new(&scene, &choice).expecting(false, &NoStore);
        plan.beside.orders
    };
    // 7 s at 1 ms, two particles.
    assert_eq!(orders(&["rk4"]), 2 * 7_000 * 2);
    assert_eq!(orders(&["rk4", "rapier", "rapier-forces"]), 2 * 7_000 * 2);
}

/// Adds up the progress.
#[derive(Default)]
struct Counted(AtomicU64);

impl Session for Counted {
    fn saver(&self, _: &Label) -> Result<Option<Box<dyn Saver>>, SaveError> {
        Ok(None)
    }

    fn progress(&self, units: u64) {
        self.0.fetch_add(units, Ordering::Relaxed);
    }
}

/// Also where a run diverges early, rapier lacks something, or there is a truth to converge.
#[test]
fn the_progress_ends_at_what_was_announced() {
    for path in [
        "oscillator/circle.yml",
        "hard/limit_above.yml",
        "order/undamped.yml",
    ] {
        let scene = shipped(path);
        let plan = Plan::new(&scene, &Choice::default_for(&scene)).expecting(false, &NoStore);
        let session = Counted::default();
        plan.execute(&session).expect("nothing is saved");
        assert_eq!(session.0.into_inner(), plan.units(), "{path}");
        let beside = plan.estimate().into_iter().filter(|e| e.label.steps == 0);
        let beside: Vec<String> = beside.map(|e| e.label.engine).collect();
        assert!(
            beside.iter().any(|what| what == "the twin proof"),
            "{path}: {beside:?}"
        );
        let converges = path.starts_with("order/");
        assert_eq!(
            beside.iter().any(|what| what == "the truth"),
            converges,
            "{path}"
        );
    }
}
