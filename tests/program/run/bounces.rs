//! `compare` says what a program does at contact.

use crate::testkit::program::{json_of, output, word};
use std::fmt::Write;
use std::path::PathBuf;

const SCENE: &str = "scenes/contact/bouncing.yml";

/// Semi-implicit Euler that turns the velocity at the end of a step, as a file.
fn bounced(folder: &std::path::Path, turn: fn(f64) -> f64) -> PathBuf {
    let mut text = String::from("t,id,x,y,z,vx,vy,vz\n");
    let (mut z, mut v) = (1.0_f64, 0.0_f64);
    for step in 0..=200 {
        let t = f64::from(step) * 0.01;
        writeln!(text, "{t},0,0,0,{z},0,0,{v}").expect("text");
        v -= 0.01 * 9.81;
        z += 0.01 * v;
        if z <= 0.0 && v < 0.0 {
            v = turn(v);
        }
    }
    let file = folder.join("mine.csv");
    std::fs::write(&file, text).expect("a file");
    file
}

#[test]
fn a_treatment_of_contact_is_said_and_is_no_fault() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = bounced(folder.path(), |v| -0.8 * v);
    let args = ["compare", word(&file), "--scene", SCENE];
    let (code, report) = json_of(&args);
    let contact = &report["outcomes"][0]["identified"]["contact"];
    assert_eq!(code, 0, "{report:#}");
    assert_eq!(contact["treatment"], "flip_at_end", "{contact:#}");
    assert!(
        contact["deepest_m"]
            .as_f64()
            .is_some_and(|deep| deep > 0.01)
    );
    assert!(report["fault"].is_null(), "{report:#}");
    let (code, text, _) = output(&args);
    assert_eq!(code, 0);
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let says = "at contact it reverses the velocity at the end of the step, instead of by an impulse at the impact";
    assert!(text.contains(says), "{text}");
}

/// A page that a student reads: how many impacts are judged, and who does not book what they take.
#[test]
fn what_nobody_books_is_said_and_so_is_how_much_is_judged() {
    let run = |scene: &str, more: &[&str]| {
        let args = [&["run", scene, "--no-files", "--format", "markdown"], more].concat();
        let (code, text, err) = output(&args);
        assert_eq!(code, 0, "{err}");
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let unbooked = "not say what impacts and friction take";
    let text = run(SCENE, &["--integrators", "rk4"]);
    let says = "rapier and rapier-forces do not say what impacts and friction take: their energy counts it as lost";
    assert!(text.contains(says), "{text}");
    // e = 0.8, three impacts in 2 s.
    assert!(
        text.contains("rk4: in 3 impacts it separates at 0.8 of"),
        "{text}"
    );
    let own = ["--integrators", "rk4", "--engines", "none"];
    assert!(!run(SCENE, &own).contains(unbooked));
    // Where e = 1 nothing is lost. Of 31 impacts those that follow each other within a row are not judged.
    let text = run(
        "scenes/contact/blocks_and_a_wall.yml",
        &["--integrators", "rk4"],
    );
    assert!(!text.contains(unbooked), "{text}");
    assert!(
        text.contains("of its 31 impacts, which nothing else disturbs,"),
        "{text}"
    );
}

#[test]
fn a_mistake_at_contact_is_a_fault_from_the_first_impact_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = bounced(folder.path(), |v| -v);
    let (code, report) = json_of(&["compare", word(&file), "--scene", SCENE]);
    let outcome = &report["outcomes"][0];
    assert_eq!(code, 1, "{report:#}");
    let mistakes = &outcome["identified"]["contact"]["mistakes"];
    assert_eq!(mistakes[0], "restitution_as_one", "{outcome:#}");
    assert_eq!(outcome["explained"]["deviations"][0]["what"], "contact");
    // 1 m is fallen through in 45 steps: g h² n (n + 1)/2.
    assert_eq!(report["fault"]["step"], 44, "{report:#}");
}

#[test]
fn a_wrong_number_of_contact_is_said() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = bounced(folder.path(), |v| -0.7 * v);
    let args = ["compare", word(&file), "--scene", SCENE];
    let (code, report) = json_of(&args);
    let contact = &report["outcomes"][0]["identified"]["contact"];
    assert_eq!(code, 1, "{report:#}");
    assert_eq!(contact["mistakes"][0], "restitution", "{contact:#}");
    let text = words_of(&args);
    assert!(
        text.contains("it has a restitution of 0.7, not 0.8"),
        "{text}"
    );
    assert!(text.contains("first in step 44"), "{text}");
}

#[test]
fn an_unknown_treatment_has_no_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = bounced(folder.path(), |v| 0.3 - 0.4 * v);
    let args = ["compare", word(&file), "--scene", SCENE];
    let (code, report) = json_of(&args);
    let contact = &report["outcomes"][0]["identified"]["contact"];
    assert_eq!(code, 1, "{report:#}");
    assert!(contact["treatment"].is_null(), "{contact:#}");
    let text = words_of(&args);
    assert!(text.contains("no known treatment explains"), "{text}");
    // It comes with 4.4 m/s and 2 m/s, and leaves with half of it: forces between the rows explain 0.09.
    assert!(text.contains("where e = 0.8 asks 0.8"), "{text}");
}

fn words_of(args: &[&str]) -> String {
    let (_, text, _) = output(args);
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A block on a slope of 30° that µ_s = 0.7 holds, in a program that knows µ = 0.3 alone: each step is explained by flips.
#[test]
fn what_a_treatment_does_not_know_is_said_and_fails() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = folder.path().join("slope.yml");
    let text = "solver: {type: symplectic_euler, timestep: 0.01}\nduration: 1\n\
        particles: [{pos: [0, 0, 0], mass: 1, radius: 0}]\n\
        colliders: [{plane: {normal: [-0.5, 0, 0.8660254037844386]}, friction: 0.3, static_friction: 0.7}]\n";
    std::fs::write(&scene, text).expect("a file");
    let n = [-0.5, 0.0, 0.866_025_403_784_438_6];
    let dot = |a: [f64; 3]| a[0] * n[0] + a[1] * n[1] + a[2] * n[2];
    let (mut x, mut v) = ([0.0; 3], [0.0; 3]);
    let mut rows = String::from("t,id,x,y,z,vx,vy,vz\n");
    for step in 0..=100 {
        let t = f64::from(step) * 0.01;
        writeln!(
            rows,
            "{t},0,{},{},{},{},{},{}",
            x[0], x[1], x[2], v[0], v[1], v[2]
        )
        .expect("text");
        v[2] -= 0.01 * 9.81;
        x = [0, 1, 2].map(|c| x[c] + 0.01 * v[c]);
        let (deep, into) = (-dot(x), -dot(v));
        if deep > 0.0 && into > 0.0 {
            let along = [0, 1, 2].map(|c| v[c] + into * n[c]);
            let fast = along[0].hypot(along[2]);
            let kept = (1.0 - 0.3 * into / fast).max(0.0);
            v = along.map(|c| kept * c);
            x = [0, 1, 2].map(|c| x[c] + deep * n[c]);
        }
    }
    let file = folder.path().join("slides.csv");
    std::fs::write(&file, rows).expect("a file");
    let args = ["compare", word(&file), "--scene", word(&scene)];
    let (code, report) = json_of(&args);
    assert_eq!(code, 1, "{report:#}");
    let text = words_of(&args);
    // tan 30°.
    assert!(text.contains("where Coulomb's law asks 0.57735"), "{text}");
    assert!(!text.contains("throughout"), "{text}");
}

#[test]
fn positions_alone_are_not_judged_at_contact() {
    let folder = tempfile::tempdir().expect("a folder");
    let whole = std::fs::read_to_string(bounced(folder.path(), |v| -0.8 * v)).expect("a file");
    let cut = |line: &str| line.split(',').take(5).collect::<Vec<_>>().join(",");
    let lines: Vec<String> = whole.lines().map(cut).collect();
    let file = folder.path().join("positions.csv");
    std::fs::write(&file, lines.join("\n")).expect("a file");
    let args = ["compare", word(&file), "--scene", SCENE];
    let (code, report) = json_of(&args);
    assert_eq!(code, 0, "{report:#}");
    assert!(report["fault"].is_null(), "{report:#}");
    let text = words_of(&args);
    assert!(
        text.contains("positions alone do not tell what it does at contact"),
        "{text}"
    );
    assert!(!text.contains("throughout"), "{text}");
}
