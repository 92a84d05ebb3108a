//! What is written down is wrong: rows, numbers, particles; and faults where little is known of them.

use super::injected::{
    AT, Expected, METHODS, STEPS, altered, check, in_each_precision, nothing, once, own, scene,
    worst_by_hand,
};
use super::record::{PRECISIONS, fault_of, rows, run, thinned};
use crate::testkit::swinging_triangle;
use springcheck::measure::identify::Quantity;
use springcheck::physics::effects::EffectRow;
use springcheck::physics::{ParticleSystem, State};
use springcheck::scene::{DampingModel, Particle, Spring};
use springcheck::trajectory::Precision;

#[test]
fn a_row_lost_and_a_row_written_twice() {
    let scene = scene();
    for id in METHODS {
        let own = own(&scene, id);
        let mut states = run(&scene, STEPS, |_| &own, |_, _| {});
        let twice = {
            let mut states = states.clone();
            states.insert(AT as usize, states[AT as usize].clone());
            states
        };
        states.remove(AT as usize + 1);
        for (states, says) in [
            (
                states,
                "in this step only: a row lost before this one, which lies 2 steps on, not 1",
            ),
            (
                twice,
                "in this step only: the row repeats the one before it",
            ),
        ] {
            let expected = Expected {
                step: AT,
                particle: worst_by_hand(&scene, id, &states),
                says,
            };
            in_each_precision(&scene, id, &states, &expected, nothing);
        }
    }
}

#[test]
fn a_velocity_component_set_to_zero() {
    let scene = scene();
    for id in METHODS {
        let own = own(&scene, id);
        // By the program, which goes on from there.
        let states = run(
            &scene,
            STEPS,
            |_| &own,
            |step, state| {
                if step == AT {
                    state.v[3 * 2 + 1] = 0.0;
                }
            },
        );
        let expected = Expected {
            step: AT,
            particle: 2,
            says: "in this step only: the y component of the velocity of particle 2 is set to 0",
        };
        in_each_precision(&scene, id, &states, &expected, nothing);
        // In the file alone.
        let states = run(&scene, STEPS, |_| &own, |_, _| {});
        let expected = Expected {
            step: AT,
            particle: 2,
            says: "in this row only, and the next follows from the one before it: the y component \
                   of the velocity of particle 2 is set to 0",
        };
        in_each_precision(&scene, id, &states, &expected, |rows| {
            let at = (AT as usize + 1) * rows.dim + 3 * 2 + 1;
            rows.v.as_mut().expect("velocities")[at] = 0.0;
        });
    }
}

#[test]
fn two_particles_exchanged() {
    let scene = scene();
    for id in METHODS {
        let own = own(&scene, id);
        let exchange = |state: &mut State| {
            for axis in 0..3 {
                state.x.swap(3 + axis, 9 + axis);
                state.v.swap(3 + axis, 9 + axis);
            }
        };
        let states = run(
            &scene,
            STEPS,
            |_| &own,
            |step, state| {
                if step == AT {
                    exchange(state);
                }
            },
        );
        let mut expected = Expected {
            step: AT,
            particle: 1,
            says: "in this step only: particles 1 and 3 are exchanged; 2 of 4 particles",
        };
        in_each_precision(&scene, id, &states, &expected, nothing);
        let mut states = run(&scene, STEPS, |_| &own, |_, _| {});
        exchange(&mut states[AT as usize + 1]);
        expected.says = "the one before it: particles 1 and 3 are exchanged";
        in_each_precision(&scene, id, &states, &expected, nothing);
    }
}

#[test]
fn numbers_that_are_none_become_null() {
    let scene = scene();
    let own = own(&scene, "rk4");
    let states = run(&scene, STEPS, |_| &own, |_, _| {});
    let mut rows = rows(&scene, &states, Precision::Double);
    let at = (AT as usize + 1) * rows.dim + 3 * 3;
    rows.x[at] = f64::NAN;
    let fault = fault_of(&scene, &rows, "rk4").expect("a fault");
    assert_eq!((fault.step, fault.particle), (AT, 3), "{fault:?}");
    assert_eq!(fault.quantity, Quantity::Position);
    assert_eq!(fault.found[0], None);
    assert!(fault.found[1].is_some());
    let says =
        "in this row only, and the next follows from the one before it: particle 3 is not finite";
    assert_eq!(fault.explanation, says);
    let json = serde_json::to_string(&fault).expect("JSON");
    assert!(json.contains("\"quantity\":\"position_m\""), "{json}");
    assert!(json.contains("\"found\":[null,"), "{json}");
}

/// Without velocities a force shows where the scheme lets it: in the same row where the drift uses
/// the new velocity, one row later where it uses the old one.
#[test]
fn positions_alone_tell_the_step() {
    let scene = scene();
    for (id, later) in [
        ("symplectic_euler", false),
        ("velocity_verlet", false),
        ("rk4", false),
        ("explicit_euler", true),
    ] {
        let wrong = altered(&scene, id, |s| s.solver.gravity = 0.0);
        let own = own(&scene, id);
        let states = run(&scene, STEPS, once(&own, &wrong), |_, _| {});
        for precision in PRECISIONS {
            let mut rows = rows(&scene, &states, precision);
            rows.v = None;
            let fault = fault_of(&scene, &rows, id).expect("a fault");
            assert_eq!(fault.step, AT, "{id}, {precision:?}: {fault:?}");
            assert_eq!(fault.quantity, Quantity::Position);
            let says = fault
                .explanation
                .starts_with("in this step only: the effect `gravity` is missing");
            assert!(says, "{id}, {precision:?}: {fault:?}");
            assert_eq!(
                fault.explanation.contains("one row later"),
                later,
                "{id}: {fault:?}"
            );
        }
    }
}

/// Rows several steps apart: the span is named, and the step within it.
#[test]
fn a_fault_between_rows_is_found_within_its_span() {
    let scene = scene();
    for id in ["symplectic_euler", "rk4"] {
        let wrong = altered(&scene, id, |s| s.solver.gravity = 0.0);
        let own = own(&scene, id);
        let states = run(&scene, STEPS, once(&own, &wrong), |_, _| {});
        let rows = thinned(&rows(&scene, &states, Precision::Double), 5);
        let fault = fault_of(&scene, &rows, id).expect("a fault");
        assert_eq!(fault.step, 15, "{fault:?}");
        let says = "within these 5 steps, in step 17 only: the effect `gravity` is missing";
        assert!(fault.explanation.starts_with(says), "{fault:?}");
    }
}

/// Two hundred particles on a chain; one spring is missing in one step.
#[test]
fn the_particle_is_found_among_two_hundred() {
    let mut scene = swinging_triangle(0.2, DampingModel::Axial);
    scene.particles = (0..200)
        .map(|i| Particle {
            position: [0.1 * i as f64, 0.01 * (i % 7) as f64, 0.0],
            velocity: [0.0, 0.1 * (i % 5) as f64, 0.0],
            fixed: i == 0,
            mass: 0.1 + 0.001 * i as f64,
            ..Particle::default()
        })
        .collect();
    scene.springs = (0..199)
        .map(|i| Spring {
            ends: [i, i + 1],
            stiffness: 40.0,
            damping: 0.2,
            rest_length: 0.08,
            ..Spring::default()
        })
        .collect();
    scene.solver.timestep = 1e-3;
    for id in ["symplectic_euler", "implicit_euler"] {
        let wrong = altered(&scene, id, |s| {
            s.springs[123].stiffness = 0.0;
            s.springs[123].damping = 0.0;
        });
        let own = own(&scene, id);
        let states = run(&scene, STEPS, once(&own, &wrong), |_, _| {});
        let rows = rows(&scene, &states, Precision::Double);
        let expected = Expected {
            step: AT,
            particle: 123,
            says: "in this step only: spring 123 (particles 123 and 124) is missing",
        };
        check(fault_of(&scene, &rows, id), &expected).unwrap_or_else(|e| panic!("{id}: {e}"));
    }
}

/// Every effect of the registry, missing, turned round and twice.
#[test]
fn every_effect_is_named() {
    let mut scene = scene();
    // Stretched by a tenth of a metre, they pull too little to show in six digits.
    scene.springs.iter_mut().for_each(|s| s.cubic *= 20.0);
    let own = own(&scene, "rk4");
    let system = ParticleSystem::new(&scene);
    for (row, _) in system.effects() {
        for (factor, what) in [
            (0.0, "is missing"),
            (-1.0, "has the wrong sign"),
            (2.0, "acts twice"),
        ] {
            let of = |other: &EffectRow| if other.id == row.id { factor } else { 1.0 };
            let wrong = own.under(&ParticleSystem::scaled(&scene, &of));
            let states = run(&scene, STEPS, once(&own, &wrong), |_, _| {});
            let says = format!("in this step only: the effect `{}` {what}", row.id);
            let expected = Expected {
                step: AT,
                particle: worst_by_hand(&scene, "rk4", &states),
                says: &says,
            };
            in_each_precision(&scene, "rk4", &states, &expected, nothing);
        }
    }
}

/// A fixed particle that moves needs no other explanation.
#[test]
fn a_fixed_particle_that_moves_is_said_so() {
    let scene = scene();
    let own = own(&scene, "symplectic_euler");
    let states = run(
        &scene,
        STEPS,
        |_| &own,
        |step, state| {
            if step == AT {
                state.x[0] += 1.0;
            }
        },
    );
    let expected = Expected {
        step: AT,
        particle: 0,
        says: "particle 0 is fixed in the scene, but moves here",
    };
    in_each_precision(&scene, "symplectic_euler", &states, &expected, nothing);
}
