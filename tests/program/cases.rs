//! Other programs' trajectories, computed in NumPy from formulas, and what is true of each.

use crate::testkit::program::json_of;
use serde_json::Value;

/// What a trajectory is.
enum Is {
    /// It follows this scheme, in so many substeps.
    Scheme(&'static str, u64),
    /// It makes a known mistake, which changes this part of the scene by this factor.
    Mistake(&'static str, &'static str, f64),
    /// Something of the scene acts with a factor under this scheme.
    Deviates(&'static str, &'static str, f64),
}
use Is::{Deviates, Mistake, Scheme};

/// A file, its scene and flags, and what it is.
const CASES: &[(&str, &str, &[&str], Is)] = &[
    (
        "rk4_pa1_02.npz",
        "scenes/pa1/scene02.yml",
        &[],
        Scheme("rk4", 1),
    ),
    (
        "rk4_pa1_03.npz",
        "scenes/pa1/scene03.yml",
        &[],
        Scheme("rk4", 1),
    ),
    (
        "rk4_pa1_05.npz",
        "scenes/pa1/scene05.yml",
        &[],
        Scheme("rk4", 1),
    ),
    (
        "linear_predicted.npz",
        "",
        &[],
        Scheme("linearized_implicit_predicted", 1),
    ),
    (
        "newton_2.npz",
        "",
        &[],
        Scheme("stopped(implicit_euler)", 2),
    ),
    ("rk3.npz", "", &[], Scheme("rk3", 1)),
    (
        "leapfrog_staggered.npz",
        "",
        &[],
        Scheme("leapfrog_staggered", 1),
    ),
    ("beeman.npz", "", &[], Scheme("beeman", 1)),
    (
        "in_place_midpoint.npz",
        "",
        &[],
        Scheme("in_place(midpoint)", 1),
    ),
    (
        "exp_damping.npz",
        "",
        &[],
        Scheme("symplectic_euler+exponential_damping", 1),
    ),
    (
        "frame_damping_99.npz",
        "",
        &[],
        Deviates("symplectic_euler", "velocity", 0.99),
    ),
    (
        "verlet_drag_97.npz",
        "",
        &[],
        Deviates("symplectic_euler", "velocity", 0.97),
    ),
    (
        "implicit_damper.npz",
        "",
        &[],
        Scheme("symplectic_euler+implicit_damping", 1),
    ),
    (
        "forces_held_4.npz",
        "",
        &[],
        Scheme("forces_held(symplectic_euler)", 4),
    ),
    (
        "gravity_9_8.npz",
        "",
        &[],
        Deviates("symplectic_euler", "gravity", 9.8 / 9.81),
    ),
    (
        "damping_halved.npz",
        "",
        &[],
        Deviates("symplectic_euler", "springs.damping", 0.5),
    ),
    (
        "stiffness_half.npz",
        "",
        &[],
        Deviates("symplectic_euler", "springs.stiffness", 0.5),
    ),
    (
        "spring_sign.npz",
        "",
        &[],
        Mistake(
            "spring_reversed(symplectic_euler)",
            "springs.stiffness",
            -1.0,
        ),
    ),
    (
        "springs_forgotten.npz",
        "",
        &[],
        Mistake(
            "springs_forgotten(symplectic_euler)",
            "springs.stiffness",
            0.0,
        ),
    ),
    (
        "reaction_missing.npz",
        "",
        &[],
        Mistake(
            "second_end_only(symplectic_euler)",
            "springs.first_end",
            0.0,
        ),
    ),
    (
        "drag_forgotten.npz",
        "",
        &[],
        Mistake("damping_forgotten(rk4)", "drag", 0.0),
    ),
    ("float_states.npz", "", &[], Scheme("symplectic_euler", 1)),
    ("float_9g.csv", "", &[], Scheme("symplectic_euler", 1)),
    (
        "two_d.npz",
        "",
        &["--axes", "xy"],
        Scheme("symplectic_euler", 1),
    ),
];

/// An error, where the answer is another.
fn judged(code: i32, outcome: &Value, is: &Is) -> Result<(), String> {
    let (identified, explained) = (&outcome["identified"], &outcome["explained"]);
    let named = |method: &str| identified["method"] == method;
    let deviates = |what: &str, factor: f64| {
        let all = explained["deviations"].as_array();
        let first = all.and_then(|all| all.first());
        // The fits end where rounding of the data does: measured 1e-12 and less.
        first.is_some_and(|d| {
            let found = d["factor"].as_f64().unwrap_or(f64::NAN);
            d["what"] == what && (found - factor).abs() <= 1e-10
        })
    };
    let right = match *is {
        Scheme(method, substeps) => {
            let exact = named(method) && identified["substeps"] == substeps;
            code == 0 && exact && explained.is_null()
        }
        Mistake(method, what, factor) => code == 1 && named(method) && deviates(what, factor),
        Deviates(scheme, what, factor) => {
            code == 3
                && identified.is_null()
                && explained["scheme"] == scheme
                && explained["residual"]
                    .as_f64()
                    .is_some_and(|left| left <= 16.0)
                && deviates(what, factor)
        }
    };
    if right {
        Ok(())
    } else {
        Err(format!("{code}: {identified:#} {explained:#}"))
    }
}

/// What `compare` says of a file.
fn said(file: &str, scene: &str, flags: &[&str]) -> (i32, Value) {
    let folder = "tests/program/cases";
    let path = format!("{folder}/{file}");
    let stem = file.split('.').next().unwrap_or(file);
    let scene = match scene {
        "" => format!("{folder}/{stem}.yml"),
        scene => scene.to_owned(),
    };
    let call = [
        "compare", &path, "--scene", &scene, "--truth", "none", "--quiet",
    ];
    let (code, mut report) = json_of(&[&call, flags].concat());
    (code, report["outcomes"][0].take())
}

#[test]
fn other_programs_are_called_what_they_are() {
    let mut answers = Vec::new();
    for (file, scene, flags, is) in CASES {
        let (code, outcome) = said(file, scene, flags);
        judged(code, &outcome, is).unwrap_or_else(|error| panic!("{file}: {error}"));
        answers.push((code, outcome));
    }
    // The answer to one is no answer to another that is something else.
    let (code, outcome) = &answers[0];
    for (.., is) in &CASES[3..] {
        assert!(judged(*code, outcome, is).is_err());
    }
}
