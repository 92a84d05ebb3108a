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
fn an_unknown_treatment_has_no_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = bounced(folder.path(), |v| -0.7 * v);
    let (code, report) = json_of(&["compare", word(&file), "--scene", SCENE]);
    let contact = &report["outcomes"][0]["identified"]["contact"];
    assert_eq!(code, 1, "{report:#}");
    assert!(contact["treatment"].is_null(), "{contact:#}");
}
