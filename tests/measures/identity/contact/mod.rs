//! What programs do at contact, in codings that share nothing with the library's own: each is named, and what is right
//! is never called wrong.

mod golden;
mod mistakes;
mod numbers;
mod pairs;
mod programs;
mod slopes;
mod soft;
mod ways;

use super::{Precision, Rows, Scene, every, found, run};
use crate::testkit::scenes::parsed;
use programs::{Ball, Forces, METHODS, Rule, bounce, rows};
use springcheck::measure::identify::{Found, Treated};

/// The ball's own plane, coefficients and start, and forces as a file has them.
fn scene(forces: &Forces, ball: &Ball, h: f64) -> Scene {
    let Forces {
        drag, stiffness, ..
    } = forces;
    let spring = if *stiffness > 0.0 {
        format!("springs: [{{particle_ids: [0, 1], stiffness: {stiffness}, rest_length: 0}}]\n")
    } else {
        String::new()
    };
    let [x, v] = [ball.x, ball.v];
    parsed(&format!(
        "solver: {{type: rk4, timestep: {h}, gravity: -9.81}}\nduration: 10\n\
         particles: [{{pos: {x:?}, vel: {v:?}, mass: 1, radius: 0.1, drag: {drag}}}, {{pos: [0, 0, 3], fixed: true}}]\n\
         {spring}colliders: [{{plane: {{normal: [0, 0, 1]}}, restitution: {}, friction: {}}}]\n",
        ball.e, ball.mu
    ))
}

fn contact(found: &Found) -> Option<&Treated> {
    found.identity.as_ref()?.contact.as_ref()
}

/// The treatment that is named, or why it is not as it should be.
fn named(
    scene: &Scene,
    rows: &Rows,
    method: &str,
    treatment: &str,
    wrong: &[&str],
) -> Result<(), String> {
    let found = found(scene, rows, None);
    let identity = found
        .identity
        .as_ref()
        .ok_or_else(|| format!("no scheme: {found:?}"))?;
    let own = |name: &String| name == method || *name == format!("{method}_explicit_damping");
    let scheme = own(&identity.method) || identity.equivalent.iter().any(own);
    let contact = contact(&found).ok_or_else(|| format!("no contact: {found:?}"))?;
    let is = contact.treatment.as_deref() == Some(treatment)
        || contact.equivalent.iter().any(|other| other == treatment);
    if scheme && is && contact.mistakes == wrong && found.explained.is_some() != wrong.is_empty() {
        Ok(())
    } else {
        Err(format!("{method} {treatment} {wrong:?}: {found:#?}"))
    }
}

const RULES: [(Rule, &str); 5] = [
    (Rule::Event, "impulse"),
    (Rule::End, "flip_at_end"),
    (Rule::EndClamped, "flip_at_end+clamped"),
    (Rule::EndMirrored, "flip_at_end+mirrored"),
    (Rule::Start, "flip_at_start"),
];

#[test]
fn treatments_are_named_with_every_method_and_restitution() {
    let kinds = [(0.0, 0.0), (0.1, 0.0), (0.0, 2.0)];
    let mut failed = Vec::new();
    for (drag, stiffness) in kinds {
        let forces = Forces {
            drag,
            stiffness,
            penalty: None,
        };
        for e in [1.0, 0.8, 0.5] {
            for (id, step) in METHODS {
                let ball = Ball::new(e, 0.2);
                let scene = scene(&forces, &ball, 0.01);
                let kicks = [
                    (Rule::AfterKick, "flip_after_kick"),
                    (Rule::BeforeKick, "flip_before_kick"),
                ];
                let kicks = kicks.into_iter().filter(|_| id == "symplectic_euler");
                for (rule, treatment) in RULES.into_iter().chain(kicks) {
                    let rows = rows(&scene, &ball, &forces, step, (rule, bounce), 90);
                    if let Err(why) = named(&scene, &rows, id, treatment, &[]) {
                        failed.push(format!("{forces:?} {e} {why}"));
                    }
                }
            }
        }
    }
    assert!(failed.is_empty(), "{}: {}", failed.len(), failed.join("\n"));
}

#[test]
fn penalties_are_named_with_their_numbers() {
    let mut failed = Vec::new();
    for (drag, penalty) in [
        (0.0, (2000.0, 0.0, false)),
        (0.0, (2000.0, 15.0, false)),
        (0.0, (2000.0, 15.0, true)),
        (0.1, (1234.5, 3.25, true)),
    ] {
        for mu in [0.0, 0.2] {
            for (id, step) in METHODS {
                let forces = Forces {
                    drag,
                    stiffness: 0.0,
                    penalty: Some(penalty),
                };
                let ball = Ball::new(0.8, mu);
                let scene = scene(&forces, &ball, 0.002);
                let rows = rows(&scene, &ball, &forces, step, (Rule::Never, bounce), 600);
                let treatment = match penalty {
                    (_, c, true) if c > 0.0 => "penalty_without_pull",
                    _ => "penalty",
                };
                let why = match named(&scene, &rows, id, treatment, &[]) {
                    Ok(()) => {
                        let found = found(&scene, &rows, None);
                        let treated = contact(&found).expect("contact");
                        let numbers = (treated.stiffness_n_m, treated.damping_n_s_m);
                        (numbers != (Some(penalty.0), Some(penalty.1)))
                            .then(|| format!("{numbers:?}"))
                    }
                    Err(why) => Some(why),
                };
                failed.extend(why.map(|why| format!("{drag} {penalty:?} {mu} {id}: {why}")));
            }
        }
    }
    assert!(failed.is_empty(), "{}: {}", failed.len(), failed.join("\n"));
}

#[test]
fn thinned_and_rounded_rows_are_named_or_left_open() {
    let (ball, forces) = (Ball::new(0.8, 0.2), Forces::default());
    let scene = scene(&forces, &ball, 0.01);
    for (id, step) in METHODS {
        for (rule, treatment) in RULES {
            let rows = rows(&scene, &ball, &forces, step, (rule, bounce), 150);
            for n in [2, 3] {
                let mut thinned = every(&rows, n);
                thinned.steps = (0..thinned.len() as u64).map(|k| n as u64 * k).collect();
                let all = named(&scene, &thinned, id, treatment, &[]);
                all.unwrap_or_else(|why| panic!("every {n}: {why}"));
            }
            let mut single = rows.clone();
            let round = |all: &mut Vec<f64>| all.iter_mut().for_each(|x| *x = f64::from(*x as f32));
            round(&mut single.x);
            single.v.iter_mut().for_each(round);
            (single.precision, single.precision_v) = (Precision::Single, Precision::Single);
            let found = found(&scene, &single, None);
            let treated = contact(&found).expect("contact");
            assert_eq!(treated.treatment.as_deref(), Some(treatment), "{found:#?}");
            // Across an impact positions alone do not tell a velocity.
            let positions = Rows { v: None, ..rows };
            let found = super::found(&scene, &positions, None);
            let unjudged = contact(&found).is_none_or(|treated| treated.unjudged);
            assert!(unjudged, "{found:#?}");
        }
    }
}
