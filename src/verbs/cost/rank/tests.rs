//! Laws on made-up curves: their answers are known by construction.

use super::{Unreached, pareto, reach, slope, target};
use crate::solvers::{SolverKind, Status};
use crate::verbs::clock::WallTime;
use crate::verbs::cost::{CostCurve, CostPoint};

/// A point of n steps over one second with this error, each step one evaluation and a microsecond.
fn point(steps: u64, error: Option<f64>) -> CostPoint {
    let wall = 1e-6 * steps as f64;
    CostPoint {
        timestep: 1.0 / steps as f64,
        tolerance: None,
        steps,
        status: if error.is_some() {
            Status::Completed
        } else {
            Status::Diverged
        },
        reason: error.is_none().then(|| "diverged".to_owned()),
        error_m: error,
        error_final_m: error,
        energy_error: None,
        at_floor: false,
        wall_s: error.map(|_| WallTime {
            min: wall,
            median: wall,
            mad: Some(0.0),
        }),
        force_evaluations: Some(steps),
        linear_solves: Some(0),
        newton_iterations: Some(0),
    }
}

fn points(errors: &[Option<f64>]) -> Vec<CostPoint> {
    let counts = (0..).map(|k| 10 << k);
    counts.zip(errors).map(|(n, e)| point(n, *e)).collect()
}

fn curve(engine: &str, kind: SolverKind, points: Vec<CostPoint>) -> CostCurve {
    let slope = slope(&points);
    CostCurve {
        engine: engine.into(),
        kind,
        order: Some(2),
        observed_order: slope.as_ref().map(|s| s.order),
        slope_points: slope.map_or_else(Vec::new, |s| s.points),
        pareto: pareto(&points),
        points,
        explanation: None,
    }
}

/// The answer of a plain minimum: the mutant of the reach rule.
fn coarsest_near(points: &[CostPoint], target: f64) -> Option<usize> {
    let near = |p: &CostPoint| p.error_m.is_some_and(|e| e <= target);
    points.iter().position(near)
}

#[test]
fn a_lucky_zero_crossing_is_not_credited() {
    // The order is 2, and at the second setting the error happens to change its sign.
    let lucky = points(&[Some(1e-1), Some(1e-9), Some(6e-3), Some(1.5e-3), Some(4e-4)]);
    assert_eq!(reach(&lucky, 1e-3), Ok(4));
    assert_eq!(coarsest_near(&lucky, 1e-3), Some(1), "the mutant is fooled");
    assert_eq!(reach(&lucky, 1e-2), Ok(1), "from there on all are near");
}

#[test]
fn what_reaches_nothing_says_why() {
    let falling = points(&[Some(1e-1), Some(1e-2), Some(1e-3)]);
    assert_eq!(reach(&falling, 1e-4), Err(Unreached::Nearest(1e-3)));
    // Rounding makes the error grow again at the finest setting.
    let rising = points(&[Some(1e-1), Some(1e-5), Some(2e-4)]);
    assert_eq!(reach(&rising, 1e-4), Err(Unreached::Unsettled(2e-4)));
    assert_eq!(reach(&[], 1.0), Err(Unreached::Nothing));
    let ended = points(&[Some(1e-3), None]);
    assert_eq!(reach(&ended, 1.0), Err(Unreached::Ended));
    let late = points(&[None, Some(1e-3)]);
    assert_eq!(reach(&late, 1.0), Ok(1), "coarse ones may diverge");
}

#[test]
fn nothing_on_the_front_is_beaten_and_all_else_is() {
    let mut all = points(&[Some(1.0), Some(2.0), Some(0.5), None, Some(0.5), Some(0.1)]);
    // One point costs as much as its neighbour and is worse.
    all.push(point(all[2].steps, Some(0.6)));
    let front = pareto(&all);
    assert_eq!(front, [0, 2, 5]);
    let (a, b) = (point(7, Some(0.5)), point(7, Some(0.5)));
    assert_eq!(pareto(&[a, b]), [0, 1], "equal ones are both kept");
}

#[test]
fn the_slope_is_the_order_between_plateau_and_floor() {
    for order in [1, 2, 4, 8] {
        // A plateau where the motion is not resolved, then the order, then a floor of noise.
        let error = |n: f64| (n / 40.0).powi(-order).min(0.7) + 1e-14 * (1.0 + (n * 0.7).sin());
        let mut all: Vec<CostPoint> = (0..14)
            .map(|k| point(10 << k, Some(error(f64::from(10 << k)))))
            .collect();
        for p in &mut all {
            p.at_floor = p.error_m.is_some_and(|e| e < 1e-13);
        }
        let found = slope(&all).expect("a slope");
        // The noise is a tenth of the floor at most and only in the last point used: ln(1.1) spread over a
        // line of at least three factors of two.
        assert!((found.order - f64::from(order)).abs() < 0.05, "{found:?}");
        assert!(
            found
                .points
                .iter()
                .all(|&at| !all[at].at_floor && all[at].error_m < Some(0.7))
        );
        // The mutant that fits all points is off.
        let fitted = |points: &[CostPoint]| {
            let ends = [points.first(), points.last()].map(|p| p.expect("a point"));
            let [from, to] = ends.map(|p| (p.timestep.ln(), p.error_m.expect("an error").ln()));
            (from.1 - to.1) / (from.0 - to.0)
        };
        assert!((fitted(&all) - f64::from(order)).abs() > 0.1);
    }
    assert_eq!(
        slope(&points(&[Some(1.0), Some(0.5), Some(0.25)])),
        None,
        "three are too few"
    );
    assert_eq!(slope(&points(&[Some(0.0); 5])), None, "exact");
    let plateau = points(&[Some(0.5), Some(0.5), Some(0.49), Some(0.48)]);
    assert_eq!(slope(&plateau), None, "nothing is followed yet");
}

#[test]
fn targets_rank_integrators_and_only_list_the_engine() {
    // Curves of order 2 at one and at three times the cost, of order 1, and rapier's, cheaper than all.
    let second = |price: u64| {
        let errors = (0..10).map(|k| point((10 << k) * price, Some(0.1 / f64::from(1 << (2 * k)))));
        errors.collect::<Vec<_>>()
    };
    let first = (0..10)
        .map(|k| point(10 << k, Some(0.1 / f64::from(1 << k))))
        .collect();
    let curves = [
        curve("dear", SolverKind::Integrator, second(3)),
        curve("slow", SolverKind::Integrator, first),
        curve("cheap", SolverKind::Integrator, second(1)),
        curve("rapier", SolverKind::Rapier, points(&[Some(1e-9)])),
        curve("ended", SolverKind::Integrator, points(&[None])),
    ];
    let answer = target(&curves, 1e-4, None);
    let names: Vec<&str> = answer.ranking.iter().map(|r| r.engine.as_str()).collect();
    assert_eq!(names, ["cheap", "dear", "slow", "ended"]);
    let ratios: Vec<Option<f64>> = answer.ranking.iter().map(|r| r.wall_ratio).collect();
    assert_eq!(ratios[0], Some(1.0));
    assert!((ratios[1].expect("reached") - 3.0).abs() < 1e-12);
    assert_eq!(ratios[2..], [None, None]);
    // The curve has order 1 and an error of 2e-4 at its finest: a factor 2 in steps is missing.
    let slow = &answer.ranking[2];
    assert!(
        slow.reason
            .as_deref()
            .is_some_and(|r| r.contains("2.0e-4 m"))
    );
    let more = slow.more_steps.expect("a slope");
    assert!((more - 0.1 / 512.0 / 1e-4).abs() < 1e-9, "{more}");
    // Its finest setting has 5,120 steps, the cheapest 320.
    let dear = slow.extrapolated_wall_ratio.expect("both are timed");
    assert!((dear - 16.0 * more).abs() < 1e-6, "{dear}");
    assert_eq!(
        answer.cheapest.as_ref().map(|c| c.engine.as_str()),
        Some("cheap")
    );
    assert_eq!(answer.cheapest, answer.fewest_evaluations);
    assert_eq!(answer.reference.len(), 1);
    assert_eq!(answer.reference[0].wall_ratio, Some(10.0 / 320.0));
    let nobody = target(&curves, 1e-4, Some("no truth".into()));
    assert!(nobody.cheapest.is_none() && nobody.ranking.is_empty());
    assert_eq!(nobody.reason.as_deref(), Some("no truth"));
}

#[test]
fn of_equal_counts_the_clock_chooses_nobody() {
    let timed = |engine, error, wall: f64| {
        let mut points = vec![point(10, Some(error))];
        points[0].wall_s = Some(WallTime {
            min: wall,
            median: wall,
            mad: None,
        });
        curve(engine, SolverKind::Integrator, points)
    };
    for [one, other] in [[1e-3, 2e-3], [2e-3, 1e-3]] {
        let curves = [timed("rough", 1e-4, one), timed("fine", 1e-6, other)];
        let answer = target(&curves, 1e-3, None);
        let fewest = answer.fewest_evaluations.expect("both reach it");
        assert_eq!(fewest.engine, "fine");
    }
}
