//! What programs do within the step of an impact, and where they put what is inside: each is named, with what was wrong.

use super::programs::{Ball, Forces, METHODS, Point, RADIUS, Step, bounce, plus, recorded};
use super::{named, scene};

const H: f64 = 0.01;
const STEPS: u64 = 90;

fn turned(ball: &Ball, v: [f64; 3]) -> [f64; 3] {
    bounce(v, ball.e, ball.mu, H)
}

/// A step that ends inside is undone, and the velocity turned.
fn undone(ball: &Ball, at: Point, end: Point) -> Point {
    match end.0[2] <= RADIUS && end.1[2] < 0.0 {
        true => (at.0, turned(ball, end.1)),
        false => end,
    }
}

/// Cut where a gap that changes evenly is 0; the rest follows.
fn interpolated(ball: &Ball, step: &dyn Fn(f64, Point) -> Point, at: Point) -> Point {
    let gap = |point: &Point| point.0[2] - RADIUS;
    let end = step(H, at);
    if gap(&end) >= 0.0 {
        return end;
    }
    let part = gap(&at) / (gap(&at) - gap(&end));
    let (x, v) = step(part * H, at);
    step((1.0 - part) * H, (x, turned(ball, v)))
}

/// Ended at the impact, which is found by bisection.
fn dropped(ball: &Ball, step: &dyn Fn(f64, Point) -> Point, at: Point) -> Point {
    let end = step(H, at);
    if end.0[2] >= RADIUS {
        return end;
    }
    let (mut low, mut high) = (0.0, H);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        match step(middle, at).0[2] >= RADIUS {
            true => low = middle,
            false => high = middle,
        }
    }
    let (x, v) = step(low, at);
    (x, turned(ball, v))
}

#[test]
fn ways_within_a_step_are_named() {
    let mut failed = Vec::new();
    for stiffness in [0.0, 2.0] {
        for (e, mu) in [(0.8, 0.2), (0.5, 0.0)] {
            let (ball, forces) = (
                Ball::new(e, mu),
                Forces {
                    stiffness,
                    ..Forces::default()
                },
            );
            let scene = scene(&forces, &ball, H);
            let a = |x, v| forces.acceleration(x, v, mu);
            let mut check =
                |id: &str, treatment: &str, wrong: &[&str], next: &dyn Fn(Point) -> Point| {
                    let rows = recorded(H, &ball, next, STEPS);
                    let why = named(&scene, &rows, id, treatment, wrong).err();
                    failed.extend(why.map(|why| format!("{stiffness} {e} {why}")));
                };
            for (id, step) in METHODS {
                let step: Step = step;
                let by = |h: f64, at: Point| step(&a, h, at);
                check(id, "flip_at_end+moved_back", &[], &|at| {
                    undone(&ball, at, by(H, at))
                });
                check(id, "impact_by_interpolation", &[], &|at| {
                    interpolated(&ball, &by, at)
                });
                let wrong = "rest_of_step_dropped";
                check(id, wrong, &[wrong], &|at| dropped(&ball, &by, at));
            }
            check("symplectic_euler", "flip_before_drift", &[], &|(x, v)| {
                let mut v = plus(v, H, a(x, v));
                if plus(x, H, v)[2] <= RADIUS && v[2] < 0.0 {
                    v = turned(&ball, v);
                }
                (plus(x, H, v), v)
            });
            check("velocity_verlet", "flip_between_kicks", &[], &|(x, v)| {
                let mut half = plus(v, 0.5 * H, a(x, v));
                let x = plus(x, H, half);
                if x[2] <= RADIUS && half[2] < 0.0 {
                    half = turned(&ball, half);
                }
                (x, plus(half, 0.5 * H, a(x, half)))
            });
        }
    }
    assert!(failed.is_empty(), "{}: {}", failed.len(), failed.join("\n"));
}
