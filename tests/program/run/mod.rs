//! The program as its users run it.

mod compare;
mod contract;
mod errors;
mod saved;
mod truth;

use assert_cmd::Command;
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;

fn springcheck() -> Command {
    let mut command = Command::cargo_bin("springcheck").expect("the binary");
    command.current_dir(env!("CARGO_MANIFEST_DIR"));
    // Not the user's.
    command.env(
        "SPRINGCHECK_CACHE",
        concat!(env!("CARGO_TARGET_TMPDIR"), "/cache"),
    );
    command
}

const SCENE: &str = "scenes/pa1/scene01.yml";

fn output(args: &[&str]) -> (i32, String, String) {
    let output = springcheck().args(args).output().expect("it runs");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8");
    let code = output.status.code().expect("no signal");
    (code, text(output.stdout), text(output.stderr))
}

fn json(args: &[&str]) -> Value {
    let (code, out, err) = output(args);
    assert_eq!(code, 0, "{err}");
    report(&out)
}

/// The one report of a JSON text.
fn report(text: &str) -> Value {
    let mut document: Value = serde_json::from_str(text).expect("JSON");
    assert_eq!(document["schema_version"], 2);
    assert_eq!(document["reports"].as_array().map(Vec::len), Some(1));
    document["reports"][0].take()
}

/// The exit code beside what stands on stdout.
fn json_of(args: &[&str]) -> (i32, Value) {
    let (code, out, err) = output(args);
    assert!(!out.is_empty(), "{err}");
    (code, report(&out))
}

fn keys(value: &Value) -> BTreeSet<&str> {
    let object = value.as_object().expect("an object");
    object.keys().map(String::as_str).collect()
}

fn set<'a>(keys: &[&'a str]) -> BTreeSet<&'a str> {
    keys.iter().copied().collect()
}

fn files(folder: &Path) -> BTreeSet<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    entries
        .map(|entry| {
            entry
                .expect("an entry")
                .file_name()
                .to_string_lossy()
                .into_owned()
        })
        .collect()
}

#[test]
fn a_run_prints_a_table_and_writes_a_report() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().to_str().expect("UTF-8");
    // Quiet: on a loaded machine an announcement of the expected time is in order.
    let (code, table, err) = output(&["run", SCENE, "--output", out, "--quiet"]);
    assert_eq!((code, err.as_str()), (0, ""));
    for line in table.lines() {
        assert!(line.chars().count() <= 100, "{line}");
    }
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
    assert!(!table.contains('\u{1b}'), "colour in a pipe");
    let tail: Vec<&str> = table.lines().rev().take(3).collect();
    assert!(tail[0].starts_with("next: springcheck run "));
    assert!(tail[1].starts_with("report: ") && tail[1].ends_with("report.md"));
    assert!(tail[2].contains("twin proof"), "{}", tail[2]);
    let place = folder.path().join("pa1/scene01");
    let expected = [
        "energy.svg",
        "plot.svg",
        "report.json",
        "report.md",
        "report.series",
        "trajectories.svg",
    ];
    assert_eq!(files(&place), expected.map(String::from).into());
    for name in files(&place)
        .iter()
        .filter(|name| !name.ends_with(".series"))
    {
        let text = std::fs::read_to_string(place.join(name)).expect("text");
        assert!(!text.contains("NaN") && !text.contains("inf "), "{name}");
    }
}

/// The report without what may vary.
fn without_times(mut report: Value) -> Value {
    for outcome in report["outcomes"].as_array_mut().expect("outcomes") {
        outcome["work"]["wall_s"] = Value::Null;
    }
    for effect in report["scene"]["effects"].as_array_mut().expect("effects") {
        effect["wall_ns"] = Value::Null;
    }
    report
}

#[test]
fn two_runs_and_any_number_of_threads_give_the_same_bits() {
    let run = |threads: &str| {
        let output = springcheck()
            .args([
                "run",
                "scenes/pa1/scene03.yml",
                "--integrators",
                "all",
                "--duration",
                "0.5",
            ])
            .args([
                "--engines",
                "rapier,rapier-forces,rapier-converged",
                "--format",
                "json",
            ])
            .env("RAYON_NUM_THREADS", threads)
            .output()
            .expect("it runs");
        without_times(report(&String::from_utf8_lossy(&output.stdout)))
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
            "--format",
            "json",
            "--engines",
            "rapier,rapier-forces,rapier-converged",
        ]);
        let outcomes = report["outcomes"].as_array().expect("outcomes");
        assert_eq!(outcomes.len(), springcheck::integrators::REGISTRY.len() + 3);
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
    let report = json(&[&args[..], &["--format", "json", "--engines", "none"]].concat());
    let found: Vec<(String, f64)> = report["outcomes"]
        .as_array()
        .expect("outcomes")
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
        "--format",
        "json",
        "--integrators",
        "implicit_euler",
        "--engines",
        "none",
        "--rapier",
        "iterations=1,pgs=1",
        "--rapier",
        "dt=0.005,iterations=2",
    ]);
    let outcomes = report["outcomes"].as_array().expect("outcomes");
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
    let report = json(&[&twice[..], &["--rapier", "pgs=4", "--format", "json"]].concat());
    let rows = report["outcomes"].as_array().expect("outcomes").iter();
    assert_eq!(rows.filter(|o| o["engine"] == "rapier(pgs=4)").count(), 1);
}

#[test]
fn a_reader_that_leaves_is_no_error() {
    use std::process::{Command, Stdio};
    let mut child = Command::new(assert_cmd::cargo::cargo_bin("springcheck"))
        .args(["list", "integrators"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it starts");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("it ends");
    assert!(
        output.stderr.is_empty(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    assert_eq!(output.status.code(), Some(0));
}

#[test]
fn lists_show_every_row() {
    let rows: [(&str, Vec<&str>); 4] = [
        ("integrators", springcheck::integrators::ids()),
        ("integrators", springcheck::integrators::adaptive::ids()),
        (
            "effects",
            springcheck::effects::REGISTRY
                .iter()
                .map(|row| row.id)
                .collect(),
        ),
        (
            "engines",
            vec!["rapier", "rapier-forces", "rapier-converged"],
        ),
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
