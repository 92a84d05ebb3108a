//! Scenes at the edge, and the same scene twice.

use super::keys::keep_the_contract;
use super::*;

/// Two values of a report, and what of it the contract lets differ taken out: keys of times, and what they
/// choose.
pub fn without_the_clock(value: &mut Value) {
    match value {
        Value::Array(values) => values.iter_mut().for_each(without_the_clock),
        Value::Object(map) => {
            for key in [
                "wall_s",
                "wall_ns",
                "wall_median_s",
                "wall_ratio",
                "extrapolated_wall_ratio",
                "cheapest",
                "verdict",
                "advice",
            ] {
                map.remove(key);
            }
            if let Some(Value::Array(ranking)) = map.get_mut("ranking") {
                ranking.sort_by_key(|rank| rank["engine"].to_string());
            }
            map.values_mut().for_each(without_the_clock);
        }
        _ => {}
    }
}

#[test]
fn two_runs_are_equal_but_for_the_clock() {
    let run = |threads: &str| {
        let mut command = springcheck();
        command.args(["cost", "scenes/pa1/scene01.yml", "--format", "json"]);
        command.args(SMALL).env("RAYON_NUM_THREADS", threads);
        let (code, report, _) = answer(&mut command);
        assert_eq!(code, 0);
        let mut report = program::report(&report);
        let clock = report.to_string();
        without_the_clock(&mut report);
        (clock, report.to_string())
    };
    let (one, four) = (run("1"), run("4"));
    assert_eq!(one.1, four.1);
    // Times to the nanosecond: that all of them agree would mean that nothing is timed.
    assert_ne!(one.0, four.0);
}

#[test]
fn all_may_diverge() {
    // h w = 1e3 and 2e3: each step multiplies amplitudes by about that.
    let folder = tempfile::tempdir().expect("a folder");
    let file = scene(
        &folder,
        "solver: {type: explicit_euler, timestep: 0.01, gravity: 0}\n\
         particles: [{pos: [0, 0, 0], fixed: true}, {pos: [0, 0, 1], mass: 1}]\n\
         springs: [{particle_ids: [0, 1], stiffness: 1.e+10, rest_length: 0}]\n",
    );
    let out = folder.path().join("out");
    let out = word(&out);
    let who = ["--integrators", "explicit_euler,rk4", "--engines", "none"];
    let args = [&[&file, "--timestep", ".01,.02"][..], &who].concat();
    let report = json(&args);
    keep_the_contract(&report);
    let points = curves(&report).iter().flat_map(|c| array(&c["points"]));
    assert!(points.clone().all(|point| point["status"] == "diverged"));
    for target in array(&report["cost"]["targets"]) {
        assert!(target["cheapest"].is_null());
    }
    let (code, table, err) = output(&[&args[..], &["--output", out]].concat());
    assert_eq!((code, err.as_str()), (0, ""));
    tidy(&table);
    let said =
        "\nno integrator reaches 1e-3 and 1e-6 m; nobody can be said to reach 1e-9 m: below the";
    assert!(table.contains(said), "{table}");
    assert!(table.contains("diverged at every setting"), "{table}");
    assert!(table.ends_with("\nnext: springcheck cost --help\n"));
}

#[test]
fn rest_one_particle_and_no_springs_have_answers() {
    let solver = "solver: {type: rk4, timestep: 0.01, gravity:";
    let rest = "particles: [{pos: [0, 0, 0], fixed: true}, {pos: [0, 0, 1], mass: 1}]\n\
                springs: [{particle_ids: [0, 1], stiffness: 10, rest_length: 1}]\n";
    let one = "particles: [{pos: [0, 0, 1], mass: 1, vel: [1, 0, 0]}]\nsprings: []\n";
    let free =
        "particles: [{pos: [0, 0, 1], mass: 1}, {pos: [1, 0, 1], mass: 2, vel: [1, 0, 0]}]\n";
    for (gravity, text) in [("0", rest), ("-9.81", one), ("0", one), ("-9.81", free)] {
        let folder = tempfile::tempdir().expect("a folder");
        let file = scene(&folder, &format!("{solver} {gravity}}}\n{text}"));
        let report = small(&[&file]);
        keep_the_contract(&report);
        for curve in curves(&report) {
            let points = array(&curve["points"]);
            let completed = points.iter().all(|p| p["status"] == "completed");
            assert!(completed, "{} {text}", curve["engine"]);
        }
        // rk4 is exact for a parabola, and everybody for rest and for straight lines.
        for target in array(&report["cost"]["targets"]) {
            let ranks = array(&target["ranking"]).iter();
            let rk4 = ranks.filter(|rank| rank["engine"] == "rk4");
            assert!(rk4.clone().all(|rank| !rank["reached"].is_null()), "{text}");
        }
        let out = folder.path().join("out");
        let flags = ["--output", word(&out)];
        let (code, table, err) = output(&[&[&file[..]][..], &SMALL, &flags].concat());
        assert_eq!((code, err.as_str()), (0, ""));
        tidy(&table);
    }
}

/// What is said to try next is a command that runs, also where flags shortened the run.
#[test]
fn the_next_command_runs() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = word(folder.path());
    for flags in [
        &["--duration", "1e-9"][..],
        &["--duration", "0.015"],
        &["--duration", "1e-9", "--timestep", "1e-10"],
        &["--duration", "2", "--timestep", ".1,.01"],
    ] {
        let budget = if flags.contains(&"--timestep") {
            &SMALL[4..]
        } else {
            &SMALL[..]
        };
        let args = [&[SCENE, "--output", out, "--engines", "none"][..], flags].concat();
        let (code, table, err) = output(&[&args[..], budget].concat());
        assert_eq!((code, err.as_str()), (0, ""), "{flags:?}");
        let next = table.lines().last().expect("lines");
        let next = next.strip_prefix("next: springcheck ").expect("a command");
        let mut command = springcheck();
        command.args(next.split(' '));
        command.args(["--engines", "none", "--output", out]);
        let (code, _, err) = answer(&mut command);
        assert_eq!(code, 0, "{next}: {err}");
    }
}
