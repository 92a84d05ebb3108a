//! Mistakes at contact are named as such, and what is right never is.

use super::programs::{Ball, Forces, METHODS, Rule, Turn, Vector, bounce, rows};
use super::{contact, found, named, run, scene};
use crate::testkit::scenes::all_shipped;
use springcheck::physics::ParticleSystem;

fn fast(v: Vector) -> f64 {
    v[0].hypot(v[1])
}

/// Coulomb's friction of the impulse of a normal gain.
fn rubbed(v: Vector, mu: f64, gained: f64) -> [f64; 2] {
    let kept = (1.0 - mu * gained / fast(v)).max(0.0);
    [kept * v[0], kept * v[1]]
}

const MISTAKES: [(&str, Turn); 9] = [
    ("restitution_as_one", |v, _, mu, _| {
        let [x, y] = rubbed(v, mu, 2.0 * -v[2]);
        [x, y, -v[2]]
    }),
    ("restitution_as_zero", |v, _, mu, _| {
        let [x, y] = rubbed(v, mu, -v[2]);
        [x, y, 0.0]
    }),
    ("restitution_of_whole_velocity", |v, e, _, _| {
        [e * v[0], e * v[1], -e * v[2]]
    }),
    ("whole_velocity_reversed", |v, e, _, _| v.map(|c| -e * c)),
    ("friction_forgotten", |v, e, _, _| [v[0], v[1], -e * v[2]]),
    ("friction_as_factor", |v, e, mu, _| {
        [(1.0 - mu) * v[0], (1.0 - mu) * v[1], -e * v[2]]
    }),
    ("friction_as_factor_of_step", |v, e, mu, h| {
        [(1.0 - mu * h) * v[0], (1.0 - mu * h) * v[1], -e * v[2]]
    }),
    ("friction_unbounded", |v, e, mu, _| {
        let kept = 1.0 - mu * (1.0 + e) * -v[2] / fast(v);
        [kept * v[0], kept * v[1], -e * v[2]]
    }),
    ("normal_reversed", |v, e, mu, _| {
        // The impulse of size (1 + e) V, downwards; friction as it is limited by µ times that.
        let kept = 1.0 + mu * (1.0 + e) * -v[2] / fast(v);
        [kept * v[0], kept * v[1], v[2] + (1.0 + e) * v[2]]
    }),
];

const WRONG_RULES: [(Rule, &str); 3] = [
    (Rule::Event, "impulse"),
    (Rule::End, "flip_at_end"),
    (Rule::EndClamped, "flip_at_end+clamped"),
];

#[test]
fn mistakes_are_named_with_every_method() {
    let mut failed = Vec::new();
    let forces = Forces::default();
    for (id, step) in METHODS {
        for (mistake, turn) in MISTAKES {
            // Friction is not bounded where it would be: at the first impact.
            let mu = if mistake == "friction_unbounded" {
                0.4
            } else {
                0.2
            };
            let ball = Ball::new(0.7, mu);
            let scene = scene(&forces, &ball, 0.01);
            for (rule, treatment) in WRONG_RULES {
                // What is pushed in does not come back, and events need a step that is left.
                let event = rule == Rule::Event;
                let none = [
                    "normal_reversed",
                    "restitution_as_zero",
                    "friction_as_factor_of_step",
                ];
                if event && none.contains(&mistake) {
                    continue;
                }
                let steps = if mistake == "normal_reversed" { 60 } else { 90 };
                let rows = rows(&scene, &ball, &forces, step, (rule, turn), steps);
                let treatment = format!("{treatment}+{mistake}");
                if let Err(why) = named(&scene, &rows, id, &treatment, &[mistake]) {
                    failed.push(why);
                }
            }
        }
    }
    assert!(failed.is_empty(), "{}: {}", failed.len(), failed.join("\n"));
}

#[test]
fn a_position_that_is_clamped_alone_is_named() {
    let (ball, forces) = (Ball::new(0.7, 0.2), Forces::default());
    let scene = scene(&forces, &ball, 0.01);
    for (id, step) in METHODS {
        let kept: Turn = |v, _, _, _| v;
        let rows = rows(&scene, &ball, &forces, step, (Rule::EndClamped, kept), 120);
        let all = named(
            &scene,
            &rows,
            id,
            "flip_at_end+clamped+velocity_kept",
            &["velocity_kept"],
        );
        all.unwrap_or_else(|why| panic!("{why}"));
        let rows = super::rows(&scene, &ball, &forces, step, (Rule::Never, kept), 120);
        let all = named(
            &scene,
            &rows,
            id,
            "obstacles_forgotten",
            &["obstacles_forgotten"],
        );
        all.unwrap_or_else(|why| panic!("{why}"));
    }
}

#[test]
fn strange_treatments_have_no_name() {
    let (ball, forces) = (Ball::new(0.7, 0.2), Forces::default());
    let scene = scene(&forces, &ball, 0.01);
    let strange: [Turn; 3] = [
        |v, e, mu, h| {
            let [x, y, z] = bounce(v, e, mu, h);
            [x, y, z + 0.01]
        },
        // Restitution that depends on the speed, and a velocity that is turned about the normal.
        |v, e, mu, h| bounce(v, e / (1.0 + 0.02 * v[2] * v[2]), mu, h),
        |v, e, mu, h| {
            let [x, y, z] = bounce(v, e, mu, h);
            [0.8 * x - 0.6 * y, 0.6 * x + 0.8 * y, z]
        },
    ];
    for (id, step) in METHODS {
        for (at, turn) in strange.into_iter().enumerate() {
            for rule in [Rule::Event, Rule::End, Rule::EndClamped, Rule::Start] {
                let rows = rows(&scene, &ball, &forces, step, (rule, turn), 90);
                let found = found(&scene, &rows, None);
                let treated = contact(&found).unwrap_or_else(|| panic!("{id} {at}: {found:#?}"));
                assert_eq!(treated.treatment, None, "{id} {at} {rule:?}: {found:#?}");
            }
        }
    }
}

#[test]
fn right_programs_are_never_called_wrong() {
    let kinds = [(0.0, 0.0), (0.1, 0.0), (0.0, 2.0)];
    for (drag, stiffness) in kinds {
        let forces = Forces {
            drag,
            stiffness,
            penalty: None,
        };
        for e in [1.0, 0.8, 0.0] {
            let scene = scene(&forces, &Ball::new(e, 0.2), 0.01);
            let kinds = springcheck::physics::ParticleSystem::new(&scene);
            for method in springcheck::integrators::fixed() {
                if kinds.admits(method.id, method.takes()).is_err() {
                    continue;
                }
                let rows = run(&scene, method.id, 1, 120);
                let found = found(&scene, &rows, None);
                let treated = contact(&found);
                let what = format!("{} {e} {forces:?}: {found:#?}", method.id);
                assert!(found.explained.is_none(), "{what}");
                let treated = treated.unwrap_or_else(|| panic!("{what}"));
                assert_eq!(treated.treatment.as_deref(), Some("impulse"), "{what}");
            }
        }
    }
}

#[test]
fn the_librarys_own_contact_is_never_called_wrong() {
    for scene in all_shipped(&["contact"]) {
        for method in ["symplectic_euler", "velocity_verlet", "rk4"] {
            let system = ParticleSystem::new(&scene);
            let known = springcheck::integrators::find(method).expect("a method");
            if system.admits(method, known.takes()).is_err() {
                continue;
            }
            let found = found(&scene, &run(&scene, method, 1, 300), None);
            let what = format!("{method} on {}: {found:#?}", scene.file);
            assert!(
                found.explained.is_none() && found.identity.is_some(),
                "{what}"
            );
            if let Some(treated) = contact(&found) {
                assert_eq!(treated.treatment.as_deref(), Some("impulse"), "{what}");
            }
        }
    }
}

#[test]
fn what_slides_throughout_is_named() {
    let forces = Forces::default();
    let ball = Ball {
        x: [0.0, 0.0, 0.1],
        ..Ball::new(0.5, 0.2)
    };
    let scene = scene(&forces, &ball, 0.01);
    for (id, step) in METHODS {
        for (rule, treatment) in [
            (Rule::End, "flip_at_end"),
            (Rule::EndClamped, "flip_at_end+clamped"),
        ] {
            let named = |turn: Turn, treatment: &str, wrong: &[&str]| {
                let rows = rows(&scene, &ball, &forces, step, (rule, turn), 80);
                named(&scene, &rows, id, treatment, wrong).unwrap_or_else(|why| panic!("{why}"));
            };
            named(bounce, treatment, &[]);
            let factor = MISTAKES
                .iter()
                .find(|(id, _)| *id == "friction_as_factor")
                .expect("a row");
            named(factor.1, &format!("{treatment}+{}", factor.0), &[factor.0]);
        }
    }
}

#[test]
fn what_comes_to_rest_is_named() {
    let (ball, forces) = (Ball::new(0.5, 0.2), Forces::default());
    let scene = scene(&forces, &ball, 0.01);
    for (id, step) in METHODS {
        for (rule, treatment) in [
            (Rule::End, "flip_at_end"),
            (Rule::EndClamped, "flip_at_end+clamped"),
        ] {
            let rows = rows(&scene, &ball, &forces, step, (rule, bounce), 600);
            named(&scene, &rows, id, treatment, &[]).unwrap_or_else(|why| panic!("{why}"));
        }
    }
}
