//! What is printed and what is written.

use super::keys::keep_the_contract;
use super::*;

#[test]
fn it_prints_a_table_and_writes_a_report() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = word(folder.path());
    let args = [&[SCENE, "--output", out][..], &SMALL].concat();
    let (code, table, err) = output(&args);
    // Not a terminal, and little to do: no bar and no announcement.
    assert_eq!((code, err.as_str()), (0, ""));
    tidy(&table);
    // The verdict is the first paragraph below the scene's.
    let verdict = table.split("\n\n").nth(1).unwrap_or_default();
    assert!(verdict.starts_with("cheapest to "), "{verdict}");
    let tail: Vec<&str> = table.lines().rev().take(2).collect();
    assert!(tail[1].starts_with("report: ") && tail[1].ends_with("oscillator/cost.md"));
    // h = 0.01 s in the file.
    let next = format!("next: springcheck cost {SCENE} --timestep 0.04,0.02,0.01");
    assert_eq!(tail[0], next);
    for id in ["rk4", "▸ symplectic_euler", "dormand_prince54", "† rapier"] {
        assert!(table.contains(id), "{id} in\n{table}");
    }
    let place = folder.path().join("oscillator/oscillator");
    let wanted = [
        "cost.html",
        "cost.json",
        "cost.md",
        "cost_energy.svg",
        "cost_evaluations.svg",
        "cost_time.svg",
    ];
    assert_eq!(files(&place), wanted.map(String::from).into());
    assert_eq!(files(folder.path()), ["oscillator".to_owned()].into());
    well_formed(&place);
}

#[test]
fn named_timesteps_are_exactly_those_and_draw_a_picture() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = word(folder.path());
    // 0.15 does not divide 5, and one is named twice.
    let steps = [SCENE, "--timestep", ".15,.01,.05,.05", "--output", out];
    let who = ["--integrators", "rk4,dop853,symplectic_euler"];
    let args = [&steps[..], &who].concat();
    let (code, table, err) = output(&args);
    assert_eq!(code, 0, "{err}");
    tidy(&table);
    assert!(!table.contains("dop853"), "{table}");
    let next = table.lines().last().expect("lines");
    let wanted = format!("next: springcheck run {SCENE} --integrators rk4 --timestep 0.01");
    assert_eq!(next, wanted);
    let place = folder.path().join("oscillator/oscillator");
    assert!(files(&place).contains("cost_panels.svg"));
    well_formed(&place);
    let text = std::fs::read_to_string(place.join("cost.json")).expect("written");
    let report = report(&text);
    keep_the_contract(&report);
    let ours = ["rk4", "symplectic_euler"];
    assert_eq!(engines(&report)[..2], ours);
    for curve in curves(&report) {
        let points = array(&curve["points"]).iter();
        let steps: Vec<f64> = points.map(|p| number(&p["timestep"])).collect();
        assert_eq!(steps, [0.15, 0.05, 0.01], "{}", curve["engine"]);
    }
}

#[test]
fn what_takes_no_part_is_not_explained() {
    let args = ["scenes/hard/pleiades.yml", "--format", "markdown"];
    let (code, text, err) = output(&[&args[..], &SMALL].concat());
    assert_eq!((code, err.as_str()), (0, ""));
    assert!(text.contains("no native"), "{text}");
    // The same sentence stands where rapier does take the scene.
    let explained = "linearly implicit";
    assert!(!text.contains(explained), "{text}");
    let args = [&[SCENE, "--format", "markdown"][..], &SMALL].concat();
    assert!(output(&args).1.contains(explained));
}

#[test]
fn other_formats_write_no_files() {
    let folder = tempfile::tempdir().expect("a folder");
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for format in ["json", "markdown"] {
        let mut command = springcheck();
        let command = command.current_dir(folder.path()).arg("cost");
        let command = command.arg(root.join(SCENE)).args(SMALL);
        let (code, out, err) = answer(command.args(["--format", format]));
        assert_eq!((code, err.as_str()), (0, ""));
        assert!(!out.is_empty());
        assert_eq!(files(folder.path()), BTreeSet::new(), "{format}");
    }
}
