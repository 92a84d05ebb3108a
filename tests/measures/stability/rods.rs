//! Limits on rods: of motions along them, against Laguerre's polynomials, small matrices, and steps.

use super::measured::{engine, found};
use crate::testkit::scenes::parsed;
use crate::testkit::{built, crossed, method};
use springcheck::integrators::{Method, Settings, Stable, fixed};
use springcheck::measure::stability::{Effort, Limit, Linearised};
use springcheck::physics::{ForceKinds, State};
use springcheck::scene::Scene;
use springcheck::solvers::advance;
use std::fmt::Write;

/// The largest root of Laguerre's polynomial of degree 20 (a node of Gauss' quadrature: Rabinowitz, Weiss 1959, MTAC 13,
/// table of degree 20).
const LAGUERRE_20: f64 = 66.524_416_525_615_75;

fn start(scene: &Scene) -> Linearised {
    let (system, state) = built(scene);
    Linearised::new(&system, &state, Effort::FULL)
}

/// A chain of rods of 5 cm that hangs from a fixed end, `drag` at each of its particles.
fn hanging(rods: u32, drag: f64) -> Scene {
    let mut text = "solver: {type: rattle, timestep: 0.001}\nparticles:\n\
                    - {pos: [0, 0, 0], fixed: true}\n"
        .to_owned();
    for i in 1..=rods {
        let depth = -0.05 * f64::from(i);
        let _ = writeln!(
            text,
            "- {{pos: [0, 0, {depth:?}], mass: 0.05, drag: {drag}}}"
        );
    }
    text += "rods:\n";
    for i in 0..rods {
        let _ = writeln!(text, "- {{particle_ids: [{i}, {}]}}", i + 1);
    }
    parsed(&text)
}

/// Two rods hang straight down; a spring at 45° to the first joint is at its own length.
fn braced() -> Scene {
    parsed(
        "solver: {type: rattle, timestep: 0.001}
particles:
- {pos: [0, 0, 0], fixed: true}
- {pos: [0, 0, -1], mass: 1}
- {pos: [0, 0, -2], mass: 0.5}
- {pos: [1, 0, 0], fixed: true}
rods: [{particle_ids: [0, 1]}, {particle_ids: [1, 2]}]
springs: [{particle_ids: [3, 1], stiffness: 500, rest_length: 1.4142135623730951}]
",
    )
}

/// Its largest frequency. Along x the rods pull with 1.5 g and 0.5 g over 1 m and the spring has half of its
/// stiffness; along z nothing moves. Over the masses: [[2 g + 250, -g/2], [-g, g]].
fn braced_w() -> f64 {
    let g = 9.81;
    let (trace, det) = (3.0 * g + 250.0, (2.0 * g + 250.0) * g - 0.5 * g * g);
    f64::sqrt(0.5 * (trace + f64::sqrt(trace * trace - 4.0 * det)))
}

fn taking() -> Vec<&'static Method> {
    let takes = |m: &&Method| m.takes().has(ForceKinds::CONSTRAINED);
    fixed().iter().filter(takes).collect()
}

#[test]
fn limits_are_those_of_the_fastest_motion_along_rods() {
    let g = 9.81_f64;
    let pendulum = parsed(
        "solver: {type: rattle, timestep: 0.01}
particles: [{pos: [0, 0, 0], fixed: true}, {pos: [0, 0, -2], mass: 3}]
rods: [{particle_ids: [0, 1]}]
",
    );
    // Of a chain of equal rods and particles w² is g/l times a root of Laguerre's polynomial.
    let cases = [
        ("pendulum", pendulum, f64::sqrt(g / 2.0)),
        ("chain", hanging(20, 0.0), f64::sqrt(g / 0.05 * LAGUERRE_20)),
        ("braced", braced(), braced_w()),
    ];
    for (name, scene, w) in cases {
        let linearised = start(&scene);
        let found = linearised.omega_max().expect("it swings");
        // Roundings of twenty coordinates; the positions are decimals.
        assert!((found / w - 1.0).abs() < 1e-13, "{name}: {found} {w}");
        for method in taking() {
            let limit = linearised.predict(method, 0.001).limit;
            match (method.oscillator.stable, limit) {
                (Stable::Below(z), Limit::At(h)) => {
                    assert!((h * w / z - 1.0).abs() < 1e-9, "{name}, {}: {h}", method.id);
                }
                (Stable::Never, Limit::Never) => {}
                (stated, limit) => panic!("{name}, {}: {stated:?} {limit:?}", method.id),
            }
        }
    }
}

#[test]
fn a_released_pendulum_is_linearised_as_if_held() {
    // 60° from straight down the rod is held by half of the weight, and g/2L is left, however fast it moves.
    for speed in [0.0, 3.0] {
        let scene = parsed(&format!(
            "solver: {{type: rattle, timestep: 0.01}}
particles:
- {{pos: [0, 0, 0], fixed: true}}
- {{pos: [1.7320508075688772, 0, -1], vel: [0, {speed}, 0], mass: 3}}
rods: [{{particle_ids: [0, 1]}}]
"
        ));
        let linearised = start(&scene);
        let found = linearised.omega_max().expect("it swings");
        assert!(
            (found / f64::sqrt(9.81 / 4.0) - 1.0).abs() < 1e-14,
            "{found}"
        );
        let said = linearised.excluded().join("; ");
        assert!(said.contains("1 motion that rods hold"), "{said}");
        assert_eq!(said.contains("velocities"), speed > 0.0, "{said}");
    }
}

#[test]
fn a_driven_end_adds_its_acceleration_and_not_its_velocity() {
    // At the start the end moves at 1.5 m/s along x; or it moves with the particle below it at 1.5 cos 1 m/s, from
    // 0.3 sin 1 m lower, and accelerates upwards by 7.5 sin 1 m/s².
    let (sin, cos) = f64::sin_cos(1.0);
    let upwards = (9.81 + 7.5 * sin) / (1.0 - 0.3 * sin);
    for (amplitude, phase, speed, w2) in [
        ("0.3, 0, 0", 0.0, 0.0, 9.81),
        ("0, 0, 0.3", -1.0, 1.5 * cos, upwards),
    ] {
        let scene = parsed(&format!(
            "solver: {{type: rattle, timestep: 0.01}}
particles: [{{pos: [0, 0, 0], fixed: true}}, {{pos: [0, 0, -1], vel: [0, 0, {speed:?}], mass: 2}}]
rods: [{{particle_ids: [0, 1]}}]
driven: [{{particle_id: 0, sine: {{amplitude: [{amplitude}], omega: 5, phase: {phase:?}}}}}]
"
        ));
        let found = start(&scene).omega_max().expect("it swings");
        assert!((found / f64::sqrt(w2) - 1.0).abs() < 1e-14, "{found}");
    }
}

#[test]
fn measured_limits_are_the_predicted_ones_at_a_rest() {
    let damped = parsed(
        "solver: {type: rattle, timestep: 0.01}
particles: [{pos: [0, 0, 0], fixed: true}, {pos: [0, 0, -1], mass: 1, drag: 1.5}]
rods: [{particle_ids: [0, 1]}]
",
    );
    let scenes = [braced(), hanging(20, 0.0), damped, hanging(5, 0.5)];
    let stable: Vec<&Method> = taking().into_iter().collect();
    let mut seen = 0;
    for (method, scene) in crossed(&stable, &scenes) {
        let predicted = start(scene).predict(method, 0.001).limit;
        let Limit::At(limit) = predicted else {
            continue;
        };
        let measured = found(&engine(method), scene, Some(limit)).limit;
        let Limit::At(found) = measured else {
            panic!("{}: {measured:?}", method.id);
        };
        // Bisection ends at 5e-4, and growth less than 1e-4 beyond a limit is not seen.
        let off = found / limit - 1.0;
        assert!(off.abs() < 1e-3, "{}: {off:e}", method.id);
        seen += 1;
    }
    assert!(seen >= 9, "{seen}");
}

/// A pendulum of 1 m, `up` or down from its fixed end, pushed at `push` m/s.
fn pendulum(up: f64, push: f64) -> Scene {
    parsed(&format!(
        "solver: {{type: rattle, timestep: 0.01}}
particles: [{{pos: [0, 0, 0], fixed: true}}, {{pos: [0, 0, {up:?}], vel: [{push:?}, 0, 0], mass: 1}}]
rods: [{{particle_ids: [0, 1]}}]
"
    ))
}

/// In a free drift at its limit a pendulum falls by 2 of its lengths, the upper of two links by 0.6, and under SHAKE, whose
/// velocity has what the last impulse left, by twice that. Impulses put them back, and velocities along rods are no growth.
#[test]
fn short_chains_at_rest_or_hardly_pushed_have_their_limit() {
    // Laguerre's polynomials of degree 1 and 2: 1 and 2 + √2.
    let two = 2.0 * f64::sqrt(0.05 / (9.81 * (2.0 + std::f64::consts::SQRT_2)));
    let one = 2.0 / 9.81_f64.sqrt();
    for (name, scene, limit) in [
        ("at rest", pendulum(-1.0, 0.0), one),
        ("pushed", pendulum(-1.0, 1e-6), one),
        ("two links", hanging(2, 0.0), two),
    ] {
        for id in ["rattle", "shake"] {
            let measured = found(&engine(method(id)), &scene, Some(limit)).limit;
            let Limit::At(found) = measured else {
                panic!("{name}, {id}: {measured:?}");
            };
            // Bisection ends at 1e-3 where a map is not linear.
            let off = found / limit - 1.0;
            assert!(off.abs() < 1e-3, "{name}, {id}: {off:e}");
        }
    }
}

/// What stands on its rod falls in truth, as e^(t √(g/L)) at first, and methods are right to follow: no limit is stated.
#[test]
fn what_grows_in_truth_has_no_limit() {
    let standing = pendulum(1.0, 0.0);
    let linearised = start(&standing);
    assert_eq!(linearised.growing(), 2);
    for id in ["rattle", "shake", "rk4", "symplectic_euler"] {
        let predicted = linearised.predict(method(id), 0.01).limit;
        let measured = found(&engine(method(id)), &standing, None).limit;
        for limit in [predicted, measured] {
            let Limit::Unknown(why) = limit else {
                panic!("{id}: {limit:?}");
            };
            assert!(why.contains("in truth"), "{id}: {why}");
        }
    }
}

#[test]
fn baumgarte_limits_the_step_too() {
    let scene = parsed(
        "solver: {type: rattle, timestep: 0.01, gravity: 0}
particles: [{pos: [0, 0, 0], mass: 1}, {pos: [1, 0, 0], mass: 2}]
rods: [{particle_ids: [0, 1]}]
constraints: {stabilisation: baumgarte, rate: 40}
",
    );
    let linearised = start(&scene);
    for (id, z) in [
        // |1 - z| <= 1, and the least z with R(-z) = 1 of classical Runge-Kutta.
        ("explicit_euler", 2.0),
        ("rk4", 2.785_293_563_405_282),
        // 4 - 2 (2 z) - z² >= 0.
        ("symplectic_euler", 8.0_f64.sqrt() - 2.0),
    ] {
        let method = method(id);
        let limit = linearised.predict(method, 0.01).limit;
        let Limit::At(limit) = limit else {
            panic!("{id}: {limit:?}");
        };
        assert!((limit * 40.0 / z - 1.0).abs() < 1e-9, "{id}: {limit}");
        // An error of the rod decays just inside and grows just outside.
        for (part, decays) in [(0.98, true), (1.02, false)] {
            let (system, start) = built(&scene);
            let mut state = State::new(start.x.clone(), start.v.clone());
            state.x[0] -= 1e-6;
            let mut integrator = method.build(&Settings::default());
            for _ in 0..400 {
                let end = state.t + part * limit;
                // A rod that shrinks to nothing has grown its error, too.
                let step = advance(integrator.as_mut(), &system, part * limit, end, &mut state);
                if step.is_err() {
                    break;
                }
            }
            let apart = [0, 1, 2].map(|c| state.x[3 + c] - state.x[c]);
            let off = (apart[0].hypot(apart[1]).hypot(apart[2]) - 1.0).abs();
            assert_eq!(off < 1e-6, decays, "{id}, {part}: {off:e}");
        }
    }
}

#[test]
fn what_is_not_known_is_said() {
    // RATTLE's dampers and impulses.
    let mut uneven = hanging(3, 0.02);
    uneven.particles[2].drag = 0.05;
    let linearised = start(&uneven);
    for id in ["rattle", "shake"] {
        let Limit::Unknown(why) = linearised.predict(method(id), 0.001).limit else {
            panic!("{id}");
        };
        assert!(why.contains("dampers and the impulses of rods"), "{why}");
    }
    assert!(matches!(
        linearised.predict(method("velocity_verlet"), 0.001).limit,
        Limit::At(_)
    ));
    // Methods that refuse.
    let Limit::Unknown(why) = linearised.predict(method("yoshida4"), 0.001).limit else {
        panic!("refused");
    };
    assert!(
        why.contains("rods are not taken") && why.contains("rattle"),
        "{why}"
    );
    // A chain that bends couples two coordinates of each particle.
    let mut large = hanging(301, 0.0);
    for (i, particle) in large.particles.iter_mut().enumerate() {
        let side = if i % 2 == 0 { 0.0 } else { 0.03 };
        particle.position = [side, 0.0, -0.04 * i as f64];
    }
    let Limit::Unknown(why) = start(&large).predict(method("rattle"), 0.001).limit else {
        panic!("too large");
    };
    assert!(why.contains("too many coordinates"), "{why}");
}
