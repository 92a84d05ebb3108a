//! The verb as its users run it.

mod files;
mod keys;
mod scenes;
mod usage;

use crate::testkit::program::{
    self, answer, array, files, keys, number, refuse, set, springcheck, tidy, well_formed, word,
};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;

const SCENE: &str = "scenes/oscillator/oscillator.yml";
/// A small sweep: who is how good does not matter where it is used.
const SMALL: [&str; 6] = [
    "--budget",
    "0.3s",
    "--steps",
    "3",
    "--integrators",
    "rk4,symplectic_euler,dormand_prince54",
];

fn output(args: &[&str]) -> (i32, String, String) {
    program::output(&[&["cost"], args].concat())
}

fn json(args: &[&str]) -> Value {
    let (code, out, err) = output(&[args, &["--format", "json"]].concat());
    assert_eq!((code, err.as_str()), (0, ""), "{args:?}");
    assert!(!out.contains("NaN") && !out.contains("inf,"), "{args:?}");
    report(&out)
}

/// The one report of a JSON text.
fn report(text: &str) -> Value {
    let mut document: Value = serde_json::from_str(text).expect("JSON");
    document["reports"][0].take()
}

/// With the small sweep's flags.
fn small(args: &[&str]) -> Value {
    json(&[args, &SMALL].concat())
}

fn curves(report: &Value) -> &Vec<Value> {
    array(&report["cost"]["curves"])
}

/// Who was swept, in order.
fn engines(report: &Value) -> Vec<&str> {
    let engines = curves(report).iter().map(|curve| &curve["engine"]);
    engines.map(|e| e.as_str().expect("an id")).collect()
}

/// A scene of the test's own: its file, which lives as long as the folder does.
fn scene(folder: &tempfile::TempDir, text: &str) -> String {
    let path = folder.path().join("scene.yml");
    std::fs::write(&path, text).expect("written");
    program::word(&path).to_owned()
}
