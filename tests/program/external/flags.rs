//! What a program is told, and what of the flags is refused.

use super::{SCENE, run, saved, theirs};
use crate::testkit::program::{self, altered, outcomes, output, refuse_all, word};
use serde_json::Value;
use std::path::Path;

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).expect("a file")).expect("JSON")
}

#[test]
fn placeholders_carry_the_scene_and_the_flags() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = folder.path().join("my scene.yml");
    let yaml = "solver: {type: rk4, timestep: 0.1, gravity: -2}
up: y
damping_model: isotropic
particles:
- {pos: [0.1, 0, 0], fixed: true, mass: 3}
- {pos: [1, 2, 3], vel: [4, 5, 6], mass: 0.3, drag: 0.7, charge: -0.2}
springs: [{particle_ids: [1, 0], stiffness: 20, cubic: 3, damping: 0.5, rest_length: 0.4}]
gravitational: [{particle_ids: [0, 1], G: 1.5}]
wind: {direction: [0, 0, 2], strength: 3}
magnetic: {field: [1, 0, 2]}
";
    std::fs::write(&scene, yaml).expect("written");
    // The program writes down its arguments, each on a line, and keeps the JSON.
    let script = "printf '%s\\n' \"$@\" > \"$0/$2\"; cp \"$4\" \"$0/$2.json\"; echo \"$5\" >&2";
    let out = folder.path().display();
    let command = format!(
        "p=sh -c '{}' '{out}' {{scene}} {{timestep}} {{duration}} {{scene_json}} 'two  words' \
         h={{timestep}} {{{{}}}}",
        script.replace('\'', "'\\''")
    );
    let path = word(&scene);
    let (report, err) = run(
        path,
        &command,
        &["--timestep", "0.05,0.1", "--duration", "0.75"],
    );
    // Once for each timestep, after all others, and its stderr as it came.
    let rows: Vec<_> = outcomes(&report)
        .iter()
        .map(|o| (o["engine"].as_str().expect("an id"), o["timestep"].as_f64()))
        .collect();
    assert_eq!(rows[4..], [("p", Some(0.05)), ("p", Some(0.1))]);
    assert_eq!(err, "two  words\ntwo  words\n");

    let text = std::fs::read_to_string(folder.path().join("0.05")).expect("arguments");
    let arguments: Vec<&str> = text.lines().collect();
    assert_eq!(arguments[..3], [path, "0.05", "0.75"]);
    assert_eq!(arguments[4..], ["two  words", "h=0.05", "{}"]);
    // What was made for the run is gone with it.
    assert!(arguments[3].ends_with("scene.json"));
    assert!(!Path::new(arguments[3]).exists());
    assert!(!Path::new(arguments[3]).parent().expect("a folder").exists());

    let flat = json(&folder.path().join("0.05.json"));
    let wanted = serde_json::json!({
        "schema_version": 1,
        "particles": 2,
        "positions": [0.1, 0.0, 0.0, 1.0, 2.0, 3.0],
        "velocities": [0.0, 0.0, 0.0, 4.0, 5.0, 6.0],
        "masses": [3.0, 0.3],
        "fixed": [true, false],
        "springs": {
            "ids": [1, 0],
            "stiffness": [20.0],
            "cubic": [3.0],
            "damping": [0.5],
            "rest_lengths": [0.4],
        },
        "rods": {"ids": [], "lengths": []},
        "bending": {"ids": [], "stiffness": [], "rest_angles": [], "damping": []},
        "driven": {
            "ids": [],
            "velocities": [],
            "rows": [],
            "tables": [],
            "amplitudes": [],
            "omegas": [],
            "phases": [],
        },
        "damping_model": "isotropic",
        "gravity": [0.0, -2.0, 0.0],
        "drag": [0.0, 0.7],
        "quadratic_drag": [0.0, 0.0],
        "charges": [0.0, -0.2],
        "magnetic_field": [1.0, 0.0, 2.0],
        "wind_force": [0.0, 0.0, 3.0],
        "air_velocity": [0.0, 0.0, 0.0],
        "air_density": 1.2,
        "triangles": {"ids": [], "air_drag": []},
        "gravitational": {"ids": [0, 1], "g": [1.5]},
        "effects": ["gravity", "springs", "cubic_springs", "drag", "wind", "gravitational", "magnetic"],
        "timestep": 0.05,
        "duration": 0.75,
        "steps": 15,
    });
    assert_eq!(flat, wanted);
    assert_eq!(json(&folder.path().join("0.1.json"))["steps"], 8);
}

#[test]
fn rows_may_be_sparse_without_velocities_or_longer_than_asked() {
    let folder = tempfile::tempdir().expect("a folder");
    let every = saved(folder.path(), "1");
    let whole = run(SCENE, &format!("p=cat '{}'", every.display()), &[]).0;
    let (ours, copy) = (&outcomes(&whole)[0], theirs(&whole));
    // The file's numbers read back to the same bits: the same run in everything but its work.
    for key in ["status", "energy", "momentum"] {
        assert_eq!(copy[key], ours[key], "{key}");
    }
    assert_eq!(copy["deviation_m"]["rapier-forces"]["max"], 0.0);

    let sparse = folder.path().join("sparse");
    let sparse = saved(&sparse, "7");
    let report = run(SCENE, &format!("p=cat '{}'", sparse.display()), &[]).0;
    let outcome = theirs(&report);
    assert_eq!(outcome["status"], "completed", "{outcome}");
    assert_eq!(outcome["energy"]["final_j"], ours["energy"]["final_j"]);
    assert_eq!(outcome["deviation_m"]["rapier-forces"]["max"], 0.0);

    let bare = altered(&every, "bare.csv", |_, fields| fields.truncate(5));
    let args = [
        "run",
        SCENE,
        "--integrators",
        "symplectic_euler",
        "--external",
    ];
    let command = format!("p=cat '{}'", bare.display());
    let out = folder.path().join("reports");
    let out = ["--output", word(&out)];
    let (code, table, err) = output(&[&args[..], &[&command], &out].concat());
    assert_eq!(code, 0, "{err}");
    assert!(table.contains("no velocities"), "{table}");
    let place = folder.path().join("reports/oscillator/circle");
    let report = std::fs::read_to_string(place.join("report.json")).expect("a report");
    let outcome = theirs(&program::report(&report)).clone();
    assert_eq!(outcome["status"], "completed");
    assert_eq!(outcome["energy"], Value::Null);
    assert_eq!(outcome["deviation_m"]["rapier-forces"]["max"], 0.0);
    // It is drawn where it was.
    let figure = std::fs::read_to_string(place.join("trajectories.svg")).expect("a figure");
    assert!(figure.contains(">p<"), "{figure}");

    // The first 100 steps of a program that goes on to 500.
    let command = format!("p=cat '{}'", every.display());
    let report = run(SCENE, &command, &["--duration", "1"]).0;
    assert_eq!(theirs(&report)["status"], "completed");
    assert_eq!(theirs(&report)["work"]["steps"], 100);
    assert_eq!(theirs(&report)["energy"], outcomes(&report)[0]["energy"]);
}

#[test]
fn wrong_flags_exit_with_2_before_anything_runs() {
    let folder = tempfile::tempdir().expect("a folder");
    let mark = folder.path().join("started");
    let touch = format!("touch {}", mark.display());
    let flag = |name: &str, rest: &str| format!("{name}={touch}{rest}");
    let cases: [(&[String], &str); 9] = [
        (std::slice::from_ref(&touch), "NAME=COMMAND"),
        (&["p=".to_owned()], "expected a command"),
        (&[flag("p", " {yaml}")], "{scene_json}"),
        (&[flag("p", " {scene")], "brace"),
        (&[flag("p", " 'x")], "quote"),
        (&[flag("a/b", "")], "name"),
        (&[flag("rapier-forces", "")], "has this name"),
        (&[flag("rk4", "")], "has this name"),
        (&[flag("p", ""), flag("p", "")], "twice"),
    ];
    for (flags, says) in cases {
        let mut args = vec!["run", SCENE, "--format", "json"];
        for flag in flags {
            args.extend(["--external", flag]);
        }
        refuse_all(&args, &[says]);
    }
    let p = flag("p", "");
    for time in ["0", "soon", "-1s"] {
        let timeout = format!("--external-timeout={time}");
        refuse_all(&["run", SCENE, "--external", &p, &timeout], &[time]);
    }
    refuse_all(&["run", SCENE, "--external-timeout", "5s"], &["--external"]);
    assert!(!mark.exists());
}
