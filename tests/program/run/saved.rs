//! Trajectories written with `--save`.

use super::SCENE;
use crate::testkit::program::{output, word};
use std::path::{Path, PathBuf};

/// One array of an NPZ: its shape and values.
fn array(path: &Path, name: &str) -> (Vec<u64>, Vec<f64>) {
    let mut archive =
        zip::ZipArchive::new(std::fs::File::open(path).expect("a file")).expect("zip");
    let file = npyz::NpyFile::new(archive.by_name(name).expect("an array")).expect("npy");
    (file.shape().to_vec(), file.into_vec().expect("doubles"))
}

#[test]
fn saved_trajectories_hold_every_step_and_agree_to_the_last_bit() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = word(folder.path());
    for format in ["csv", "npz"] {
        let args = [
            "run",
            SCENE,
            "--output",
            out,
            "--duration",
            "1.5",
            "--engines",
            "rapier",
        ];
        let (code, ..) = output(&[&args[..], &["--integrators", "rk4", "--save", format]].concat());
        assert_eq!(code, 0);
    }
    let place = folder.path().join("pa1/scene01");
    for engine in ["rk4", "rapier"] {
        let file =
            |extension: &str| -> PathBuf { place.join(format!("{engine}@0.0005.{extension}")) };
        let (shape, x) = array(&file("npz"), "x.npy");
        assert_eq!(shape, [3001, 2, 3]);
        let (_, v) = array(&file("npz"), "v.npy");
        let (_, t) = array(&file("npz"), "t.npy");
        let text = std::fs::read_to_string(file("csv")).expect("text");
        let mut lines = text.lines();
        assert_eq!(lines.next(), Some("t,id,x,y,z,vx,vy,vz"));
        let mut rows = 0;
        for (row, line) in lines.enumerate() {
            let numbers: Vec<f64> = line
                .split(',')
                .map(|n| n.parse().expect("a number"))
                .collect();
            assert_eq!(numbers[0].to_bits(), t[row / 2].to_bits());
            assert_eq!(numbers[1], (row % 2) as f64);
            for a in 0..3 {
                assert_eq!(numbers[2 + a].to_bits(), x[3 * row + a].to_bits());
                assert_eq!(numbers[5 + a].to_bits(), v[3 * row + a].to_bits());
            }
            rows += 1;
        }
        assert_eq!(rows, 2 * 3001);
        assert_eq!(t[3000], 3000.0 * 0.0005);
    }
}

/// Reactions and tensions beside the states, in the report and in both formats; files of states read back.
#[test]
fn static_quantities_are_stated_and_saved_on_request() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = word(folder.path());
    let common = [
        "run",
        SCENE,
        "--output",
        out,
        "--duration",
        "0.05",
        "--engines",
        "none",
        "--integrators",
        "rk4",
    ];
    for format in ["csv", "npz"] {
        let more = ["--save", format, "--columns", "reaction,tension"];
        let (code, text, _) = output(&[&common[..], &more].concat());
        assert_eq!(code, 0);
        assert!(
            text.contains("rk4: at most") && text.contains("particle 0 is held by"),
            "{text}"
        );
    }
    let place = folder.path().join("pa1/scene01");
    let (shape, reaction) = array(&place.join("rk4@0.0005.npz"), "reaction.npy");
    assert_eq!(shape, [101, 2, 3]);
    let (shape, tension) = array(&place.join("rk4@0.0005.npz"), "tension.npy");
    assert_eq!(shape, [101, 1]);
    let lines = |name: &str| -> Vec<Vec<f64>> {
        let text = std::fs::read_to_string(place.join(name)).expect("text");
        let rows = text
            .lines()
            .skip(1)
            .map(|line| line.split(',').map(|n| n.parse().expect("a number")));
        rows.map(Iterator::collect).collect()
    };
    let states = lines("rk4@0.0005.csv");
    for (row, line) in states.iter().enumerate() {
        assert_eq!(line[8..], reaction[3 * row..3 * row + 3]);
    }
    let tensions = lines("rk4@0.0005.tension.csv");
    assert_eq!(
        tensions.iter().map(|line| line[2]).collect::<Vec<_>>(),
        tension
    );
    // One spring on one anchor: what it pulls with is what holds that.
    for (k, tension) in tension.iter().enumerate() {
        assert!(
            (reaction[6 * k + 2] - tension).abs() < 1e-12 * tension.abs().max(1.0),
            "{k}"
        );
    }
    for file in ["rk4@0.0005.csv", "rk4@0.0005.npz"] {
        let file = place.join(file);
        let (code, ..) = output(&["compare", word(&file), "--scene", SCENE]);
        assert_eq!(code, 0);
    }
    // Nobody asked.
    let (_, text, _) = output(&common);
    assert!(!text.contains("at most"), "{text}");
    let report = std::fs::read_to_string(place.join("report.json")).expect("a report");
    assert!(!report.contains("tension_n"));
}

#[test]
fn a_saved_run_can_be_thinned_and_keeps_its_end() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = word(folder.path());
    let (code, ..) = output(&[
        "run",
        SCENE,
        "--output",
        out,
        "--duration",
        "0.05",
        "--engines",
        "none",
        "--integrators",
        "rk4",
        "--save",
        "npz",
        "--every",
        "7",
    ]);
    assert_eq!(code, 0);
    let (_, t) = array(&folder.path().join("pa1/scene01/rk4@0.0005.npz"), "t.npy");
    let steps: Vec<f64> = t.iter().map(|t| (t / 0.0005).round()).collect();
    let wanted: Vec<f64> = (0..100).step_by(7).chain([100]).map(f64::from).collect();
    assert_eq!(steps, wanted);
}
