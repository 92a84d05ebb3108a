//! The verb as its users run it.

use crate::testkit::program::{
    self, answer, array, files, keys, leave, number, refuse, set, springcheck, tidy, well_formed,
    word,
};
use serde_json::Value;

const SCENE: &str = "scenes/oscillator/circle.yml";
/// A small map: what it shows does not matter where it is used.
const MAP: [&str; 6] = [
    "--vary",
    "springs.stiffness=1..1e4:5",
    "--steps",
    "1e-3..10:6",
    "--budget",
    "150000",
];

fn json(args: &[&str]) -> Value {
    program::json(&[&["stability"], args].concat())
}

#[test]
fn the_json_has_exactly_the_contracts_keys() {
    let args = [&[SCENE, "--integrators", "rk4,symplectic_euler"][..], &MAP].concat();
    let report = json(&args);
    let top = [
        "verb",
        "series",
        "scene",
        "truth",
        "outcomes",
        "checks",
        "advice",
        "verdict",
        "remarks",
        "stability",
    ];
    assert_eq!(keys(&report), set(&top));
    assert_eq!(report["verb"], "stability");
    assert_eq!(report["outcomes"], Value::Array(Vec::new()));
    let stability = &report["stability"];
    let wanted = [
        "omega_max_rad_s",
        "unsure",
        "horizon_s",
        "timestep_s",
        "linear",
        "excluded",
        "rows",
        "map",
        "largest",
        "admissible",
    ];
    assert_eq!(keys(stability), set(&wanted));
    assert_eq!(stability["timestep_s"], 0.01);
    assert!(stability["admissible"].is_null());
    let rows = array(&stability["rows"]);
    let engines: Vec<&Value> = rows.iter().map(|row| &row["engine"]).collect();
    assert_eq!(engines, ["rk4", "symplectic_euler", "rapier"]);
    for row in rows {
        let wanted = [
            "engine",
            "kind",
            "predicted_limit_s",
            "measured_between_s",
            "measured_limit_s",
            "unconditional",
            "measured_unconditional",
            "growth_per_s",
            "measured_growth_per_s",
            "smooth_below_s",
            "measured_smooth_below_s",
            "tightest",
            "reason",
            "remarks",
            "unsupported",
        ];
        assert_eq!(keys(row), set(&wanted));
    }
    let map = &stability["map"];
    let wanted = [
        "vary",
        "unit",
        "values",
        "timesteps_s",
        "steps_per_cell",
        "engines",
    ];
    assert_eq!(keys(map), set(&wanted));
    // 150,000 over 3 engines, 5 values, 6 timesteps and 2 particles.
    assert_eq!(map["steps_per_cell"], 833);
    assert_eq!(array(&map["engines"]).len(), 3);
    for engine in array(&map["engines"]) {
        assert_eq!(keys(engine), set(&["engine", "cells", "predicted_limit_s"]));
        assert_eq!(array(&engine["predicted_limit_s"]).len(), 5);
        assert_eq!(array(&engine["cells"]).len(), 5);
        for column in array(&engine["cells"]) {
            assert_eq!(array(column).len(), 6);
        }
    }
}

/// Symplectic Euler on an undamped linear spring is stable below z = h sqrt(k/m) = 2 and grows
/// above. A tenth above, z = 2.2 multiplies the amplitude by 2.4 a step (λ + 1/λ = 2 - z²), so that a
/// dozen steps leave no doubt.
#[test]
fn the_map_changes_where_theory_says() {
    let args = [
        &[
            SCENE,
            "--integrators",
            "symplectic_euler",
            "--engines",
            "none",
        ][..],
        &MAP,
    ]
    .concat();
    let report = json(&args);
    let map = &report["stability"]["map"];
    let (stiffnesses, timesteps) = (array(&map["values"]), array(&map["timesteps_s"]));
    let wrong = |limit_of: &dyn Fn(usize) -> f64| {
        let mut wrong = 0;
        for (i, column) in array(&map["engines"][0]["cells"]).iter().enumerate() {
            for (h, cell) in timesteps.iter().zip(array(column)) {
                let z = number(h) / limit_of(i);
                wrong += usize::from(
                    (z < 0.9 && cell != "stable")
                        || (z > 1.1 && cell != "growing" && cell != "failed"),
                );
            }
        }
        wrong
    };
    let limit = |i: usize| 2.0 / number(&stiffnesses[i]).sqrt();
    assert_eq!(wrong(&limit), 0);
    // The map upside down, and its axes in each other's place.
    assert!(wrong(&|i| limit(stiffnesses.len() - 1 - i)) > 0);
    assert!(wrong(&|i| number(&timesteps[i])) > 0);
    let predicted = array(&map["engines"][0]["predicted_limit_s"]);
    for (i, found) in predicted.iter().enumerate() {
        // An eigenvalue of a 3 by 3 matrix: some roundings.
        assert!((number(found) / limit(i) - 1.0).abs() < 1e-12, "{found}");
    }
}

/// Its bodies move as symplectic Euler moves them, so the same limit is predicted; rapier's own joints
/// are no method, so none is.
/// What `--largest` finds of each engine: the outcome, and the value where there is one.
fn largest(args: &[&str]) -> Vec<(String, String, Option<f64>)> {
    let report = json(args);
    let largest = &report["stability"]["largest"];
    assert_eq!(
        keys(largest),
        set(&["vary", "unit", "timestep_s", "tried", "rows"])
    );
    let rows = array(&largest["rows"]).iter().map(|row| {
        assert_eq!(keys(row), set(&["engine", "found", "value", "reason"]));
        let word = |key: &str| row[key].as_str().expect(key).to_owned();
        (word("engine"), word("found"), row["value"].as_f64())
    });
    rows.collect()
}

#[test]
fn the_largest_stable_value_is_that_of_the_closed_forms() {
    // 1 kg on a spring without damping at h = 0.15 s: z = h √k is 2 for Verlet, 2√2 for RK4.
    let undamped = largest(&[
        "scenes/oscillator/step_150.yml",
        "--integrators",
        "velocity_verlet,rk4,explicit_euler,implicit_euler",
        "--largest",
        "springs.stiffness",
    ]);
    let h2 = 0.15 * 0.15;
    let wanted = [
        ("velocity_verlet", "value", Some(4.0 / h2)),
        ("rk4", "value", Some(8.0 / h2)),
        ("explicit_euler", "no_value", None),
        ("implicit_euler", "every_value", None),
        ("rapier", "not_known", None),
    ];
    let same = |found: &[(String, String, Option<f64>)], wanted: &[(&str, &str, Option<f64>)]| {
        assert_eq!(found.len(), wanted.len());
        for (found, wanted) in found.iter().zip(wanted) {
            assert_eq!((found.0.as_str(), found.1.as_str()), (wanted.0, wanted.1));
            // The search's width is 1e-6.
            let off = found
                .2
                .zip(wanted.2)
                .map(|(found, wanted)| (found / wanted - 1.0).abs());
            assert_eq!(off.is_some(), wanted.2.is_some(), "{found:?}");
            assert!(
                off.is_none_or(|off| off < 2e-6),
                "{found:?}, not {wanted:?}"
            );
        }
    };
    same(&undamped, &wanted);
    // With m = 1 kg and h = 0.1 s: 4 - 2 h c - h² k >= 0 for symplectic Euler, and h k <= c for explicit Euler below
    // critical damping.
    let (h, c, k) = (0.1, std::f64::consts::SQRT_2, 50.0);
    let common = [
        "scenes/oscillator/damped_under.yml",
        "--timestep",
        "0.1",
        "--engines",
        "none",
        "--integrators",
        "symplectic_euler,explicit_euler",
    ];
    let of = |key: &str| largest(&[&common[..], &["--largest", key]].concat());
    same(
        &of("springs.stiffness"),
        &[
            (
                "symplectic_euler",
                "value",
                Some((4.0 - 2.0 * h * c) / (h * h)),
            ),
            ("explicit_euler", "value", Some(c / h)),
        ],
    );
    same(
        &of("springs.damping"),
        &[
            (
                "symplectic_euler",
                "value",
                Some((4.0 - h * h * k) / (2.0 * h)),
            ),
            // Above it h = 2 / λ with λ + k / λ = c.
            ("explicit_euler", "value", Some(2.0 / h + 0.5 * h * k)),
        ],
    );
    // A penalty is a spring while it presses, and the scene starts above the floor: 4 - 2 h c - h² k >= 0, 1 kg, c = 20 N s/m.
    let h = 5e-4;
    let pressed = largest(&[
        "scenes/contact/penalty.yml",
        "--engines",
        "none",
        "--integrators",
        "symplectic_euler",
        "--largest",
        "contact.penalty.stiffness",
    ]);
    let right = (4.0 - 2.0 * h * 20.0) / (h * h);
    same(&pressed, &[("symplectic_euler", "value", Some(right))]);
}

#[test]
fn a_run_that_stays_stable_is_not_told_to_take_a_smaller_step() {
    // Just beyond the limits of the scene linearised about its start, 0.02087 s: in the run Heun's energy stays,
    // and the midpoint rule's grows.
    let report = program::json(&[
        "run",
        "scenes/pa1/scene04.yml",
        "--integrators",
        "heun,midpoint",
        "--engines",
        "none",
        "--truth",
        "none",
        "--timestep",
        "0.022",
    ]);
    let said = |engine: &str| {
        let row = program::outcomes(&report)
            .iter()
            .find(|row| row["engine"] == engine);
        let row = row.expect(engine);
        let remarks = array(&row["remarks"]).iter();
        let remarks: Vec<&str> = remarks.filter_map(Value::as_str).collect();
        (row["energy"]["class"].clone(), remarks.join("; "))
    };
    let (class, heun) = said("heun");
    assert_eq!(class, "bounded");
    assert!(heun.contains("this run stays stable"), "{heun}");
    assert!(
        !heun.contains("is beyond its stability limit") && !heun.contains("take"),
        "{heun}"
    );
    let (class, midpoint) = said("midpoint");
    assert_eq!(class, "growing");
    assert!(
        midpoint.contains("beyond its stability limit 0.02087 s here"),
        "{midpoint}"
    );
}

#[test]
fn an_engine_that_equals_a_method_has_its_prediction() {
    let report = json(&[
        SCENE,
        "--integrators",
        "symplectic_euler",
        "--engines",
        "rapier-forces,rapier",
        "--vary",
        "springs.stiffness=10..100:2",
        "--steps",
        "0.1..1:2",
        "--budget",
        "2400",
    ]);
    let engines = array(&report["stability"]["map"]["engines"]);
    assert_eq!(
        engines[0]["predicted_limit_s"],
        engines[1]["predicted_limit_s"]
    );
    assert_eq!(
        engines[2]["predicted_limit_s"],
        serde_json::json!([null, null])
    );
    let rows = array(&report["stability"]["rows"]);
    assert_eq!(rows[0]["predicted_limit_s"], rows[1]["predicted_limit_s"]);
    assert_eq!(rows[0]["measured_limit_s"], rows[1]["measured_limit_s"]);
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let run = |threads: &str| {
        let mut command = springcheck();
        command
            .args(["stability", "scenes/pa1/scene01.yml", "--format", "json"])
            .args(["--integrators", "rk4,symplectic_euler,implicit_euler"])
            .args(["--engines", "rapier"])
            .args(MAP)
            .env("RAYON_NUM_THREADS", threads);
        let (code, report, _) = answer(&mut command);
        assert_eq!(code, 0);
        program::without_times(program::report(&report))
    };
    let serial = run("1");
    assert_eq!(serial, run("4"));
}

#[test]
fn it_prints_a_table_and_writes_a_report() {
    let folder = tempfile::tempdir().expect("a folder");
    let args = ["stability", SCENE, "--output", word(folder.path())];
    let (code, table, err) = program::output(&[&args[..], &MAP].concat());
    assert_eq!(code, 0, "{err}");
    tidy(&table);
    for id in springcheck::integrators::ids(springcheck::integrators::fixed())
        .into_iter()
        .chain(["rapier"])
    {
        assert!(table.contains(id), "{id} in\n{table}");
    }
    let verdict = table.split("\n\n").nth(1).unwrap_or_default();
    assert!(verdict.contains("explicit_euler"), "{verdict}");
    let tail: Vec<&str> = table.lines().rev().take(2).collect();
    assert!(tail[0].starts_with("next: springcheck run "), "{}", tail[0]);
    assert!(tail[1].starts_with("report: ") && tail[1].ends_with("stability.md"));
    let place = folder.path().join("oscillator/circle");
    let expected = [
        "stability.html",
        "stability.json",
        "stability.md",
        "stability_map.svg",
    ];
    assert_eq!(files(&place), expected.map(String::from).into());
    well_formed(&place);
}

#[test]
fn usage_errors_exit_with_2_and_write_nothing() {
    let budget = [
        SCENE,
        "--vary",
        "springs.stiffness=1..9",
        "--budget",
        "1000",
    ];
    let cases: [(&[&str], &str); 14] = [
        (&[], "SCENE"),
        (&["missing.yml"], "missing.yml"),
        (
            &[SCENE, "--vary", "springs.stifness=1..9"],
            "did you mean `springs.stiffness`?",
        ),
        (&[SCENE, "--vary", "springs.stiffness=9..1"], "rises"),
        (
            &[SCENE, "--vary", "springs[7].stiffness=1..9"],
            "has 1 of these",
        ),
        (&[SCENE, "--steps", "1e-3..1"], "--vary"),
        (
            &[SCENE, "--vary", "springs.stiffness=1..9", "--steps", "0..1"],
            "--steps",
        ),
        (
            &[SCENE, "--vary", "springs.stiffness=1..9", "--budget", "1.5"],
            "whole number",
        ),
        (&budget, "fewer than 100 tell nothing"),
        (&[SCENE, "--admissible", "1"], "two free particles"),
        (&[SCENE, "--integrators", "rk5"], "symplectic_euler"),
        (&[SCENE, "--engines", "bullet"], "rapier-forces"),
        (&[SCENE, "--rapier", "dt=0.1"], "leave dt out"),
        (&[SCENE, "--timestep", "0"], "--timestep"),
    ];
    refuse("stability", &cases);
}

/// Long enough a text to fill no pipe's buffer before the reader has gone.
#[test]
fn a_reader_that_leaves_is_no_error() {
    let args = ["stability", SCENE, "--format", "markdown"];
    leave(&[&args[..], &["--integrators", "rk4", "--engines", "none"]].concat());
}

/// All remarks of an engine.
fn reason(scene: &str, engine: &str) -> String {
    let report = json(&[scene, "--engines", "none", "--integrators", engine]);
    let rows = array(&report["stability"]["rows"]);
    rows[0]["reason"].as_str().unwrap_or_default().to_owned()
}

#[test]
fn nobody_is_called_wrong_who_is_not() {
    // Linear forces, but a step that is not linear, and on the other scene one that is.
    let said = reason(
        "scenes/oscillator/circle.yml",
        "linearized_implicit_material",
    );
    assert!(said.contains("its step is not linear"), "{said}");
    for (scene, engine) in [
        (
            "scenes/oscillator/circle.yml",
            "linearized_implicit_material",
        ),
        (
            "scenes/oscillator/damped_under.yml",
            "linearized_implicit_material",
        ),
        ("scenes/hard/test_equation.yml", "yoshida4"),
        ("scenes/hard/test_equation.yml", "pefrl"),
    ] {
        let said = reason(scene, engine);
        assert!(!said.contains("is wrong"), "{scene} {engine}: {said}");
    }
}

#[test]
fn damping_alone_decays_under_substeps_backward_in_time() {
    let report = json(&[
        "scenes/hard/test_equation.yml",
        "--engines",
        "none",
        "--integrators",
        "yoshida4,pefrl",
    ]);
    for row in array(&report["stability"]["rows"]) {
        assert_eq!(row["measured_unconditional"], true, "{row}");
    }
}

/// Quadratic drag has no limit at rest, and 2 m/(2 c v) at the speed v = V tanh(g t/V) of a fall: the step at
/// which Euler's velocity changes its distance from V by the factor -1.
#[test]
fn a_limit_that_the_motion_brings_is_shown() {
    let scene = "scenes/effects/terminal_velocity.yml";
    let integrators = "rk4,explicit_euler,velocity_verlet";
    let args = [scene, "--engines", "none", "--integrators", integrators];
    let report = json(&args);
    let rows = array(&report["stability"]["rows"]);
    let euler = &rows[1];
    assert_eq!(euler["unconditional"], true);
    let terminal = (9.81_f64 / 0.05).sqrt();
    let speed = terminal * (9.81 * 5.0 / terminal).tanh();
    let found = number(&euler["tightest"]["limit_s"]);
    // The fall is rk4's: off by 5e-10 of V.
    assert!((found * 0.05 * speed - 1.0).abs() < 1e-9, "{found}");
    let said = euler["reason"].as_str().unwrap_or_default();
    assert!(said.contains("tightest at t = 5"), "{said}");
    // What does not run here is not called stable.
    let verlet = &rows[2];
    assert_eq!(verlet["unsupported"], true);
    assert_eq!(verlet["unconditional"], false);
    let (_, text, _) =
        program::output(&[&["stability"], &args[..], &["--output", "none"]].concat());
    assert!(text.contains("tightest on"), "{text}");
    let mut lines = text.lines();
    let line = lines.find(|line| line.contains("velocity_verlet"));
    assert!(
        line.is_some_and(|line| line.ends_with("unsupported")),
        "{text}"
    );
}
