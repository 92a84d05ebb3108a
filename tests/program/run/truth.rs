//! The truth in reports, and the cache behind it.

use crate::testkit::program::{self, answer, json, json_of, springcheck, word};
use serde_json::Value;
use std::path::Path;

const CHAOTIC: &str = "scenes/pa1/scene03.yml";

#[test]
fn content_decides_which_truth_a_scene_has() {
    for (scene, kind) in [
        ("scenes/pa1/scene00.yml", "closed_form"),
        ("scenes/pa1/scene01.yml", "closed_form"),
        ("scenes/pa1/scene02.yml", "closed_form"),
        ("scenes/oscillator/circle.yml", "closed_form"),
        ("scenes/oscillator/damped_critical.yml", "closed_form"),
        (CHAOTIC, "converged"),
        ("scenes/pa1/scene04.yml", "converged"),
        ("scenes/pa1/scene05.yml", "converged"),
        ("scenes/hard/pleiades.yml", "converged"),
    ] {
        // No name and no place: only what is in the file.
        let folder = tempfile::tempdir().expect("a folder");
        let renamed = folder.path().join("scene00.yml");
        let text = std::fs::read_to_string(scene).expect("a shipped scene");
        let unnamed = text.lines().filter(|line| !line.starts_with("name:"));
        std::fs::write(&renamed, unnamed.collect::<Vec<_>>().join("\n")).expect("written");
        let report = json(&[
            "run",
            word(&renamed),
            "--integrators",
            "rk4",
            "--engines",
            "none",
        ]);
        let truth = &report["truth"];
        assert_eq!(truth["kind"], kind, "{scene}: {truth:#}");
        let bound = truth["error_bound_m"].as_f64().expect("a bar");
        assert!(bound > 0.0 && bound < 1e-9, "{scene}: {bound}");
        let error = &report["outcomes"][0]["position_error_m"];
        let [last, rms, max] = ["final", "rms", "max"].map(|k| error[k].as_f64().expect("m"));
        assert!(0.0 < rms && rms <= max && last <= max, "{scene}: {error}");
        for check in report["checks"].as_array().expect("checks") {
            assert_ne!(check["status"], "fail", "{scene}: {check:#}");
        }
    }
}

#[test]
fn truths_that_are_not_asked_for_are_not_computed() {
    let with = |kind| {
        let args = ["run", CHAOTIC, "--integrators", "rk4", "--engines", "none"];
        json(&[&args[..], &["--truth", kind]].concat())
    };
    for (kind, reason) in [("none", "not asked for"), ("closed", "no closed form")] {
        let report = with(kind);
        assert_eq!(report["truth"]["kind"], "none");
        assert!(
            report["truth"]["reason"]
                .as_str()
                .is_some_and(|r| r.contains(reason))
        );
        assert!(report["outcomes"][0]["position_error_m"].is_null());
    }
    // The run itself is the same.
    let energy = |report: &Value| report["outcomes"][0]["energy"]["final_j"].clone();
    assert_eq!(energy(&with("none")), energy(&with("auto")));
}

/// The report of a run with this cache, without its times.
fn cached(cache: &Path) -> Value {
    let args = ["run", CHAOTIC, "--integrators", "rk4", "--engines", "none"];
    let mut command = springcheck();
    command.env("SPRINGCHECK_CACHE", cache);
    command.args(args).args(["--format", "json"]);
    let (_, report, _) = answer(&mut command);
    program::without_times(program::report(&report))
}

/// The only file in the cache.
fn entry(cache: &Path) -> std::path::PathBuf {
    let mut entries = std::fs::read_dir(cache).expect("a cache");
    let first = entries.next().expect("an entry").expect("readable").path();
    assert!(entries.next().is_none(), "one scene, one entry");
    first
}

#[test]
fn a_cache_changes_nothing_whatever_state_it_is_in() {
    let folder = tempfile::tempdir().expect("a folder");
    let cache = folder.path().join("deep/cache");
    let fresh = cached(&cache);
    let whole = std::fs::read(entry(&cache)).expect("an entry");
    assert_eq!(cached(&cache), fresh, "a hit");
    // What a crash, a full disk or a flipped bit leaves.
    let mut flipped = whole.clone();
    flipped[whole.len() / 2] ^= 1;
    for spoiled in [
        &[][..],
        &whole[..whole.len() / 2],
        &flipped[..],
        b"nonsense",
    ] {
        std::fs::write(entry(&cache), spoiled).expect("written");
        assert_eq!(cached(&cache), fresh);
        assert_eq!(
            std::fs::read(entry(&cache)).expect("an entry"),
            whole,
            "made whole again"
        );
    }
    // None at all, and one that cannot be written.
    assert_eq!(cached(Path::new("")), fresh);
    assert_eq!(cached(&entry(&cache).join("below a file")), fresh);
}

#[test]
fn runs_at_once_share_a_cache() {
    let folder = tempfile::tempdir().expect("a folder");
    let cache = folder.path();
    let reports: Vec<Value> = std::thread::scope(|scope| {
        let runs: Vec<_> = (0..4).map(|_| scope.spawn(|| cached(cache))).collect();
        runs.into_iter()
            .map(|run| run.join().expect("a report"))
            .collect()
    });
    assert!(reports.windows(2).all(|pair| pair[0] == pair[1]));
    // And leave nothing half written.
    entry(cache);
}

#[test]
fn errors_stop_at_the_horizon() {
    // Two coupled stiff pendulums for a minute: neighbours part, and no arithmetic keeps them.
    let folder = tempfile::tempdir().expect("a folder");
    let scene = folder.path().join("chaos.yml");
    let text = "solver: {type: rk4, timestep: 0.002}\nduration: 60\nparticles:\n\
        - {pos: [0, 0, 0], fixed: true}\n- {pos: [1, 0, 0], mass: 1}\n- {pos: [2, 0, 0.1], mass: 1}\n\
        springs:\n- {particle_ids: [0, 1], stiffness: 300}\n- {particle_ids: [1, 2], stiffness: 300}\n";
    std::fs::write(&scene, text).expect("written");
    let scene = word(&scene);
    let args = ["run", scene, "--integrators", "rk4", "--engines", "none"];
    let (code, report) = json_of(&args);
    assert_eq!(code, 0);
    let truth = &report["truth"];
    let horizon = truth["horizon_s"].as_f64().expect("s");
    assert!((5.0..55.0).contains(&horizon), "{truth:#}");
    assert!(
        truth["reason"]
            .as_str()
            .is_some_and(|r| r.contains("part at")),
        "{truth:#}"
    );
    let bound = truth["error_bound_m"].as_f64().expect("m");
    assert!(bound <= 1e-6 * 4.0, "{truth:#}");
    // An instant later would be the end of the run, where nothing of the truth is known.
    let shorter = (horizon / 0.002).floor() * 0.002;
    let shorter = ["--duration", &format!("{shorter:.3}")];
    let (_, again) = json_of(&[&args[..], &shorter].concat());
    let last = |report: &Value| report["outcomes"][0]["position_error_m"]["final"].as_f64();
    let ratio = last(&again).expect("m") / last(&report).expect("m");
    assert!((0.1..10.0).contains(&ratio), "{ratio}");
}
