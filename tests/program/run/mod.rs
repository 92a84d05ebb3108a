//! The program as its users run it.

mod bounces;
mod compare;
mod constraints;
mod contract;
mod errors;
mod saved;
mod truth;

use crate::testkit::program::{
    self, answer, array, files, json, leave, outcomes, output, springcheck, tidy, well_formed, word,
};
use serde_json::Value;

const SCENE: &str = "scenes/pa1/scene01.yml";

#[test]
fn a_run_prints_a_table_and_writes_a_report() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = word(folder.path());
    // On a loaded machine an announcement of the expected time is in order.
    let (code, table, err) = output(&["run", SCENE, "--output", out]);
    assert_eq!(code, 0, "{err}");
    tidy(&table);
    for id in [
        "symplectic_euler",
        "explicit_euler",
        "rapier",
        "rapier-forces",
        "gravity",
        "twin-joints",
    ] {
        assert!(table.contains(id), "{id} in\n{table}");
    }
    // The verdict is the first paragraph below the scene's.
    let verdict = table.split("\n\n").nth(1).unwrap_or_default();
    assert!(
        verdict.starts_with("symplectic_euler ") && verdict.ends_with("twin proof holds."),
        "{verdict}"
    );
    let remarks = table.lines().filter(|line| line.starts_with("- ")).count();
    assert!(
        remarks <= 6,
        "five remarks, and how many more there are: {table}"
    );
    let tail: Vec<&str> = table.lines().rev().take(2).collect();
    assert!(tail[0].starts_with("next: springcheck run "));
    assert!(tail[1].starts_with("report: ") && tail[1].ends_with("report.md"));
    let place = folder.path().join("pa1/scene01");
    let expected = [
        "energy.svg",
        "energy_error.svg",
        "error.svg",
        "phase.svg",
        "plot.svg",
        "report.html",
        "report.json",
        "report.md",
        "report.series",
        "trajectories.svg",
    ];
    assert_eq!(files(&place), expected.map(String::from).into());
    well_formed(&place);
}

#[test]
fn two_runs_and_any_number_of_threads_give_the_same_bits() {
    let run = |threads: &str| {
        let (_, report, _) = answer(
            springcheck()
                .args(["run", "scenes/pa1/scene03.yml", "--integrators", "all"])
                .args(["--duration", "0.5", "--format", "json"])
                .args(["--engines", "rapier,rapier-forces,rapier-converged"])
                .env("RAYON_NUM_THREADS", threads),
        );
        program::without_times(program::report(&report))
    };
    let serial = run("1");
    assert_eq!(serial, run("4"));
    assert_eq!(serial, run("3"));
}

#[test]
fn every_pa1_scene_runs_with_every_integrator_and_engine() {
    for number in 0..7 {
        let scene = format!("scenes/pa1/scene0{number}.yml");
        let report = json(&[
            "run",
            &scene,
            "--integrators",
            "all",
            "--duration",
            "0.1",
            "--engines",
            "rapier,rapier-forces,rapier-converged",
        ]);
        let outcomes = outcomes(&report);
        assert_eq!(outcomes.len(), springcheck::integrators::fixed().len() + 3);
        for outcome in outcomes {
            assert_eq!(
                outcome["status"], "completed",
                "{scene} {}",
                outcome["engine"]
            );
        }
        for check in report["checks"].as_array().expect("checks") {
            let twin = check["id"]
                .as_str()
                .is_some_and(|id| id.starts_with("twin"));
            assert!(!twin || check["status"] == "pass", "{scene} {check}");
        }
    }
}

#[test]
fn several_timesteps_and_several_scenes() {
    let args = [
        "run",
        SCENE,
        "--timestep",
        ".01,.05,.15",
        "--integrators",
        "rk4,midpoint",
    ];
    let report = json(&[&args[..], &["--engines", "none"]].concat());
    let found: Vec<(String, f64)> = outcomes(&report)
        .iter()
        .map(|o| {
            (
                o["engine"].as_str().unwrap().to_owned(),
                o["timestep"].as_f64().unwrap(),
            )
        })
        .collect();
    let wanted = ["rk4", "midpoint"].map(|id| [0.01, 0.05, 0.15].map(|h| (id.to_owned(), h)));
    assert_eq!(found, wanted.concat());
    let (_, both, _) = output(&[
        "run",
        SCENE,
        "scenes/pa1/scene00.yml",
        "--format",
        "json",
        "--duration",
        "0.1",
    ]);
    let both: Value = serde_json::from_str(&both).expect("JSON");
    assert_eq!(both["reports"].as_array().map(Vec::len), Some(2));
}

#[test]
fn a_custom_rapier_row_converges_to_implicit_euler() {
    let report = json(&[
        "run",
        "scenes/oscillator/oscillator.yml",
        "--integrators",
        "implicit_euler",
        "--engines",
        "none",
        "--rapier",
        "iterations=1,pgs=1",
        "--rapier",
        "dt=0.005,iterations=2",
    ]);
    let outcomes = outcomes(&report);
    let energy = |at: usize| outcomes[at]["energy"]["final_j"].as_f64().expect("J");
    // One substep of rapier is one step of implicit Euler, to 13 digits over 500 steps.
    let own = outcomes
        .iter()
        .position(|o| o["engine"] == "implicit_euler")
        .expect("there");
    let row = outcomes
        .iter()
        .position(|o| o["kind"] == "rapier")
        .expect("there");
    assert!((energy(own) / energy(row) - 1.0).abs() < 1e-11);
    assert_eq!(outcomes[row + 1]["substep"], 0.0025);
    // The same settings twice are one row.
    let twice = [
        "run",
        SCENE,
        "--duration",
        "0.01",
        "--engines",
        "none",
        "--rapier",
        "pgs=4",
    ];
    let report = json(&[&twice[..], &["--rapier", "pgs=4"]].concat());
    let rows = array(&report["outcomes"]).iter();
    assert_eq!(rows.filter(|o| o["engine"] == "rapier(pgs=4)").count(), 1);
}

#[test]
fn a_reader_that_leaves_is_no_error() {
    leave(&["list", "integrators"]);
}

#[test]
fn lists_show_every_row() {
    let rows: [(&str, Vec<&str>); 4] = [
        (
            "integrators",
            springcheck::integrators::ids(springcheck::integrators::fixed()),
        ),
        (
            "integrators",
            springcheck::integrators::ids(springcheck::integrators::pairs()),
        ),
        (
            "effects",
            springcheck::physics::effects::REGISTRY
                .iter()
                .map(|row| row.id)
                .collect(),
        ),
        ("engines", springcheck::solvers::rapier::IDS.to_vec()),
    ];
    for (what, ids) in rows {
        let (code, out, _) = output(&["list", what]);
        assert_eq!(code, 0);
        for id in ids {
            assert!(out.contains(id), "{id} in list {what}");
        }
        assert!(out.lines().all(|line| line.chars().count() <= 100));
    }
}

/// The remarks of rk4 on a scene of these lines.
fn remarks(lines: &str) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("scene.yml");
    std::fs::write(&file, lines).expect("a scene");
    let of = [
        "run",
        word(&file),
        "--engines",
        "none",
        "--integrators",
        "rk4",
    ];
    let report = json(&of);
    outcomes(&report)[0]["remarks"].to_string()
}

#[test]
fn steps_too_coarse_for_a_drive_are_said_to_be() {
    let scene = |h: f64| {
        format!(
            "solver: {{type: rk4, timestep: {h}}}\nduration: 1\nparticles: [{{pos: [0, 0, 0], fixed: true}}, \
             {{pos: [0, 0, -1], mass: 1}}]\nsprings: [{{particle_ids: [0, 1], stiffness: 50}}]\ndriven: \
             [{{particle_id: 0, sine: {{amplitude: [0, 0, 0.1], omega: 62.83185307179586}}}}]"
        )
    };
    // Ten periods a second: a fourth of each step and more.
    let said = remarks(&scene(0.025));
    assert!(
        said.contains("a period of 0.1 s, of which h = 0.025 s"),
        "{said}"
    );
    let said = remarks(&scene(0.01));
    assert!(!said.contains("period"), "{said}");
}

#[test]
fn a_hinge_without_a_direction_is_named() {
    let scene = |z: f64, rest: f64| {
        format!(
            "solver: {{type: rk4, timestep: 0.01, gravity: 0}}\nduration: 0.1\nparticles: [{{pos: [0, 0, 0], mass: 1}}, \
             {{pos: [1, 0, 0], mass: 1}}, {{pos: [2, 0, {z}], mass: 1}}]\nbending: [{{particle_ids: [0, 1, 2], \
             stiffness: 1, rest_angle: {rest}}}]"
        )
    };
    assert!(remarks(&scene(0.0, 1.5)).contains("hinge 0 is in line and not at its rest angle"));
    for (z, rest) in [(0.0, 0.0), (0.1, 1.5)] {
        assert!(!remarks(&scene(z, rest)).contains("hinge"));
    }
}
