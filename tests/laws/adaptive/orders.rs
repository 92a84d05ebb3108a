//! The observed order of the formulas, at fixed steps.

use super::{order, pair, pairs};
use crate::testkit::built;
use crate::testkit::gauss::Gauss;
use crate::testkit::line::released;
use crate::testkit::scenes::shipped;
use springcheck::integrators::adaptive::Pair;
use springcheck::integrators::{Integrator, RungeKutta, Tableau};
use springcheck::measure::order::{Study, Verdict};
use springcheck::physics::{State, System};
use springcheck::truth::Motion;

fn fixed(pair: Pair) -> impl Fn() -> Box<dyn Integrator> + Sync {
    move || Box::new(RungeKutta::new(pair.tableau))
}

/// Slope of ln error over ln h through runs of these numbers of steps, by least squares; the error is the
/// distance of all coordinates at the end.
fn slope(
    system: &dyn System,
    start: &State,
    truth: &[f64],
    until: f64,
    pair: &Pair,
    steps: &[u32],
) -> f64 {
    let points: Vec<(f64, f64)> = steps
        .iter()
        .map(|&n| {
            let h = until / f64::from(n);
            let mut stepper = RungeKutta::new(pair.tableau);
            let mut state = start.clone();
            for _ in 0..n {
                stepper.step(system, h, &mut state).expect("a step");
            }
            let squares = state.x.iter().zip(truth).map(|(a, b)| (a - b) * (a - b));
            (h.ln(), 0.5 * squares.sum::<f64>().ln())
        })
        .collect();
    super::slope(&points)
}

/// Steps at which errors, of 1e-5 to 1e-12 m, are far above rounding and their leading term is all but
/// alone.
fn steps(pair: &Pair) -> &'static [u32] {
    // Stages of order 5, and of order 8.
    match pair.tableau.b.len() {
        7 => &[64, 90, 128, 180, 256],
        _ => &[20, 24, 28, 32, 36],
    }
}

#[test]
fn formulas_are_of_their_order_on_designated_scenes() {
    for path in [
        "order/undamped.yml",
        "order/axial.yml",
        "order/isotropic.yml",
    ] {
        let scene = shipped(path);
        let (system, start) = built(&scene);
        // Good to 4.4e-15 m, as the test of all other orders has it.
        let truth = Gauss::new(&system, start.clone(), scene.duration, 1e-3);
        let end = truth.states(&[scene.duration]).x;
        let measured =
            |pair: &Pair| slope(&system, &start, &end, scene.duration, pair, steps(pair));
        for (id, pair) in pairs() {
            let seen = measured(pair);
            assert!(
                (seen - f64::from(order(id))).abs() < 0.2,
                "{path}, {}: {seen}",
                id
            );
        }
        for wrong in swapped() {
            let seen = measured(&wrong);
            assert!(
                seen < 3.0,
                "{path}, wrong {}: {seen}",
                wrong.tableau.b.len()
            );
        }
    }
}

/// By the study that measures all other methods, too; on shorter runs its coarsest steps, 124 of them,
/// leave order 8 at the floor.
#[test]
fn formulas_are_of_their_order_on_an_oscillator() {
    let scene = shipped("oscillator/oscillator.yml");
    let (system, start) = built(&scene);
    let truth = released(&scene);
    for ((id, pair), until) in pairs().zip([5.0, 20.0]) {
        let study = Study::new(&system, start.clone(), &truth, 0.1, until);
        let seen = study.measure(order(id), &fixed(*pair)).observed;
        assert_eq!(seen.verdict, Verdict::Meets, "{}: {seen:?}", id);
    }
}

/// Two entries of a row in each other's place: rows still sum to nodes.
fn swapped() -> [Pair; 2] {
    [("dormand_prince54", 4, 1, 2), ("dop853", 10, 3, 4)].map(|(id, row, one, other)| {
        let right = pair(id);
        let mut a = right.tableau.a.to_vec();
        let mut entries = a[row].to_vec();
        entries.swap(one, other);
        a[row] = entries.leak();
        let tableau = Tableau {
            a: a.leak(),
            ..right.tableau
        };
        Pair { tableau, ..*right }
    })
}
