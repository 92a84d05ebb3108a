//! Laws every sweep keeps: settings, reasons, the same answer however many threads.

use super::{all, choice, cost, of};
use crate::testkit::scenes::shipped;
use springcheck::integrators;
use springcheck::scene::Scene;
use springcheck::solvers;
use springcheck::solvers::{SolverKind, Status};
use springcheck::truth::Demand;
use springcheck::verbs::cost::Cost;
use springcheck::verbs::cost::{CostChoice, CostPlan};
use springcheck::verbs::session::Quiet;
use springcheck::verbs::{Body, Report};

/// Everything but the clock's: points, slopes, fronts, who reaches what and why not.
fn counted(report: &Report) -> String {
    let mut report = report.clone();
    let Body::Cost { cost, .. } = &mut report.body else {
        panic!("no cost");
    };
    for effect in &mut report.header.scene.effects {
        effect.wall_ns = None;
    }
    for curve in &mut cost.curves {
        for point in &mut curve.points {
            point.wall_s = None;
        }
    }
    for target in &mut cost.targets {
        target.cheapest = None;
        target.ranking.sort_by(|a, b| a.engine.cmp(&b.engine));
        for rank in target.ranking.iter_mut().chain(&mut target.reference) {
            (rank.wall_ratio, rank.extrapolated_wall_ratio) = (None, None);
            if let Some(reached) = &mut rank.reached {
                reached.wall_median_s = None;
            }
        }
        if let Some(fewest) = &mut target.fewest_evaluations {
            fewest.wall_median_s = None;
        }
    }
    serde_json::to_string(&report).expect("JSON")
}

fn on_threads(threads: usize, scene: &Scene, choice: &CostChoice) -> Report {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.expect("a pool")
        .install(|| CostPlan::new(scene, choice).execute(&Quiet))
}

#[test]
fn all_but_the_clock_is_the_same_on_every_number_of_threads() {
    let scene = shipped("pa1/scene03.yml");
    let mut choice = choice(all());
    let rapier = solvers::rapier::IDS.iter();
    choice
        .solvers
        .extend(rapier.filter_map(|id| solvers::find(id)));
    (choice.budget_s, choice.settings) = (1.0, 4);
    let [one, four] = [1, 4].map(|threads| counted(&on_threads(threads, &scene, &choice)));
    assert_eq!(one, four);
}

/// What holds of every sweep.
fn laws(cost: &Cost) {
    for curve in &cost.curves {
        let steps: Vec<u64> = curve.points.iter().map(|p| p.steps).collect();
        assert!(
            steps.is_sorted() && !steps.is_empty(),
            "{}: {steps:?}",
            curve.engine
        );
        for point in &curve.points {
            let completed = point.status == Status::Completed;
            assert_eq!(point.reason.is_none(), completed, "{}", curve.engine);
            assert_eq!(
                point.wall_s.is_some(),
                completed,
                "a wrong answer has no speed"
            );
            assert!(completed || point.error_m.is_none());
            if let Some(wall) = &point.wall_s {
                assert!(wall.min > 0.0 && wall.min <= wall.median);
            }
        }
        assert!(
            curve
                .slope_points
                .iter()
                .all(|at| !curve.points[*at].at_floor)
        );
        assert_eq!(
            curve.explanation.is_some(),
            curve.kind == SolverKind::Rapier
        );
    }
    for target in &cost.targets {
        for rank in target.ranking.iter().chain(&target.reference) {
            assert_eq!(
                rank.reached.is_some(),
                rank.reason.is_none(),
                "{}",
                rank.engine
            );
            let Some(reached) = &rank.reached else {
                continue;
            };
            let curve = of(cost, &rank.engine);
            let finer = curve
                .points
                .iter()
                .filter(|p| p.timestep <= reached.timestep);
            for point in finer {
                assert!(point.error_m <= Some(target.error_m) && point.error_m.is_some());
            }
        }
    }
}

#[test]
fn every_sweep_keeps_its_laws() {
    for name in [
        "oscillator/damped_under.yml",
        "hard/stiff_beside_soft.yml",
        "hard/pleiades.yml",
    ] {
        let mut scene = shipped(name);
        scene.duration = scene.duration.min(3.0);
        let mut choice = choice(all());
        choice.solvers.extend(solvers::find("rapier"));
        (choice.budget_s, choice.settings) = (1.0, 4);
        laws(&cost(&scene, &choice));
    }
}

#[test]
fn a_target_between_two_settings_is_met_closely() {
    let scene = shipped("oscillator/oscillator.yml");
    let cost = cost(
        &scene,
        &choice(vec![
            integrators::find("velocity_verlet").expect("a method"),
        ]),
    );
    for target in &cost.targets {
        let reached = target.cheapest.as_ref().expect("reached");
        // Ten settings over the range lie a factor of 10 and more in error apart; one or two more bring it to
        // the share that is aimed at.
        assert!(reached.error_m > 0.8 * target.error_m, "{reached:?}");
        assert_eq!(
            target.cheapest.as_ref().map(|c| c.timestep),
            target.fewest_evaluations.as_ref().map(|c| c.timestep)
        );
    }
}

#[test]
fn what_diverges_and_what_cannot_be_judged_say_so() {
    let mut scene = shipped("oscillator/oscillator.yml");
    scene.springs[0].stiffness = 1e6;
    let mut choice = choice(vec![integrators::find("explicit_euler").expect("a method")]);
    // h w = 10 and 20: amplitudes grow by these factors every step.
    choice.timesteps = Some(vec![0.01, 0.02]);
    choice.truth = Demand::None;
    let cost = cost(&scene, &choice);
    let points = &cost.curves[0].points;
    assert_eq!(points.len(), 2);
    assert!(points[0].timestep > points[1].timestep);
    assert!(points.iter().all(|p| p.status == Status::Diverged));
    assert!(
        points[0]
            .reason
            .as_deref()
            .is_some_and(|r| r.starts_with("diverged: "))
    );
    assert!(cost.targets.iter().all(|t| {
        t.reason
            .as_deref()
            .is_some_and(|r| r.starts_with("no truth"))
    }));
    assert!(
        cost.targets
            .iter()
            .all(|t| t.cheapest.is_none() && t.ranking.is_empty())
    );
}

#[test]
fn below_the_truths_own_bar_nobody_reaches_anything() {
    let scene = shipped("oscillator/oscillator.yml");
    let mut choice = choice(vec![integrators::find("rk4").expect("a method")]);
    choice.targets = vec![1e-15];
    choice.budget_s = 0.5;
    let cost = cost(&scene, &choice);
    let floor = cost.floor_m.expect("a truth");
    assert!(floor > 1e-15);
    let reason = cost.targets[0].reason.as_deref().expect("a reason");
    assert!(
        reason.contains("floor") && cost.targets[0].ranking.is_empty(),
        "{reason}"
    );
}

#[test]
fn a_budget_too_small_tries_no_more_settings_than_it_holds() {
    let scene = shipped("hard/chain_20.yml");
    let method = integrators::find("implicit_euler").expect("a method");
    let plan = |settings: usize, budget_s: f64| {
        let mut choice = choice(vec![method]);
        (choice.settings, choice.budget_s) = (settings, budget_s);
        let plan = CostPlan::new(&scene, &choice);
        (plan.estimate()[0].label.steps, plan.work())
    };
    // The coarsest run has eight steps, the fewest there are; it stands alone, and is not run.
    assert_eq!(plan(12, 1e-6), (8, 0));
    assert_eq!(plan(3, 1e-6), (8, 0));
    // Twelve settings over the least range are 26 times the coarsest.
    assert!(plan(12, 1e3).0 > 26 * 8);
    // Whatever the budget, the runs stay within it; a timing takes 12 ms at least.
    for budget in [1e-3, 1e-2, 0.1, 1.0] {
        let seconds = 1e-6 * plan(12, budget).1 as f64;
        assert!(seconds <= budget + 0.012 * 12.0, "{budget}: {seconds} s");
    }
}
