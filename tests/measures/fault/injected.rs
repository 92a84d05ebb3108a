//! One thing goes wrong in one step: the step, the particle and the cause are named.

use super::record::{PRECISIONS, fault_of, rows, run};
use crate::testkit::{everything, method};
use springcheck::measure::identify::Candidate;
use springcheck::measure::identify::Fault;
use springcheck::physics::{ParticleSystem, State};
use springcheck::scene::{DampingModel, Scene};
use springcheck::trajectory::{Precision, Rows};

/// Where faults are put.
pub const AT: u64 = 17;
pub const STEPS: u64 = 40;
/// Methods of each family.
pub const METHODS: [&str; 6] = [
    "explicit_euler",
    "symplectic_euler",
    "midpoint",
    "velocity_verlet",
    "rk4",
    "implicit_euler",
];

/// A step in which each force moves more than the sixth digit.
pub fn scene() -> Scene {
    let mut scene = everything(DampingModel::Axial);
    scene.solver.timestep = 0.02;
    scene
}

pub fn own(scene: &Scene, id: &str) -> Candidate {
    Candidate::method(&ParticleSystem::new(scene), method(id), 1)
}

/// The scheme under a scene changed so.
pub fn altered(scene: &Scene, id: &str, change: impl FnOnce(&mut Scene)) -> Candidate {
    let mut wrong = scene.clone();
    change(&mut wrong);
    own(scene, id).under(&ParticleSystem::new(&wrong))
}

/// What is known of a fault that was put there.
pub struct Expected<'a> {
    pub step: u64,
    pub particle: usize,
    pub says: &'a str,
}

pub fn check(fault: Option<Fault>, expected: &Expected) -> Result<(), String> {
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
pub fn in_each_precision(
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

pub fn nothing(_: &mut Rows) {}

/// One step by another candidate.
pub fn once<'a>(own: &'a Candidate, other: &'a Candidate) -> impl Fn(u64) -> &'a Candidate {
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
pub fn worst_by_hand(scene: &Scene, id: &str, states: &[State]) -> usize {
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
                let spring = &mut s.springs[spring];
                (spring.stiffness, spring.cubic, spring.damping) = (0.0, 0.0, 0.0);
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
    // This particle has no drag in the scene.
    let dragged = altered(&scene, id, |s| s.particles[2].drag = 0.3);
    let by = |step| if step < AT { &own } else { &dragged };
    let drag = run(&scene, STEPS, by, |_, _| {});
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
            &drag,
            2,
            "from this step on: the drag of particle 2 is 0.3 N s/m, not 0",
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
