//! The program as its users run it: called with words, answering with a code and two streams.

use assert_cmd::Command;
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Run from the root of the repository, with a cache of truths that is not the user's and that all
/// tests share.
pub fn springcheck() -> Command {
    let mut command = Command::cargo_bin("springcheck").expect("the binary");
    command.current_dir(env!("CARGO_MANIFEST_DIR"));
    command.env(
        "SPRINGCHECK_CACHE",
        concat!(env!("CARGO_TARGET_TMPDIR"), "/cache"),
    );
    command
}

/// The path of the program, for tests that start it by other means.
pub fn springcheck_path() -> PathBuf {
    assert_cmd::cargo::cargo_bin("springcheck")
}

/// Exit code, stdout, stderr.
pub fn output(args: &[&str]) -> (i32, String, String) {
    answer(springcheck().args(args))
}

/// The same of a command with more to it than words.
pub fn answer(command: &mut Command) -> (i32, String, String) {
    let output = command.output().expect("it runs");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8");
    let code = output.status.code().expect("no signal");
    (code, text(output.stdout), text(output.stderr))
}

/// The report of a run that ends well. `--format json` is added.
pub fn json(args: &[&str]) -> Value {
    let (code, report) = json_of(args);
    assert_eq!(code, 0, "{args:?}");
    report
}

/// The exit code beside the report. `--format json` is added.
pub fn json_of(args: &[&str]) -> (i32, Value) {
    let (code, out, err) = output(&[args, &["--format", "json"]].concat());
    assert!(!out.is_empty(), "{args:?}: {err}");
    (code, report(&out))
}

/// The one report of a JSON text.
pub fn report(text: &str) -> Value {
    let mut document: Value = serde_json::from_str(text).expect("JSON");
    assert_eq!(document["schema_version"], 2);
    assert_eq!(document["reports"].as_array().map(Vec::len), Some(1));
    document["reports"][0].take()
}

/// Each call exits with 2, says this on stderr, prints nothing and writes nothing.
pub fn refuse(verb: &str, cases: &[(&[&str], &str)]) {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    let flags = ["--output", word(&out)];
    for (args, says) in cases {
        refuse_all(&[&[verb][..], args, &flags].concat(), &[says]);
        assert!(!out.exists(), "{args:?} wrote something");
    }
}

/// The call exits with 2, prints nothing and says all of this on stderr.
pub fn refuse_all(args: &[&str], says: &[&str]) {
    let (code, stdout, stderr) = output(args);
    assert_eq!(code, 2, "{args:?}: {stderr}");
    assert!(stdout.is_empty(), "{args:?}: {stdout}");
    for says in says {
        assert!(stderr.contains(says), "{args:?}: {stderr}");
    }
    assert!(!stderr.contains("panicked"), "{stderr}");
}

/// A reader that is gone before anything is printed is no error.
pub fn leave(args: &[&str]) {
    use std::process::Stdio;
    let mut child = std::process::Command::new(springcheck_path())
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(args)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it starts");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("it ends");
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(stderr.is_empty(), "{stderr}");
    assert_eq!(output.status.code(), Some(0));
}

/// The report without what the clock says: everything under a key that begins with `wall`.
pub fn without_times(mut report: Value) -> Value {
    match &mut report {
        Value::Object(object) => {
            object.retain(|key, _| !key.starts_with("wall"));
            for value in object.values_mut() {
                *value = without_times(value.take());
            }
        }
        Value::Array(values) => {
            for value in values {
                *value = without_times(value.take());
            }
        }
        _ => {}
    }
    report
}

/// A path as the command line has it.
pub fn word(path: &Path) -> &str {
    path.to_str().expect("UTF-8")
}

pub fn keys(value: &Value) -> BTreeSet<&str> {
    let object = value.as_object().expect("an object");
    object.keys().map(String::as_str).collect()
}

pub fn set<'a>(keys: &[&'a str]) -> BTreeSet<&'a str> {
    keys.iter().copied().collect()
}

pub fn array(value: &Value) -> &Vec<Value> {
    value.as_array().expect("an array")
}

pub fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

pub fn outcomes(report: &Value) -> &Vec<Value> {
    array(&report["outcomes"])
}

/// Names of what is in a folder.
pub fn files(folder: &Path) -> BTreeSet<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let name = |entry: std::io::Result<std::fs::DirEntry>| entry.expect("a file").file_name();
    let names = entries.map(|entry| name(entry).into_string().expect("UTF-8"));
    names.collect()
}

/// The file of this name somewhere below a folder.
pub fn find(folder: &Path, name: &str) -> PathBuf {
    let mut open = vec![folder.to_owned()];
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                open.push(path);
            } else if path.file_name().is_some_and(|own| own == name) {
                return path;
            }
        }
    }
    panic!("no {name}");
}

/// Every file holds text without numbers that are none, and every figure is well-formed.
pub fn well_formed(folder: &Path) {
    let texts = files(folder).into_iter();
    for name in texts.filter(|name| !name.ends_with(".series")) {
        let text = std::fs::read_to_string(folder.join(&name)).expect("text");
        // Of a page what is said: its scripts end it, and a packed motion may have any letters.
        let text = text.split("<script").next().unwrap_or_default();
        assert!(!text.contains("NaN") && !text.contains("inf "), "{name}");
        if name.ends_with(".svg") {
            roxmltree::Document::parse(text).expect("well-formed");
        }
    }
}

/// As wide as promised, nothing that is no number, and no colour in a pipe.
pub fn tidy(table: &str) {
    for line in table.lines() {
        assert!(line.chars().count() <= 100, "{line}");
    }
    for wrong in ["NaN", "inf ", "null", "\u{1b}"] {
        assert!(!table.contains(wrong), "{wrong} in\n{table}");
    }
}

/// The text with the comma-separated fields of each line changed, given the line's number from 0. A line
/// without fields is left out.
pub fn with_fields(text: &str, change: impl Fn(usize, &mut Vec<String>)) -> String {
    let lines = text.lines().enumerate().map(|(at, line)| {
        let mut fields: Vec<String> = line.split(',').map(str::to_owned).collect();
        change(at, &mut fields);
        fields.join(",")
    });
    let kept = lines.filter(|line| !line.is_empty());
    kept.collect::<Vec<_>>().join("\n") + "\n"
}

/// A copy of a file changed by [`with_fields`], beside it.
pub fn altered(file: &Path, name: &str, change: impl Fn(usize, &mut Vec<String>)) -> PathBuf {
    let text = std::fs::read_to_string(file).expect("text");
    let path = file.with_file_name(name);
    std::fs::write(&path, with_fields(&text, change)).expect("written");
    path
}

/// Whether a command that a test needs is there. Without it the test says so and ends; where
/// `SPRINGCHECK_REQUIRE_TOOLS` is 1 it fails instead.
pub fn has(program: &str, arguments: &[&str]) -> bool {
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
