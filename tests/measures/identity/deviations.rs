//! What a program has otherwise than the scene, found from its rows. The right answers are the changes made to the
//! scene that the rows are computed in.

use super::*;
use crate::testkit::{all_effects, cloth, driven, everything};
use springcheck::measure::identify::Deviation;
use springcheck::scene::{Axis, DampingModel, Spring, Vectors};

/// A change, and what is to be said of it: what deviates, by which factor, where.
type Case = (fn(&mut Scene), &'static str, f64, Option<&'static str>);

const CASES: [Case; 16] = [
    (|s| s.solver.gravity = -9.8, "gravity", 9.8 / 9.81, None),
    (|s| s.solver.gravity = 0.0, "gravity", 0.0, None),
    (
        |s| (s.up, s.solver.gravity) = (Axis::Y, -1.62),
        "axis",
        1.62 / 9.81,
        Some("y"),
    ),
    (
        |s| (s.up, s.solver.gravity) = (Axis::X, 9.81),
        "axis",
        -1.0,
        Some("x"),
    ),
    (
        |s| s.springs.iter_mut().for_each(|s| s.stiffness *= 0.5),
        "springs.stiffness",
        0.5,
        None,
    ),
    (
        |s| s.springs.iter_mut().for_each(|s| s.stiffness = 0.0),
        "springs.stiffness",
        0.0,
        None,
    ),
    (
        |s| s.springs.iter_mut().for_each(|s| s.damping *= -3.0),
        "springs.damping",
        -3.0,
        None,
    ),
    (
        |s| s.springs[1].rest_length *= 1.25,
        "springs.rest_length",
        1.25,
        Some("spring 1"),
    ),
    (
        |s| times(&mut s.springs[1], 0.0),
        "springs",
        0.0,
        Some("spring 1"),
    ),
    (
        |s| times(&mut s.springs[1], 2.0),
        "springs",
        2.0,
        Some("spring 1"),
    ),
    (
        |s| s.particles.iter_mut().for_each(|p| p.mass *= 2.0),
        "mass",
        2.0,
        None,
    ),
    (
        |s| s.particles.iter_mut().for_each(|p| p.charge *= -1.0),
        "charge",
        -1.0,
        None,
    ),
    (|s| s.magnetic = None, "charge", 0.0, None),
    (
        |s| s.bending.iter_mut().for_each(|h| h.stiffness *= 0.5),
        "bending.stiffness",
        0.5,
        None,
    ),
    (
        |s| (s.bending[1].stiffness, s.bending[1].damping) = (0.0, 0.0),
        "bending",
        0.0,
        Some("hinge 1"),
    ),
    (
        |s| s.bending[1].damping *= 3.0,
        "bending.damping",
        3.0,
        Some("hinge 1"),
    ),
];

/// A spring that acts so many times.
fn times(spring: &mut Spring, factor: f64) {
    for force in [
        &mut spring.stiffness,
        &mut spring.cubic,
        &mut spring.damping,
    ] {
        *force *= factor;
    }
}

/// What deviates in rows of a program that has the scene changed so.
fn deviations(scene: &Scene, change: fn(&mut Scene), method: &str, budget: u64) -> Vec<Deviation> {
    let mut wrong = scene.clone();
    change(&mut wrong);
    let rows = run(&wrong, method, 1, 60);
    let found = found_within(budget, scene, &rows, None);
    found.explained.map_or_else(Vec::new, |e| e.deviations)
}

/// One number is found where one is wrong, and nothing is said beside it: the motion tells it.
fn is(found: &[Deviation], (_, what, factor, place): &Case) -> Result<(), String> {
    match found {
        // Data of doubles over a step of 4 ms: 1e-16 / 0.004 in a velocity, over some 0.1 m/s of its change.
        [d] if d.what == *what
            && (d.factor - factor).abs() <= 1e-9
            && d.place.as_deref() == *place
            && !d.sentence.contains("cannot tell") =>
        {
            Ok(())
        }
        _ => Err(format!("{what}, {factor}: {found:?}")),
    }
}

#[test]
fn the_number_that_is_wrong_is_found() {
    let scene = everything(DampingModel::Axial);
    for case in &CASES {
        for method in ["symplectic_euler", "rk4"] {
            let found = deviations(&scene, case.0, method, u64::MAX);
            is(&found, case).unwrap_or_else(|e| panic!("{method}: {e}"));
        }
    }
}

/// Gravity of vectors: all of it wrong by a factor, or one of the vectors left out.
#[test]
fn a_wrong_gravity_of_vectors_is_found() {
    let mut scene = everything(DampingModel::Axial);
    scene.solver.gravity = 0.0;
    scene.solver.gravities = Vectors(vec![[0.0, 0.0, -9.81], [3.0, 4.0, 0.0]]);
    fn scaled(s: &mut Scene, factor: f64) {
        let vectors = s.solver.gravities.0.iter_mut();
        vectors.flatten().for_each(|g| *g *= factor);
    }
    // Its length is 11.01 m/s²; the sign is that of the largest component.
    let alone = 9.81 / (9.81_f64 * 9.81 + 25.0).sqrt();
    let cases: [Case; 4] = [
        (|s| scaled(s, 0.5), "gravity", 0.5, None),
        (|s| scaled(s, -1.0), "gravity", -1.0, None),
        (|s| scaled(s, 0.0), "gravity", 0.0, None),
        (
            |s| s.solver.gravities.0.truncate(1),
            "axis",
            alone,
            Some("z"),
        ),
    ];
    for case in &cases {
        let found = deviations(&scene, case.0, "symplectic_euler", u64::MAX);
        is(&found, case).unwrap_or_else(|e| panic!("{e}"));
    }
}

/// What the air does, left out, turned round or of another strength.
#[test]
fn a_wrong_drag_of_the_air_is_found() {
    let cases: [Case; 7] = [
        (|s| s.air = None, "air.velocity", 0.0, None),
        (
            |s| {
                s.air
                    .iter_mut()
                    .flat_map(|a| &mut a.velocity)
                    .for_each(|w| *w = -*w)
            },
            "air.velocity",
            -1.0,
            None,
        ),
        (
            |s| s.particles.iter_mut().for_each(|p| p.quadratic_drag = 0.0),
            "quadratic_drag",
            0.0,
            None,
        ),
        (
            |s| {
                s.particles
                    .iter_mut()
                    .for_each(|p| p.quadratic_drag *= -1.0)
            },
            "quadratic_drag",
            -1.0,
            None,
        ),
        (
            |s| s.particles[2].quadratic_drag *= 2.0,
            "quadratic_drag",
            2.0,
            Some("particle 2"),
        ),
        (
            |s| s.triangles.iter_mut().for_each(|t| t.air_drag *= -1.0),
            "air_drag",
            -1.0,
            None,
        ),
        // The density is in the same product.
        (
            |s| s.air.iter_mut().for_each(|air| air.density = 0.6),
            "air_drag",
            0.5,
            None,
        ),
    ];
    let scene = all_effects(DampingModel::Axial);
    for case in &cases {
        for method in ["symplectic_euler", "rk4"] {
            let found = deviations(&scene, case.0, method, u64::MAX);
            is(&found, case).unwrap_or_else(|e| panic!("{method}: {e}"));
        }
    }
}

#[test]
fn one_number_is_looked_for_under_every_explicit_method_first() {
    // A quarter of what a file may cost, for a quarter of the particles that take some seconds. RK4 is among the last.
    let scene = cloth::cloth(10, 0.1, DampingModel::Axial);
    let found = deviations(&scene, CASES[0].0, "rk4", 5_000_000);
    is(&found, &CASES[0]).unwrap();
}

/// Under Boris' method the field's turn is 2 atan(w h/2), so another one turns as far by an odd factor.
#[test]
fn a_plain_number_comes_before_an_odd_one() {
    let mut scene = everything(DampingModel::Axial);
    scene.particles.truncate(3);
    scene.springs.clear();
    scene.bending.clear();
    scene.gravitational.clear();
    scene.triangles.clear();
    scene.wind = None;
    scene.solver.gravity = 0.0;
    for particle in &mut scene.particles {
        (particle.drag, particle.quadratic_drag) = (0.0, 0.0);
        particle.charge = if particle.fixed { 0.0 } else { 1.0 };
        particle.mass = 0.5;
        particle.velocity = [1.0, -0.4, 0.2];
    }
    for factor in [-1.0, 1.1, 2.0] {
        let mut wrong = scene.clone();
        wrong.particles.iter_mut().for_each(|p| p.charge *= factor);
        let found = found(&scene, &run(&wrong, "boris", 1, 60), None);
        let explained = found.explained.expect("a deviation");
        assert_eq!(explained.scheme.as_deref(), Some("boris"), "{explained:?}");
        let [deviation] = &explained.deviations[..] else {
            panic!("{explained:?}")
        };
        assert_eq!(
            (deviation.what.as_str(), deviation.factor),
            ("charge", factor)
        );
    }
}

/// Gravity of any direction, and what became of the scene's vectors.
#[test]
fn the_vector_of_gravity_is_found() {
    let mut scene = everything(DampingModel::Axial);
    scene.solver.gravity = 0.0;
    scene.solver.gravities = Vectors(vec![[3.0, 0.0, -1.5], [0.0, 1.0, 0.0], [0.0, 0.0, -7.0]]);
    let cases: [(&[[f64; 3]], &str); 4] = [
        (&[[3.0, 0.0, -8.5]], "the vector (0, 1, 0) is missing"),
        (&[[3.0, 1.0, -15.5]], "the vector (0, 0, -7) acts twice"),
        (&[[1.0, 3.0, -8.5]], "x and y are exchanged"),
        (&[[-3.0, 1.0, -8.5]], "its x has the wrong sign"),
    ];
    for (vectors, says) in cases {
        let mut wrong = scene.clone();
        wrong.solver.gravities = Vectors(vectors.to_vec());
        let found = found(&scene, &run(&wrong, "rk4", 1, 60), None).explained;
        let [deviation] = &found.as_ref().expect("a deviation").deviations[..] else {
            panic!("{found:?}")
        };
        let [x, y, z] = vectors[0];
        let vector = format!("gravity is ({x}, {y}, {z}) m/s², not (3, 1, -8.5)");
        let all = deviation.sentence.starts_with(&vector) && deviation.sentence.contains(says);
        assert!(all, "{deviation:?}");
    }
}

/// Two numbers at once, of which one hides the other: what it does is not linear.
#[test]
fn two_wrong_numbers_are_found_together() {
    let scene = all_effects(DampingModel::Axial);
    for (air, method) in [(0.0, "explicit_euler"), (-1.0, "rk4"), (2.0, "midpoint")] {
        let mut wrong = scene.clone();
        wrong.solver.gravity = -9.8;
        let velocities = wrong.air.iter_mut().flat_map(|a| &mut a.velocity);
        velocities.for_each(|w| *w *= air);
        let found = found(&scene, &run(&wrong, method, 1, 60), None).explained;
        let explained = found.expect("an explanation");
        assert_eq!(explained.scheme.as_deref(), Some(method), "{explained:?}");
        let mut all: Vec<(&str, f64)> = Vec::new();
        for deviation in &explained.deviations {
            all.push((&deviation.what, deviation.factor));
        }
        all.sort_by(|a, b| a.0.cmp(b.0));
        let [("air.velocity", a), ("gravity", g)] = all[..] else {
            panic!("{explained:?}")
        };
        assert!(
            (a - air).abs() <= 1e-9 && (g - 9.8 / 9.81).abs() <= 1e-9,
            "{explained:?}"
        );
    }
}

/// The numbers of a sine that drives, where only forces tell them.
#[test]
fn a_wrong_drive_is_found() {
    let scene = driven(everything(DampingModel::Axial));
    let cases: [Case; 3] = [
        (
            |s| {
                s.driven[0]
                    .sine
                    .iter_mut()
                    .flat_map(|s| &mut s.amplitude)
                    .for_each(|a| *a *= 1.1)
            },
            "driven.sine.amplitude",
            1.1,
            None,
        ),
        (
            |s| s.driven[0].sine.iter_mut().for_each(|s| s.omega *= 1.05),
            "driven.sine.omega",
            1.05,
            None,
        ),
        (
            |s| s.driven[0].sine.iter_mut().for_each(|s| s.phase = 0.0),
            "driven.sine.phase",
            0.0,
            None,
        ),
    ];
    for case in &cases {
        let found = deviations(&scene, case.0, "rk4", u64::MAX);
        is(&found, case).unwrap_or_else(|e| panic!("{e}"));
    }
}
