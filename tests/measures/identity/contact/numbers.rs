//! Numbers of contact that a program has of its own, and outcomes that rounding decides.

use super::programs::{Ball, Forces, METHODS, RADIUS, Rule, Turn, bounce, rows};
use super::{Rows, Scene, contact, found, scene};
use crate::fault::record::question;
use crate::testkit::scenes::parsed;
use springcheck::measure::identify::{Found, first_fault, identify};
use springcheck::physics::ParticleSystem;

/// The treatment that a program is found to have, and what is wrong about it.
fn wrongs(scene: &Scene, rows: &Rows) -> (Option<String>, Vec<String>, String) {
    let found = found(scene, rows, None);
    let treated = contact(&found).unwrap_or_else(|| panic!("{found:#?}"));
    (
        treated.treatment.clone(),
        treated.mistakes.clone(),
        treated.says.clone(),
    )
}

#[test]
fn wrong_restitution_and_friction_are_told_by_their_numbers() {
    let (forces, ball) = (Forces::default(), Ball::new(0.7, 0.1));
    let scene = scene(&forces, &ball, 0.01);
    let wrong: [(Turn, &[&str], &[&str]); 4] = [
        (
            |v, e, mu, h| bounce(v, e * e, mu, h),
            &["restitution"],
            &["restitution of 0.49, not 0.7"],
        ),
        (
            |v, _, mu, h| bounce(v, 0.6, mu, h),
            &["restitution"],
            &["restitution of 0.6, not 0.7"],
        ),
        (
            |v, e, _, h| bounce(v, e, 0.15, h),
            &["friction"],
            &["friction of 0.15, not 0.1"],
        ),
        (
            |v, _, _, h| bounce(v, 0.6, 0.15, h),
            &["restitution", "friction"],
            &["restitution of 0.6, not 0.7", "friction of 0.15, not 0.1"],
        ),
    ];
    for (id, step) in METHODS {
        for (turn, mistakes, says) in wrong {
            for rule in [Rule::Event, Rule::End, Rule::EndClamped] {
                let rows = rows(&scene, &ball, &forces, step, (rule, turn), 90);
                let (_, found, said) = wrongs(&scene, &rows);
                assert_eq!(found, mistakes, "{id} {rule:?}: {said}");
                assert!(
                    says.iter().all(|one| said.contains(one)),
                    "{id} {rule:?}: {said}"
                );
            }
        }
    }
}

/// A floor 0.05 m lower is a radius that is smaller by as much, and one without a radius lies 0.1 m lower.
#[test]
fn wrong_sizes_are_told_by_their_numbers() {
    let (forces, ball) = (Forces::default(), Ball::new(0.7, 0.0));
    for (lower, says) in [
        (0.05, "surfaces 0.05 m farther away"),
        (RADIUS, "leaves the radius out"),
    ] {
        // The program starts so much higher, and its rows are moved down.
        let high = Ball {
            x: [0.0, 0.0, 1.0 + lower],
            ..ball
        };
        let scene = scene(&forces, &ball, 0.01);
        for (id, step) in METHODS {
            let mut rows = rows(&scene, &high, &forces, step, (Rule::EndClamped, bounce), 90);
            for x in rows.x.chunks_mut(6) {
                x[2] -= lower;
            }
            let (_, mistakes, said) = wrongs(&scene, &rows);
            assert_eq!(mistakes, ["radius"], "{id} {said}");
            assert!(said.contains(says), "{id} {said}");
        }
    }
}

/// A ball that meets a wall exactly at a row, so that rounding decides in which step: v = 1 m/s from 1 m, radius 0.1 m.
#[test]
fn an_impact_at_a_row_is_judged() {
    let file = "solver: {type: rk4, timestep: 0.01, gravity: 0}\nduration: 2\n\
        particles: [{pos: [0, 0, 1], vel: [0.5, 0, -1], mass: 1, radius: 0.1}, {pos: [0, 0, 3], fixed: true}]\n\
        colliders: [{plane: {normal: [0, 0, 1]}, restitution: 0.8}]\n";
    let scene = parsed(file);
    let ball = |e: f64, steps: u64, strict: bool| {
        let (mut x, mut v) = ([0.0, 0.0, 1.0], [0.5, 0.0, -1.0]);
        let mut rows = Rows {
            timestep: 0.01,
            dim: 6,
            steps: (0..=steps).collect(),
            x: Vec::new(),
            v: Some(Vec::new()),
            precision: super::Precision::Double,
            precision_v: super::Precision::Double,
            cut: false,
        };
        for step in 0..=steps {
            if step > 0 {
                x = [0, 1, 2].map(|c| x[c] + 0.01 * v[c]);
                // With a strict test it turns one step later where the gap is 0, or off by a rounding.
                let meets = if strict {
                    x[2] < 0.1 - 1e-12
                } else {
                    x[2] < 0.1 + 1e-12
                };
                if meets && v[2] < 0.0 {
                    v[2] *= -e;
                }
            }
            rows.x.extend([x, [0.0, 0.0, 3.0]].concat());
            rows.v
                .as_mut()
                .expect("velocities")
                .extend([v, [0.0; 3]].concat());
        }
        rows
    };
    let right = found(&scene, &ball(0.8, 150, false), None);
    assert!(
        right.explained.is_none() && right.identity.is_some(),
        "{right:#?}"
    );
    let late = found(&scene, &ball(0.8, 150, true), None);
    assert!(
        late.explained.is_none() && late.identity.is_some(),
        "{late:#?}"
    );
    for strict in [false, true] {
        let (_, mistakes, said) = wrongs(&scene, &ball(0.7, 150, strict));
        assert_eq!(mistakes, ["restitution"], "{said}");
        assert!(said.contains("restitution of 0.7, not 0.8"), "{said}");
    }
}

/// A block on a floor, as symplectic Euler with the usual clamping has it: it stops where friction takes all it has.
#[test]
fn friction_of_what_slides_throughout_is_not_gravity() {
    let forces = Forces::default();
    let ball = Ball {
        x: [0.0, 0.0, RADIUS],
        v: [2.0, 0.7, 0.0],
        ..Ball::new(0.0, 0.3)
    };
    let scene = scene(&forces, &ball, 0.01);
    let slides = |turn: Turn, steps: u64| {
        rows(
            &scene,
            &ball,
            &forces,
            METHODS[0].1,
            (Rule::EndClamped, turn),
            steps,
        )
    };
    // It stops after 0.72 s, within a step.
    for steps in [50, 100] {
        let found = found(&scene, &slides(bounce, steps), None);
        assert!(
            found.explained.is_none() && found.identity.is_some(),
            "{found:#?}"
        );
        let treated = contact(&found).expect("contact");
        let euler = "symplectic_euler with flip_at_end+clamped";
        let own = treated.treatment.as_deref() == Some("flip_at_end+clamped");
        assert!(
            own || treated.equivalent.iter().any(|one| one == euler),
            "{treated:#?}"
        );
        assert_eq!(fault(&scene, &slides(bounce, steps)), None);
    }
    let (_, mistakes, said) = wrongs(&scene, &slides(|v, e, _, h| bounce(v, e, 0.4, h), 50));
    assert_eq!(mistakes, ["friction"], "{said}");
    assert!(said.contains("friction of 0.4, not 0.3"), "{said}");
    let (_, mistakes, said) = wrongs(&scene, &slides(|v, _, _, _| [v[0], v[1], 0.0], 50));
    assert_eq!(mistakes, ["friction_forgotten"], "{said}");
}

/// The explanation of the first fault.
fn fault(scene: &Scene, rows: &Rows) -> Option<String> {
    let system = ParticleSystem::new(scene);
    let question = question(scene, &system, rows);
    let Found { identity, .. } = identify(&question);
    first_fault(&question, &identity?).map(|fault| fault.explanation)
}

#[test]
fn impacts_are_no_faults_of_positions_alone() {
    let (ball, forces) = (Ball::new(0.8, 0.2), Forces::default());
    let scene = scene(&forces, &ball, 0.01);
    for (id, step) in METHODS {
        for rule in [Rule::Event, Rule::End, Rule::EndClamped] {
            let rows = Rows {
                v: None,
                ..rows(&scene, &ball, &forces, step, (rule, bounce), 150)
            };
            assert_eq!(fault(&scene, &rows), None, "{id} {rule:?}");
        }
    }
}

/// A leapfrog whose first row is half a kick early: its steps are those of symplectic Euler.
#[test]
fn staggered_velocities_bounce_as_others() {
    let (ball, forces) = (Ball::new(0.8, 0.2), Forces::default());
    let scene = scene(&forces, &ball, 0.01);
    let early = Ball {
        v: [ball.v[0], ball.v[1], 0.5 * 9.81 * 0.01],
        ..ball
    };
    let rows = rows(
        &scene,
        &early,
        &forces,
        METHODS[0].1,
        (Rule::EndClamped, bounce),
        120,
    );
    let found = found(&scene, &rows, None);
    let identity = found.identity.as_ref().expect("a scheme");
    assert_eq!(identity.method, "leapfrog_staggered", "{found:#?}");
    assert_eq!(fault(&scene, &rows), None);
}

/// The scene's own penalty, k = 2000 N/m and c = 15 N s/m, in a program that does not cut its steps.
#[test]
fn penalties_of_the_scene_in_whole_steps_are_named() {
    let scene = parsed(
        "solver: {type: rk4, timestep: 0.002, gravity: -9.81}\nduration: 10\n\
         particles: [{pos: [0, 0, 1], vel: [2, 0.7, 0], mass: 1, radius: 0.1}, {pos: [0, 0, 3], fixed: true}]\n\
         colliders: [{plane: {normal: [0, 0, 1]}}]\n\
         contact: {penalty: {stiffness: 2000, damping: 15}}\n",
    );
    type Kind<'a> = ((f64, f64, bool), &'a [&'a str]);
    let kinds: [Kind; 5] = [
        ((2000.0, 15.0, false), &[]),
        ((2000.0, 15.0, true), &[]),
        ((1000.0, 15.0, false), &["stiffness"]),
        ((2000.0, 0.0, false), &["damping"]),
        ((2000.0, -15.0, false), &["damping"]),
    ];
    for (penalty, wrong) in kinds {
        let forces = Forces {
            penalty: Some(penalty),
            ..Forces::default()
        };
        let ball = Ball::new(0.0, 0.0);
        for (id, step) in METHODS {
            let rows = rows(&scene, &ball, &forces, step, (Rule::Never, bounce), 400);
            let (treatment, mistakes, said) = wrongs(&scene, &rows);
            let name = treatment.unwrap_or_else(|| panic!("{id} {penalty:?} {said}"));
            assert!(
                name.starts_with("penalty_in_whole_steps"),
                "{id} {penalty:?} {name}"
            );
            assert_eq!(mistakes, wrong, "{id} {penalty:?} {said}");
        }
    }
}
