//! The verb as its users run it.

mod files;
mod keys;
mod scenes;
mod usage;

use assert_cmd::Command;
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

fn springcheck() -> Command {
    let mut command = Command::cargo_bin("springcheck").expect("the binary");
    command.current_dir(env!("CARGO_MANIFEST_DIR"));
    command.env("SPRINGCHECK_CACHE", "");
    command
}

fn output(args: &[&str]) -> (i32, String, String) {
    let output = springcheck().arg("cost").args(args).output();
    let output = output.expect("it runs");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8");
    let code = output.status.code().expect("no signal");
    (code, text(output.stdout), text(output.stderr))
}

fn json(args: &[&str]) -> Value {
    let args = [args, &["--format", "json"]].concat();
    let (code, out, err) = output(&args);
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

fn keys(value: &Value) -> BTreeSet<&str> {
    let object = value.as_object().expect("an object");
    object.keys().map(String::as_str).collect()
}

fn set<'a>(keys: &[&'a str]) -> BTreeSet<&'a str> {
    keys.iter().copied().collect()
}

fn array(value: &Value) -> &Vec<Value> {
    value.as_array().expect("an array")
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn curves(report: &Value) -> &Vec<Value> {
    array(&report["cost"]["curves"])
}

/// Who was swept, in order.
fn engines(report: &Value) -> Vec<&str> {
    let engines = curves(report).iter().map(|curve| &curve["engine"]);
    engines.map(|e| e.as_str().expect("an id")).collect()
}

/// Files below a folder, by their names.
fn files(folder: &Path) -> BTreeSet<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let name = |entry: std::io::Result<std::fs::DirEntry>| entry.expect("a file").file_name();
    let names = entries.map(|entry| name(entry).into_string().expect("UTF-8"));
    names.collect()
}

/// A scene of the test's own: its file, which lives as long as the folder does.
fn scene(folder: &tempfile::TempDir, text: &str) -> String {
    let path = folder.path().join("scene.yml");
    std::fs::write(&path, text).expect("written");
    path.to_str().expect("UTF-8").to_owned()
}
