//! Other people's programs as rows: `run --external`, and the library behind it.

mod answers;
mod examples;
mod failures;
mod flags;

use crate::testkit::program::{has, outcomes, output, word};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Undamped, one free particle on a spring: 500 steps of 0.01 s.
const SCENE: &str = "scenes/oscillator/circle.yml";

/// The report of a run with one integrator, rapier-forces and a program, and its stderr.
fn run(scene: &str, external: &str, more: &[&str]) -> (Value, String) {
    let args = [
        &["run", scene, "--integrators", "symplectic_euler"][..],
        &["--engines", "rapier-forces", "--format", "json"],
        &["--external", external],
        more,
    ]
    .concat();
    let (code, out, err) = output(&args);
    assert_eq!(code, 0, "{external}: {err}");
    let mut document: Value = serde_json::from_str(&out).expect("JSON on stdout");
    (document["reports"][0].take(), err)
}

/// The program's outcome, which is the last.
fn theirs(report: &Value) -> &Value {
    outcomes(report).last().expect("an outcome")
}

/// What `run --save csv` wrote of symplectic Euler on [`SCENE`], every `every`-th step.
fn saved(folder: &Path, every: &str) -> PathBuf {
    let out = word(folder);
    let (code, _, err) = output(&[
        "run",
        SCENE,
        "--integrators",
        "symplectic_euler",
        "--engines",
        "none",
        "--save",
        "csv",
        "--every",
        every,
        "--output",
        out,
        "--quiet",
    ]);
    assert_eq!(code, 0, "{err}");
    folder.join("oscillator/circle/symplectic_euler@0.01.csv")
}
