//! Other people's programs as rows: `run --external`, and the library behind it.

mod answers;
mod examples;
mod failures;
mod flags;

use assert_cmd::Command;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Undamped, one free particle on a spring: 500 steps of 0.01 s.
const SCENE: &str = "scenes/oscillator/circle.yml";

fn springcheck() -> Command {
    let mut command = Command::cargo_bin("springcheck").expect("the binary");
    command.current_dir(env!("CARGO_MANIFEST_DIR"));
    // Not the user's.
    command.env(
        "SPRINGCHECK_CACHE",
        concat!(env!("CARGO_TARGET_TMPDIR"), "/cache"),
    );
    command
}

/// Exit code, stdout, stderr.
fn output(args: &[&str]) -> (i32, String, String) {
    let output = springcheck().args(args).output().expect("it runs");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8");
    let code = output.status.code().expect("no signal");
    (code, text(output.stdout), text(output.stderr))
}

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

fn outcomes(report: &Value) -> &Vec<Value> {
    report["outcomes"].as_array().expect("outcomes")
}

/// The program's outcome, which is the last.
fn theirs(report: &Value) -> &Value {
    outcomes(report).last().expect("an outcome")
}

/// What `run --save csv` wrote of symplectic Euler on [`SCENE`], every `every`-th step.
fn saved(folder: &Path, every: &str) -> PathBuf {
    let out = folder.to_str().expect("UTF-8");
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

/// A file's text with each line changed, beside it.
fn altered(file: &Path, name: &str, change: impl Fn(usize, &str) -> Option<String>) -> PathBuf {
    let text = std::fs::read_to_string(file).expect("text");
    let lines = text.lines().enumerate();
    let lines: Vec<String> = lines.filter_map(|(at, line)| change(at, line)).collect();
    let path = file.with_file_name(name);
    std::fs::write(&path, lines.join("\n") + "\n").expect("written");
    path
}

/// Whether a command that a test needs is there. Without it the test says so and ends; where
/// `SPRINGCHECK_REQUIRE_TOOLS` is 1 it fails instead.
fn has(program: &str, arguments: &[&str]) -> bool {
    let answer = std::process::Command::new(program).args(arguments).output();
    let works = answer.is_ok_and(|output| output.status.success());
    let command = format!("{program} {}", arguments.join(" "));
    let required = std::env::var("SPRINGCHECK_REQUIRE_TOOLS").is_ok_and(|value| value == "1");
    assert!(works || !required, "`{command}` does not work here");
    if !works {
        eprintln!("NOT TESTED: `{command}` does not work here");
    }
    works
}
