//! What programs do where particles touch each other: balls without forces, in a coding of its own.

use super::{Precision, Rows, Scene, contact, found};
use crate::testkit::scenes::parsed;

type Vector = [f64; 3];

const RADIUS: f64 = 0.1;
const MASSES: [f64; 2] = [1.0, 3.0];
const E: f64 = 0.8;

/// A ball of 1 kg meets one of 3 kg, off centre.
fn scene(h: f64) -> Scene {
    parsed(&format!(
        "solver: {{type: symplectic_euler, timestep: {h}, gravity: 0}}\nduration: 2\n\
         particles: [{{pos: [-0.5, 0, 0], vel: [1, 0.1, 0], mass: 1, radius: {RADIUS}}}, \
         {{pos: [0.5, 0.05, 0.02], vel: [-0.6, 0, 0], mass: 3, radius: {RADIUS}}}]\n\
         contact: {{particles: true, restitution: {E}}}\n"
    ))
}

fn dot(a: Vector, b: Vector) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn plus(a: Vector, h: f64, b: Vector) -> Vector {
    [0, 1, 2].map(|c| a[c] + h * b[c])
}

/// Velocities after a contact, from both before it and the unit vector from the first to the second.
type Turn = fn(Vector, Vector, Vector) -> [Vector; 2];

/// An impulse J along n that parts them with e times their speed of approach u, each with its own 1/m.
fn struck(a: Vector, b: Vector, n: Vector, e: f64, [ma, mb]: [f64; 2]) -> [Vector; 2] {
    let u = dot(b, n) - dot(a, n);
    let impulse = -(1.0 + e) * u / (1.0 / ma + 1.0 / mb);
    [plus(a, -impulse / ma, n), plus(b, impulse / mb, n)]
}

const RIGHT: Turn = |a, b, n| struck(a, b, n, E, MASSES);
const WRONG: [(&str, Turn); 5] = [
    ("masses_ignored", |a, b, n| struck(a, b, n, E, [1.0; 2])),
    ("velocities_exchanged", |a, b, _| [b, a]),
    ("normal_velocities_exchanged", |a, b, n| {
        let u = dot(b, n) - dot(a, n);
        [plus(a, u, n), plus(b, -u, n)]
    }),
    ("obstacles_forgotten", |a, b, _| [a, b]),
    ("restitution", |a, b, n| struck(a, b, n, 0.6, MASSES)),
];

/// Free motion, and at the end of a step in which they are in each other and approach, a turn; `clamped` moves them apart
/// to touch, each by the other's part of the mass. They meet at the sum of `radii`.
fn rows(h: f64, turn: Turn, clamped: bool, radii: f64) -> Rows {
    let (mut x, mut v) = (
        [[-0.5, 0.0, 0.0], [0.5, 0.05, 0.02]],
        [[1.0, 0.1, 0.0], [-0.6, 0.0, 0.0]],
    );
    let mut all = vec![(x, v)];
    for _ in 0..80 {
        x = [0, 1].map(|i| plus(x[i], h, v[i]));
        let apart = plus(x[1], -1.0, x[0]);
        let far = dot(apart, apart).sqrt();
        let n = apart.map(|c| c / far);
        let depth = radii - far;
        if depth > 0.0 {
            if dot(v[1], n) < dot(v[0], n) {
                v = turn(v[0], v[1], n);
            }
            if clamped {
                let whole = MASSES[0] + MASSES[1];
                x = [
                    plus(x[0], -depth * MASSES[1] / whole, n),
                    plus(x[1], depth * MASSES[0] / whole, n),
                ];
            }
        }
        all.push((x, v));
    }
    Rows {
        timestep: h,
        dim: 6,
        steps: (0..=80).collect(),
        x: all.iter().flat_map(|(x, _)| x.concat()).collect(),
        v: Some(all.iter().flat_map(|(_, v)| v.concat()).collect()),
        precision: Precision::Double,
        precision_v: Precision::Double,
        cut: false,
    }
}

#[test]
fn what_programs_do_where_balls_collide_is_named() {
    // A step in which they meet between two rows; and one of a rounding such that they meet at a row.
    for h in [0.0125, 0.01] {
        let scene = scene(h);
        for (clamped, way) in [(false, "flip_at_end"), (true, "flip_at_end+clamped")] {
            let found = found(&scene, &rows(h, RIGHT, clamped, 2.0 * RADIUS), None);
            let treated = contact(&found).unwrap_or_else(|| panic!("{found:#?}"));
            assert_eq!(treated.treatment.as_deref(), Some(way), "{found:#?}");
            assert!(
                treated.mistakes.is_empty() && found.explained.is_none(),
                "{found:#?}"
            );
            for (mistake, turn) in WRONG {
                let found = super::found(&scene, &rows(h, turn, clamped, 2.0 * RADIUS), None);
                let treated = contact(&found).unwrap_or_else(|| panic!("{mistake}: {found:#?}"));
                if clamped && mistake == "obstacles_forgotten" {
                    // That is no pass, but a velocity that is kept.
                    assert_eq!(treated.mistakes, ["velocity_kept"], "{found:#?}");
                    continue;
                }
                assert_eq!(
                    treated.mistakes,
                    [mistake],
                    "{mistake} {clamped}: {found:#?}"
                );
                assert!(found.explained.is_some(), "{found:#?}");
            }
        }
    }
}

#[test]
fn a_radius_that_is_taken_for_a_diameter_is_named() {
    let h = 0.0125;
    let found = found(&scene(h), &rows(h, RIGHT, true, RADIUS), None);
    let treated = contact(&found).unwrap_or_else(|| panic!("{found:#?}"));
    assert_eq!(treated.mistakes, ["radius"], "{found:#?}");
    assert!(treated.says.contains("0.5 times the radius"), "{found:#?}");
}
