//! What a program has otherwise than the scene, found from its rows. The right answers are the changes made to the
//! scene that the rows are computed in.

use super::*;
use crate::testkit::{all_effects, cloth, everything};
use springcheck::measure::identify::Deviation;
use springcheck::scene::{Axis, DampingModel, Spring, Vectors};

/// A change, and what is to be said of it: what deviates, by which factor, where.
type Case = (fn(&mut Scene), &'static str, f64, Option<&'static str>);

const CASES: [Case; 15] = [
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
    let scaled = |s: &mut Scene, factor: f64| {
        let vectors = s.solver.gravities.0.iter_mut();
        vectors.flatten().for_each(|g| *g *= factor);
    };
    // Its length is 11.01 m/s²; the sign is that of the largest component.
    let alone = 9.81 / (9.81_f64 * 9.81 + 25.0).sqrt();
    let cases: [(&dyn Fn(&mut Scene), _, f64, _); 4] = [
        (&|s| scaled(s, 0.5), "gravity", 0.5, None),
        (&|s| scaled(s, -1.0), "gravity", -1.0, None),
        (&|s| scaled(s, 0.0), "gravity", 0.0, None),
        (
            &|s| s.solver.gravities.0.truncate(1),
            "axis",
            alone,
            Some("z"),
        ),
    ];
    for (change, what, factor, place) in cases {
        let mut wrong = scene.clone();
        change(&mut wrong);
        let rows = run(&wrong, "symplectic_euler", 1, 60);
        let found = found_within(u64::MAX, &scene, &rows, None).explained;
        let found = found.map_or_else(Vec::new, |e| e.deviations);
        is(&found, &(|_| (), what, factor, place)).unwrap_or_else(|e| panic!("{e}"));
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
