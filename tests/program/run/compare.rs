//! `compare`: trajectories come back as what they are, and what is wrong with them is found.

use crate::testkit::program::{
    altered, find, json_of, keys, outcomes, output, refuse_all, set, tidy, with_fields, word,
};
use crate::testkit::scenes::parsed;
use serde_json::Value;
use std::path::{Path, PathBuf};

const SCENE: &str = "scenes/pa1/scene04.yml";
const METHODS: &str = "explicit_euler,symplectic_euler,midpoint,velocity_verlet,rk4,implicit_euler";

/// Runs the scene for half a second and saves every `every`-th step; the report and the folder.
fn saved(folder: &Path, kind: &str, every: &str) -> (Value, PathBuf) {
    let out = word(folder);
    let (code, report) = json_of(&[
        "run",
        SCENE,
        "--duration",
        "0.5",
        "--integrators",
        METHODS,
        "--engines",
        "none",
        "--save",
        kind,
        "--every",
        every,
        "--output",
        out,
    ]);
    assert_eq!(code, 0);
    (report, folder.join("pa1/scene04"))
}

fn compared(file: &Path, more: &[&str]) -> (i32, Value) {
    json_of(&[&["compare", word(file), "--scene", SCENE], more].concat())
}

/// The file of one method with the fields of its rows changed.
fn changed(file: &Path, change: impl Fn(usize, &mut Vec<String>)) -> PathBuf {
    altered(file, "changed.csv", change)
}

/// The time of a row; none of the header.
fn time(fields: &[String]) -> Option<f64> {
    fields[0].parse().ok()
}

#[test]
fn what_run_saves_comes_back_as_itself() {
    for (kind, every) in [("npz", "1"), ("csv", "1"), ("npz", "7")] {
        let folder = tempfile::tempdir().expect("a folder");
        let (report, place) = saved(folder.path(), kind, every);
        for ran in outcomes(&report) {
            let method = ran["engine"].as_str().expect("an id");
            let (code, back) = compared(&place.join(format!("{method}@0.0005.{kind}")), &[]);
            let found = &back["outcomes"][0];
            let identified = &found["identified"];
            let what = format!("{method}, every {every} as {kind}: {identified:#}");
            assert_eq!(code, 0, "{what}");
            assert_eq!(identified["method"], method, "{what}");
            assert_eq!(identified["substeps"], 1, "{what}");
            assert_eq!(identified["decisive"], true, "{what}");
            assert!(back["fault"].is_null(), "{what}");
            if every == "1" {
                // The same numbers, to the last bit; so a replay has nothing to explain.
                assert_eq!(identified["defect"], 0.0, "{what}");
                for key in ["position_error_m", "velocity_error_m_s"] {
                    assert_eq!(found[key], ran[key], "{what}");
                }
            }
        }
    }
}

#[test]
fn comparisons_have_the_contracts_keys() {
    let folder = tempfile::tempdir().expect("a folder");
    let (_, place) = saved(folder.path(), "csv", "1");
    let file = place.join("rk4@0.0005.csv");
    let (_, clean) = compared(&file, &[]);
    assert_eq!(
        keys(&clean),
        set(&[
            "verb", "series", "scene", "truth", "outcomes", "checks", "advice", "verdict",
            "remarks", "fault"
        ])
    );
    assert_eq!(
        keys(&clean["outcomes"][0]["identified"]),
        set(&[
            "method",
            "substeps",
            "says",
            "defect",
            "relative",
            "runner_up",
            "runner_up_defect",
            "decisive",
            "equivalent",
            "undecided",
            "left_out"
        ])
    );
    assert_eq!(clean["outcomes"][0]["kind"], "external");
    assert!(clean["outcomes"][0]["work"]["wall_s"].is_null());
    let (code, faulty) = compared(&doubled(&file), &[]);
    assert_eq!(code, 1);
    assert_eq!(
        keys(&faulty["fault"]),
        set(&[
            "step",
            "t_s",
            "particle",
            "quantity",
            "expected",
            "found",
            "explanation"
        ])
    );
}

/// Particle 3's vz after step 400 doubled, which particles 2 to 4 feel from step 400 on.
fn doubled(file: &Path) -> PathBuf {
    changed(file, |_, fields| {
        if fields[1] == "3" && time(fields).is_some_and(|t| (t - 0.2).abs() < 1e-9) {
            let v: f64 = fields[7].parse().expect("a number");
            fields[7] = format!("{:?}", 2.0 * v);
        }
    })
}

#[test]
fn the_first_fault_is_named_by_step_and_particle() {
    let folder = tempfile::tempdir().expect("a folder");
    let (_, place) = saved(folder.path(), "csv", "1");
    let (code, report) = compared(&doubled(&place.join("rk4@0.0005.csv")), &[]);
    assert_eq!(code, 1);
    assert_eq!(report["outcomes"][0]["identified"]["method"], "rk4");
    // Row 400, at t = 0.2 s, is the end of step 399.
    assert_eq!(report["fault"]["step"], 399, "{:#}", report["fault"]);
    assert_eq!(report["fault"]["particle"], 3, "{:#}", report["fault"]);
    assert_eq!(report["fault"]["quantity"], "velocity_m_s");
}

#[test]
fn positions_alone_name_the_scheme() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = word(folder.path());
    // Coarse steps, in which the schemes differ by more than positions are rounded.
    let (code, _) = json_of(&[
        "run",
        SCENE,
        "--timestep",
        "0.02",
        "--duration",
        "1",
        "--integrators",
        "rk4",
        "--engines",
        "none",
        "--save",
        "csv",
        "--output",
        out,
    ]);
    assert_eq!(code, 0);
    let file = folder.path().join("pa1/scene04/rk4@0.02.csv");
    let file = changed(&file, |_, fields| fields.truncate(5));
    let (code, report) = compared(&file, &["--timestep", "0.02"]);
    let outcome = &report["outcomes"][0];
    assert_eq!(outcome["identified"]["method"], "rk4", "{outcome:#}");
    assert_eq!(code, 0, "{outcome:#}");
    assert!(outcome["energy"].is_null() && outcome["velocity_error_m_s"].is_null());
    assert!(!outcome["position_error_m"].is_null());
}

#[test]
fn what_no_scheme_explains_is_undecided() {
    let folder = tempfile::tempdir().expect("a folder");
    let (_, place) = saved(folder.path(), "csv", "1");
    // A limp in every step: vx a thousandth larger.
    let file = changed(&place.join("rk4@0.0005.csv"), |at, fields| {
        if let Ok(v) = fields[5].parse::<f64>() {
            fields[5] = format!("{:?}", v * (1.0 + 1e-3 * (at as f64).sin()));
        }
    });
    let (code, report) = compared(&file, &[]);
    assert_eq!(code, 3, "{report:#}");
    assert!(report["outcomes"][0]["identified"].is_null());
    let explained = &report["outcomes"][0]["explained"];
    assert!(explained["scheme"].is_null(), "{explained:#}");
    assert!(report["fault"].is_null());
}

#[test]
fn the_step_can_be_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let (_, place) = saved(folder.path(), "csv", "2");
    let file = place.join("symplectic_euler@0.0005.csv");
    // Rows two steps apart, read as steps of their own: two substeps.
    let (code, report) = compared(&file, &["--timestep", "0.001"]);
    let identified = &report["outcomes"][0]["identified"];
    assert_eq!(
        (code, &identified["method"]),
        (0, &"symplectic_euler".into())
    );
    assert_eq!(identified["substeps"], 2, "{identified:#}");
    let (code, _, err) = output(&[
        "compare",
        word(&file),
        "--scene",
        SCENE,
        "--timestep",
        "0.0007",
    ]);
    assert_eq!(code, 2);
    assert!(err.contains("symplectic_euler@0.0005.csv:"), "{err}");
}

#[test]
fn the_table_says_who_it_is_and_what_is_wrong() {
    let folder = tempfile::tempdir().expect("a folder");
    let (_, place) = saved(folder.path(), "csv", "1");
    let file = doubled(&place.join("midpoint@0.0005.csv"));
    let file = word(&file);
    let out = folder.path().join("reports");
    let (code, table, err) = output(&["compare", file, "--scene", SCENE, "--output", word(&out)]);
    assert_eq!((code, err.as_str()), (1, ""));
    tidy(&table);
    for part in [
        "midpoint",
        "step 399",
        "particle 3",
        "expected",
        "found",
        "report: ",
    ] {
        assert!(table.contains(part), "{part} in\n{table}");
    }
    refuse_all(&["compare", "no such file", "--scene", SCENE], &[]);
}

#[test]
fn what_is_fixed_must_not_move() {
    let folder = tempfile::tempdir().expect("a folder");
    let (_, place) = saved(folder.path(), "csv", "1");
    let file = changed(&place.join("rk4@0.0005.csv"), |_, fields| {
        if fields[1] == "1" && time(fields).is_some_and(|t| t > 0.0999) {
            fields[2] = "0.001".to_owned();
        }
    });
    let (code, report) = compared(&file, &[]);
    let fault = &report["fault"];
    assert_eq!(code, 1);
    // Row 200, at t = 0.1 s, is the end of step 199.
    assert_eq!(
        (&fault["step"], &fault["particle"]),
        (&199.into(), &1.into())
    );
    assert!(
        fault["explanation"]
            .as_str()
            .is_some_and(|e| e.contains("fixed in the scene"))
    );
}

/// A row as it would be so many seconds later.
fn later(fields: &mut [String], seconds: f64) {
    if let Some(t) = time(fields) {
        fields[0] = format!("{:?}", t + seconds);
    }
}

#[test]
fn rows_that_begin_late_are_judged_from_the_start() {
    let folder = tempfile::tempdir().expect("a folder");
    let (_, place) = saved(folder.path(), "csv", "1");
    let file = place.join("rk4@0.0005.csv");
    // Without the first instant it is what it was.
    let late = changed(&file, |_, fields| {
        if fields[0] == "0.0" {
            fields.clear();
        }
    });
    let (code, report) = compared(&late, &[]);
    assert_eq!(code, 0, "{:#}", report["fault"]);
    // Every state under the time of the next: the first step stands still.
    let shifted = changed(&file, |_, fields| later(fields, 0.0005));
    let (code, report) = compared(&shifted, &[]);
    assert_eq!((code, &report["fault"]["step"]), (1, &0.into()));
}

#[test]
fn what_a_file_follows_early_need_not_be_what_it_follows() {
    let folder = tempfile::tempdir().expect("a folder");
    let (_, place) = saved(folder.path(), "csv", "1");
    // A tenth of the rows by one scheme, then another's from there: gravity lost at step 100.
    let scene = std::fs::read_to_string(SCENE).expect("a shipped scene");
    let weightless = folder.path().join("scene04.yml");
    let first = std::fs::read_to_string(place.join("symplectic_euler@0.0005.csv")).expect("saved");
    let head: Vec<&str> = first.lines().take(1 + 5 * 101).collect();
    // The scene again, without gravity, from where the first part ends.
    let states: Vec<Vec<&str>> = head[head.len() - 5..]
        .iter()
        .map(|l| l.split(',').collect())
        .collect();
    let mut weightless_text =
        scene.replace("  timestep: 0.0005", "  timestep: 0.0005\n  gravity: 0");
    let from = weightless_text.find("particles:").expect("particles");
    let to = weightless_text.find("springs:").expect("springs");
    let particles: String = states
        .iter()
        .enumerate()
        .map(|(id, s)| {
            let fixed = if id < 2 { "true" } else { "false" };
            let v = if id < 2 {
                "0, 0, 0".to_owned()
            } else {
                s[5..8].join(", ")
            };
            format!(
                "  - {{pos: [{}], vel: [{v}], fixed: {fixed}, mass: 0.1}}\n",
                s[2..5].join(", ")
            )
        })
        .collect();
    weightless_text.replace_range(from..to, &format!("particles:\n{particles}\n"));
    // Rest lengths are those of the scene as it begins.
    for length in parsed(&scene).springs.iter().map(|s| s.rest_length) {
        weightless_text = weightless_text.replacen(
            "damping: 0.01}",
            &format!("damping: 0.0100, rest_length: {length:?}}}"),
            1,
        );
    }
    std::fs::write(&weightless, weightless_text).expect("written");
    let out = folder.path().join("later");
    let (code, _) = json_of(&[
        "run",
        word(&weightless),
        "--duration",
        "0.45",
        "--integrators",
        "symplectic_euler",
        "--engines",
        "none",
        "--save",
        "csv",
        "--output",
        word(&out),
    ]);
    assert_eq!(code, 0);
    let second = find(&out, "symplectic_euler@0.0005.csv");
    let second = std::fs::read_to_string(second).expect("saved");
    let tail = with_fields(&second, |_, fields| later(fields, 0.05));
    let tail = tail.lines().skip(1 + 5);
    let joined: Vec<&str> = head.iter().copied().chain(tail).collect();
    let file = folder.path().join("joined.csv");
    std::fs::write(&file, joined.join("\n")).expect("written");
    let (code, report) = compared(&file, &[]);
    assert_eq!(code, 1, "{:#}", report["outcomes"][0]["identified"]);
    assert_eq!(
        report["outcomes"][0]["identified"]["method"],
        "gravity_forgotten(symplectic_euler)"
    );
    assert_eq!(report["fault"]["step"], 100);
}

/// A pendulum in the plane of y and z, as a program in two dimensions writes it, and without its last line
/// end, cut inside its last number.
#[test]
fn data_of_a_plane_needs_the_flag_and_half_a_number_is_left_out() {
    let scene = "scenes/pa1/scene05.yml";
    let folder = tempfile::tempdir().expect("a folder");
    let out = word(folder.path());
    let run = ["run", scene, "--duration", "0.1", "--integrators", "rk4"];
    let save = ["--engines", "none", "--save", "csv", "--output", out];
    assert_eq!(output(&[&run[..], &save].concat()).0, 0);
    let saved = folder.path().join("pa1/scene05/rk4@0.0005.csv");
    // t,id,x,y,z,vx,vy,vz
    let flat = |line: &str| {
        let fields: Vec<&str> = line.split(',').collect();
        [0, 1, 3, 4, 6, 7].map(|at| fields[at]).join(",")
    };
    let text = std::fs::read_to_string(saved).expect("a trajectory");
    let text: Vec<String> = text.lines().map(flat).collect();
    let text = text.join("\n") + "\n";
    let file = folder.path().join("flat.csv");
    let compare = |text: &str, more: &[&str]| {
        std::fs::write(&file, text).expect("written");
        let args = ["compare", word(&file), "--scene", scene, "--format", "json"];
        output(&[&args, more].concat())
    };
    let (code, report, _) = compare(&text, &["--axes", "yz"]);
    assert!(code == 0 && report.contains("\"rk4\""), "{report}");
    let (code, _, error) = compare(&text, &[]);
    assert!(code == 2 && error.contains("--axes"), "{error}");
    let (code, _, error) = compare(&text, &["--axes", "xy"]);
    assert!(code == 2 && error.contains("along z"), "{error}");
    let (code, report, _) = compare(&text[..text.len() - 9], &["--axes", "yz"]);
    assert!(
        code == 0 && report.contains("its last row is left out"),
        "{report}"
    );
}
