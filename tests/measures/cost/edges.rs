//! The edges of a sweep: a range's end is no answer, and a budget holds for every scene.

use super::{cost, of};
use springcheck::integrators;
use springcheck::scene::{self, Scene};
use springcheck::solvers::{Solver, Status};
use springcheck::truth::Demand;
use springcheck::verbs;
use springcheck::verbs::cost::{CostChoice, CostPlan};

/// A mass of 1 kg on a spring of rest length 0, let go at x = 1 m: x = cos(w t), w² = stiffness.
fn oscillator(stiffness: f64, duration: f64) -> Scene {
    let yaml = format!(
        "solver: {{type: explicit_euler, timestep: {:?}, gravity: 0}}\nduration: {duration:?}\n\
         particles: [{{pos: [0, 0, 0], fixed: true}}, {{pos: [1, 0, 0], mass: 1}}]\n\
         springs: [{{particle_ids: [0, 1], stiffness: {stiffness:?}, rest_length: 0}}]",
        duration / 100.0
    );
    scene::parse(yaml.as_bytes(), "oscillator.yml", verbs::names()).expect("a scene")
}

/// Explicit Euler's largest error in n steps of h at w = 1: x_k is the real part of (1 + i h)^k, whose
/// modulus is (1 + h²)^(k/2) and whose argument is k atan(h).
fn error(duration: f64, n: u64) -> f64 {
    let h = duration / n as f64;
    let x = |k: f64| (1.0 + h * h).powf(0.5 * k) * (k * h.atan()).cos();
    let errors = (1..=n).map(|k| (x(k as f64) - (k as f64 * h).cos()).abs());
    errors.fold(0.0, f64::max)
}

/// The range begins at h w = 0.2, where the error over 6 s is 0.8 m. A target above that is reached by
/// larger steps, which the closed form knows.
#[test]
fn the_coarsest_step_of_the_range_is_no_answer() {
    let duration = 6.0;
    let choice = CostChoice {
        solvers: vec![Solver::method(
            integrators::find("explicit_euler").expect("a method"),
        )],
        targets: vec![1.5, 100.0],
        settings: 5,
        budget_s: 0.5,
        timesteps: None,
        truth: Demand::Closed,
    };
    let cost = cost(&oscillator(1.0, duration), &choice);
    let points = &of(&cost, "explicit_euler").points;
    for point in points {
        let exact = error(duration, point.steps);
        let found = point.error_m.expect("an error");
        // 64 steps or so round by a few 1e-16 each; the truth's bar is 1e-13.
        assert!(
            (found - exact).abs() < 1e-12 * point.steps as f64,
            "{found} {exact}"
        );
    }
    let [middle, loose] = [0, 1].map(|at| cost.targets[at].cheapest.as_ref().expect("reached"));
    let steps = |timestep: f64| (duration / timestep).round() as u64;
    let needed = (8..)
        .find(|n| error(duration, *n) <= 1.5)
        .expect("some step");
    assert!(
        error(duration, 30) < 1.5 && needed < 30,
        "the range begins beyond the target"
    );
    let reached = steps(middle.timestep);
    // Two more runs between a step and its half come within a fifth.
    assert!(!middle.at_most && reached >= needed && reached as f64 <= 1.2 * needed as f64 + 1.0);
    // Fewer than eight steps are not tried: the price is at most that of the fewest.
    assert!(loose.at_most && steps(loose.timestep) < 16, "{loose:?}");
}

/// However stiff the spring, a sweep takes about its budget: what it would not hold is not run, with the
/// reason in its place.
#[test]
fn a_stiff_spring_costs_no_more_than_the_budget() {
    for stiffness in [1e4, 1e8, 1e12, 1e16] {
        let scene = oscillator(stiffness, 5.0);
        let choice = CostChoice {
            budget_s: 1.0,
            ..CostChoice::default_for(&scene)
        };
        let pairs = integrators::pairs().len() as f64;
        let seconds = 1e-6 * CostPlan::new(&scene, &choice).work() as f64;
        // A timing takes 12 ms at least, three of each solver are made, and a pair may take 1e4 steps.
        let least = 0.012 * 3.0 * choice.solvers.len() as f64 + 0.2 * pairs;
        assert!(seconds < 1.0 + least, "{stiffness:e}: {seconds} s");
    }
    let choice = CostChoice {
        solvers: vec![Solver::method(integrators::find("rk4").expect("a method"))],
        budget_s: 0.1,
        ..CostChoice::default_for(&oscillator(1e16, 5.0))
    };
    let cost = cost(&oscillator(1e16, 5.0), &choice);
    let points = &of(&cost, "rk4").points;
    assert!(!points.is_empty());
    for point in points {
        let reason = point.reason.as_deref().unwrap_or_default();
        assert!(
            point.status == Status::Failed && reason.starts_with("not run: "),
            "{reason}"
        );
    }
}
