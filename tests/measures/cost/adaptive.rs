//! Adaptive pairs beside fixed steps, and integrators of the caller's own.

use super::{choice, cost, of};
use crate::testkit::mutants;
use crate::testkit::scenes::shipped;
use springcheck::integrators::{self, Settings};
use springcheck::solvers::Solver;
use springcheck::solvers::{SolverKind, Status};

#[test]
fn pairs_are_swept_over_tolerance_and_take_fewest_evaluations() {
    let scene = shipped("oscillator/oscillator.yml");
    let mut choice = choice(
        integrators::fixed()
            .iter()
            .filter(|m| m.order < 4)
            .collect(),
    );
    let pairs = integrators::pairs().iter().map(Solver::method);
    choice.solvers.extend(pairs);
    choice.targets = vec![1e-7];
    choice.budget_s = 3.0;
    let cost = cost(&scene, &choice);
    for method in integrators::pairs() {
        let curve = of(&cost, method.id);
        assert_eq!(
            (curve.kind, curve.order),
            (SolverKind::Integrator, Some(method.order))
        );
        let tolerances: Vec<f64> = curve.points.iter().filter_map(|p| p.tolerance).collect();
        assert_eq!(tolerances.len(), curve.points.len());
        assert!(
            tolerances.windows(2).all(|pair| pair[0] > pair[1]),
            "{tolerances:?}"
        );
        for point in curve
            .points
            .iter()
            .filter(|p| p.status == Status::Completed)
        {
            let mean = scene.duration / point.steps as f64;
            assert!((point.timestep - mean).abs() <= 1e-12 * mean);
            // Rejected steps and the first one's guess come on top of what accepted ones take.
            let [accepted, _] = method.pair().expect("a pair").evaluations();
            let least = point.steps * u64::from(accepted);
            assert!(point.force_evaluations >= Some(least), "{point:?}");
        }
    }
    // Order 8 and 5 against 2 at seven digits: theory puts a factor of ten and more between them.
    let ranking = &cost.targets[0].ranking;
    let place = |id: &str| {
        let rank = ranking
            .iter()
            .find(|rank| rank.engine == id)
            .expect("a rank");
        rank.reached
            .as_ref()
            .and_then(|reached| reached.force_evaluations)
    };
    let [five, eight, second] = ["dormand_prince54", "dop853", "velocity_verlet"].map(place);
    let [five, eight] = [five, eight].map(|count| count.expect("reached"));
    assert!(eight < five, "{eight} {five}");
    assert!(
        second.is_none_or(|second| second > 10 * five),
        "{second:?} {five}"
    );
}

#[test]
fn an_integrator_of_ones_own_gets_a_curve_like_any_other() {
    let scene = shipped("oscillator/oscillator.yml");
    let method = integrators::find("velocity_verlet").expect("a method");
    let mut choice = choice(vec![method]);
    choice.budget_s = 0.5;
    choice.targets = vec![1e-3];
    let same = move || method.build(&Settings::default());
    let stale = || mutants::mutant(mutants::verlet_with_a_stale_force)();
    choice.solvers.push(Solver::own("mine", same));
    choice.solvers.push(Solver::own("stale", stale));
    let cost = cost(&scene, &choice);
    // Its settings differ, since its limit is not known; its line is the same.
    let slope = |id: &str| of(&cost, id).observed_order.expect("a slope");
    assert!((slope("mine") - slope("velocity_verlet")).abs() < 0.02);
    // The mutant kicks with a force one step old: first order, and seen to be.
    assert!((slope("stale") - 1.0).abs() < 0.1, "{}", slope("stale"));
    let reached = |id: &str| {
        let rank = cost.targets[0]
            .ranking
            .iter()
            .find(|rank| rank.engine == id);
        rank.and_then(|rank| rank.reached.as_ref()?.force_evaluations)
    };
    let [own, stale] = ["mine", "stale"].map(reached);
    assert!(
        stale.is_none_or(|stale| Some(stale) > own),
        "{stale:?} {own:?}"
    );
}
