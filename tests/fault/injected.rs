//! One thing goes wrong in one step: the step, the particle and the cause are named.

use crate::common::{everything, method, swinging_triangle};
use crate::record::{PRECISIONS, fault_of, rows, run, thinned};
use springcheck::effects::EffectRow;
use springcheck::measure::identify::Candidate;
use springcheck::outcome::{Fault, Quantity};
use springcheck::scene::{DampingModel, Particle, Scene, Spring};
use springcheck::system::{ParticleSystem, State};
use springcheck::trajectory::{Precision, Rows};

/// Where faults are put.
const AT: u64 = 17;
const STEPS: u64 = 40;
/// Methods of each family.
const METHODS: [&str; 6] = [
    "explicit_euler",
    "symplectic_euler",
    "midpoint",
    "velocity_verlet",
    "rk4",
    "implicit_euler",
];

/// A step in which each force moves more than the sixth digit.
fn scene() -> Scene {
    let mut scene = everything(DampingModel::Axial);
    scene.solver.timestep = 0.02;
    scene
}

fn own(scene: &Scene, id: &str) -> Candidate {
    Candidate::method(&ParticleSystem::new(scene), method(id), 1)
}

/// The scheme under a scene changed so.
fn altered(scene: &Scene, id: &str, change: impl FnOnce(&mut Scene)) -> Candidate {
    let mut wrong = scene.clone();
    change(&mut wrong);
    own(scene, id).under(&ParticleSystem::new(&wrong))
}

/// What is known of a fault that was put there.
struct Expected<'a> {
    step: u64,
    particle: usize,
    says: &'a str,
}

fn check(fault: Option<Fault>, expected: &Expected) -> Result<(), String> {
    let fault = fault.ok_or("no fault found")?;
    let says = fault.explanation.contains(expected.says);
    if fault.step == expected.step && fault.particle == expected.particle && says {
        Ok(())
    } else {
        Err(format!("{fault:?}"))
    }
}

/// Applies `check` to the same motion in each precision, and sees that the law is not empty: it
/// fails one step off and one particle off.
fn in_each_precision(
    scene: &Scene,
    id: &str,
    states: &[State],
    expected: &Expected,
    change: impl Fn(&mut Rows),
) {
    for precision in PRECISIONS {
        let mut rows = rows(scene, states, precision);
        change(&mut rows);
        let fault = fault_of(scene, &rows, id);
        if let Err(error) = check(fault.clone(), expected) {
            panic!("{id}, {precision:?}, {}: {error}", expected.says);
        }
        let later = Expected {
            step: expected.step + 1,
            ..*expected
        };
        let beside = Expected {
            particle: expected.particle + 1,
            ..*expected
        };
        assert!(check(fault.clone(), &later).is_err());
        assert!(check(fault, &beside).is_err());
    }
}

fn nothing(_: &mut Rows) {}

/// One step by another candidate.
fn once<'a>(own: &'a Candidate, other: &'a Candidate) -> impl Fn(u64) -> &'a Candidate {
    move |step| if step == AT { other } else { own }
}

#[test]
fn gravity_missing_in_one_step() {
    let scene = scene();
    for id in METHODS {
        let wrong = altered(&scene, id, |s| s.solver.gravity = 0.0);
        let own = own(&scene, id);
        let states = run(&scene, STEPS, once(&own, &wrong), |_, _| {});
        // All free particles fall equally short in the first order; in second and higher order and
        // implicitly, springs pass on some of it, so which is worst is the method's.
        let lightest = match id {
            "explicit_euler" | "symplectic_euler" => 1,
            _ => worst_by_hand(&scene, id, &states),
        };
        let expected = Expected {
            step: AT,
            particle: lightest,
            says: "in this step only: the effect `gravity` is missing; 3 of 4 particles",
        };
        in_each_precision(&scene, id, &states, &expected, nothing);
    }
}

/// The free particle whose velocity is farthest from the scheme's own step, to a thousandth.
fn worst_by_hand(scene: &Scene, id: &str, states: &[State]) -> usize {
    let mut state = states[AT as usize].clone();
    let mut replayer_of = own(scene, id);
    replayer_of.substeps = 1;
    let mut replayer = replayer_of.replayer(&springcheck::integrators::Settings::default());
    let h = scene.solver.timestep;
    replayer
        .advance(AT, 1, h, None, &mut state)
        .expect("a step");
    let found = &states[AT as usize + 1];
    let off = |i: usize| {
        (3 * i..3 * i + 3)
            .map(|a| (state.v[a] - found.v[a]).powi(2))
            .sum::<f64>()
            .sqrt()
    };
    let most = (0..4).map(off).fold(0.0, f64::max);
    (0..4).find(|&i| off(i) >= 0.999 * most).expect("somebody")
}

#[test]
fn gravity_missing_from_a_step_on() {
    let scene = scene();
    let wrong = altered(&scene, "symplectic_euler", |s| s.solver.gravity = 0.0);
    let own = own(&scene, "symplectic_euler");
    let by = |step| if step < AT { &own } else { &wrong };
    let states = run(&scene, STEPS, by, |_, _| {});
    let expected = Expected {
        step: AT,
        particle: 1,
        says: "from this step on: the effect `gravity` is missing",
    };
    in_each_precision(&scene, "symplectic_euler", &states, &expected, nothing);
}

#[test]
fn one_spring_missing_in_one_step() {
    let scene = scene();
    for id in METHODS {
        for spring in [1, 2, 3] {
            let wrong = altered(&scene, id, |s| {
                s.springs[spring].stiffness = 0.0;
                s.springs[spring].damping = 0.0;
            });
            let own = own(&scene, id);
            let states = run(&scene, STEPS, once(&own, &wrong), |_, _| {});
            // The lighter end.
            let ends = scene.springs[spring].ends;
            let mass = |i: &usize| scene.particles[*i].mass;
            let lighter = *ends
                .iter()
                .min_by(|a, b| mass(a).total_cmp(&mass(b)))
                .expect("two");
            let [a, b] = ends;
            let says =
                format!("in this step only: spring {spring} (particles {a} and {b}) is missing");
            let expected = Expected {
                step: AT,
                particle: lighter,
                says: &says,
            };
            in_each_precision(&scene, id, &states, &expected, nothing);
        }
    }
}

#[test]
fn damping_with_the_wrong_sign_for_one_step() {
    let scene = scene();
    for id in METHODS {
        let wrong = altered(&scene, id, |s| {
            s.springs
                .iter_mut()
                .for_each(|spring| spring.damping *= -1.0);
            s.particles
                .iter_mut()
                .for_each(|particle| particle.drag *= -1.0);
        });
        let own = own(&scene, id);
        let states = run(&scene, STEPS, once(&own, &wrong), |_, _| {});
        let expected = Expected {
            step: AT,
            particle: worst_by_hand(&scene, id, &states),
            says: "in this step only: damping has the wrong sign",
        };
        in_each_precision(&scene, id, &states, &expected, nothing);
    }
}

#[test]
fn the_step_doubled_once() {
    let scene = scene();
    for id in METHODS {
        let own = own(&scene, id);
        let wrong = own.stretched(2.0);
        let states = run(&scene, STEPS, once(&own, &wrong), |_, _| {});
        let expected = Expected {
            step: AT,
            particle: worst_by_hand(&scene, id, &states),
            says: "in this step only: each step advances the state by 2 h",
        };
        in_each_precision(&scene, id, &states, &expected, nothing);
    }
}

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
fn another_method_from_a_step_on() {
    let scene = scene();
    let [verlet, euler] = ["velocity_verlet", "explicit_euler"].map(|id| own(&scene, id));
    let by = |step| if step < AT { &verlet } else { &euler };
    let states = run(&scene, STEPS, by, |_, _| {});
    let expected = Expected {
        step: AT,
        particle: worst_by_hand(&scene, "velocity_verlet", &states),
        says: "from this step on: the step is one of explicit_euler",
    };
    in_each_precision(&scene, "velocity_verlet", &states, &expected, nothing);
}

#[test]
fn what_has_a_number_is_told_with_it() {
    let scene = scene();
    let id = "symplectic_euler";
    let own = own(&scene, id);
    // An impulse of (0, 0.02, 0) N s on half a kilogram.
    let kicked = run(
        &scene,
        STEPS,
        |_| &own,
        |step, state| {
            if step == AT {
                state.v[3 * 2 + 1] += 0.04;
            }
        },
    );
    let moved = run(
        &scene,
        STEPS,
        |_| &own,
        |step, state| {
            if step == AT {
                state.x[3 * 2] += 0.25;
            }
        },
    );
    let softer = altered(&scene, id, |s| s.springs[1].stiffness = 20.0);
    let soft = run(&scene, STEPS, once(&own, &softer), |_, _| {});
    let heavier = altered(&scene, id, |s| s.solver.gravity = -9.0);
    let by = |step| if step < AT { &own } else { &heavier };
    let light = run(&scene, STEPS, by, |_, _| {});
    let by = |step| if step < AT { &own } else { &softer };
    let soft_on = run(&scene, STEPS, by, |_, _| {});
    for (states, particle, says) in [
        (
            &kicked,
            2,
            "in this step only: an impulse of (0, 0.02, 0) N s on particle 2",
        ),
        (
            &moved,
            2,
            "in this step only: particle 2 is moved by (0.25, 0, 0) m",
        ),
        (
            &soft,
            2,
            "the stiffness of spring 1 (particles 1 and 2) is 20 N/m, not 25",
        ),
        (
            &soft_on,
            2,
            "from this step on: the stiffness of spring 1 (particles 1 and 2) is 20 N/m, not 25",
        ),
        (
            &light,
            1,
            "from this step on: gravity is -9 m/s², not -9.81",
        ),
    ] {
        let rows = rows(&scene, states, Precision::Double);
        let expected = Expected {
            step: AT,
            particle,
            says,
        };
        check(fault_of(&scene, &rows, id), &expected).unwrap_or_else(|e| panic!("{says}: {e}"));
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
            radius: 0.1,
            drag: 0.0,
        })
        .collect();
    scene.springs = (0..199)
        .map(|i| Spring {
            ends: [i, i + 1],
            stiffness: 40.0,
            damping: 0.2,
            rest_length: 0.08,
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
    let scene = scene();
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
