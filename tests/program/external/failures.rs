//! Programs that go wrong: each a `failed` outcome with its reason, beside the others' results.

use super::{SCENE, has, run, saved, theirs};
use crate::testkit::program::{altered, outcomes};
use serde_json::Value;

/// Runs it, and expects a failure that says this.
fn fails(command: &str, says: &[&str]) -> Value {
    let (report, _) = run(
        SCENE,
        &format!("bad={command}"),
        &["--external-timeout", "20s"],
    );
    let outcome = theirs(&report).clone();
    assert_eq!(outcome["engine"], "bad");
    assert_eq!(outcome["status"], "failed", "{command}: {outcome}");
    let reason = outcome["reason"].as_str().expect("a reason");
    for says in says {
        assert!(reason.contains(says), "{command}: {reason}");
    }
    // It is nobody else's failure.
    for other in &outcomes(&report)[..2] {
        assert_eq!(other["status"], "completed");
    }
    outcome
}

/// Nothing is known of it.
fn fails_empty(command: &str, says: &[&str]) {
    let outcome = fails(command, says);
    for key in ["stopped_at_s", "energy", "momentum"] {
        assert_eq!(outcome[key], Value::Null, "{command}");
    }
    assert_eq!(outcome["work"]["wall_s"], Value::Null);
    assert_eq!(outcome["work"]["steps"], 0);
    assert_eq!(outcome["deviation_m"].as_object().map(|d| d.len()), Some(0));
}

#[test]
fn programs_that_do_not_run_to_their_end() {
    fails_empty(
        "/no/such/solver {scene}",
        &["no program `/no/such/solver`", "PATH"],
    );
    fails_empty(
        "no-such-solver {scene}",
        &["no program `no-such-solver`", "PATH"],
    );
    // A directory is there, but starts nothing.
    fails_empty("/tmp", &["`/tmp` could not be started"]);
    fails_empty("sh -c 'exit 3'", &["exit code 3", "expected 0"]);
    fails_empty("sh -c 'kill -9 $$'", &["signal 9"]);
    // What it printed before does not count.
    fails_empty("sh -c 'echo t,id,x,y,z; exit 4'", &["exit code 4"]);
}

#[test]
fn programs_that_give_no_trajectory() {
    fails_empty("true", &["printed nothing", "t,id,x,y,z", "{output}"]);
    fails_empty(
        "sh -c 'echo well' {output}",
        &["no file", "{output}", ".npz"],
    );
    fails_empty(
        "sh -c 'echo well > \"$0\"' {output}",
        &["{output}", "no trajectory"],
    );
    fails_empty("echo well", &["stdout:1:1", "no trajectory of this scene"]);
    fails_empty("head -c 4096 /dev/zero", &["stdout"]);
    fails_empty("echo t,id,x,y,z", &["stdout"]);
}

#[test]
fn rows_that_are_wrong_are_named_with_their_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let good = saved(folder.path(), "1");
    let (report, _) = run(SCENE, &format!("good=cat '{}'", good.display()), &[]);
    assert_eq!(theirs(&report)["status"], "completed");
    // After the header two lines an instant: line 7 is the free particle at step 2.
    let with = |column: usize, text: &str, lines: [usize; 2]| {
        let text = text.to_owned();
        move |at: usize, fields: &mut Vec<String>| {
            if lines.contains(&(at + 1)) {
                fields[column].clone_from(&text);
            }
        }
    };
    let nan = altered(&good, "nan.csv", with(2, "NaN", [7, 7]));
    fails_empty(&format!("cat '{}'", nan.display()), &["stdout:7:", "NaN"]);
    let late = altered(&good, "late.csv", with(0, "0.0213", [6, 7]));
    fails_empty(
        &format!("cat '{}'", late.display()),
        &["stdout:6:1", "0.0213"],
    );
}

#[test]
fn a_run_that_ends_too_early_failed_there_and_is_measured_up_to_there() {
    let folder = tempfile::tempdir().expect("a folder");
    let good = saved(folder.path(), "1");
    // The header and 200 instants of two particles: steps 0 to 199.
    let outcome = fails(
        &format!("head -n 401 '{}'", good.display()),
        &["end at t = 1.99 s (step 199)", "up to t = 5.0 s (step 500)"],
    );
    assert_eq!(outcome["stopped_at_s"], 1.99);
    assert_eq!(outcome["work"]["steps"], 199);
    assert_eq!(outcome["deviation_m"]["rapier-forces"]["max"], 0.0);
    assert!(outcome["energy"]["final_j"].is_number());
    // One step short is a mistake of its own.
    let short = format!("head -n 1001 '{}'", good.display());
    fails(&short, &["step 499", "ceil(duration / timestep)"]);
}

#[test]
fn a_program_that_hangs_is_stopped_with_all_it_started() {
    if !has("ps", &["-A", "-o", "pid=", "-o", "ppid="]) {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let ids = folder.path().join("ids");
    // Two generations that outlive their time. What they write to is open in the last of them.
    let inner = "sleep 1000 & echo $! >> \"$0\"; wait";
    let command = format!(
        "bad=sh -c 'echo $$ >> \"$0\"; sh -c \"$1\" \"$0\"; true' '{}' '{inner}'",
        ids.display()
    );
    let (report, _) = run(SCENE, &command, &["--external-timeout", "1s"]);
    let outcome = theirs(&report);
    assert_eq!(outcome["status"], "failed");
    let reason = outcome["reason"].as_str().expect("a reason");
    assert!(reason.contains("had not ended after 1s"), "{reason}");
    assert!(reason.contains("--external-timeout"), "{reason}");
    let text = std::fs::read_to_string(&ids).expect("ids");
    assert_eq!(text.lines().count(), 2, "{text}");
    for id in text.lines() {
        // Dead, or dead and not yet collected by whoever inherited it.
        let shown = std::process::Command::new("ps")
            .args(["-o", "stat=", "-p", id])
            .output()
            .expect("ps");
        let state = String::from_utf8_lossy(&shown.stdout).trim().to_owned();
        assert!(state.is_empty() || state.starts_with('Z'), "{id}: {state}");
    }
}

#[test]
fn what_a_program_leaves_in_the_background_is_told_from_the_program() {
    let run = |command: &str| {
        let command = format!("bad={command}");
        let (report, _) = run(SCENE, &command, &["--external-timeout", "1s"]);
        theirs(&report).clone()
    };
    let reason = |outcome: &Value| outcome["reason"].as_str().unwrap_or_default().to_owned();
    // It has ended well, and its stdout is open.
    let held = reason(&run("sh -c 'sleep 1000 & exit 0'"));
    assert!(held.contains("ended well, but its stdout"), "{held}");
    assert!(!held.contains("had not ended"), "{held}");
    // It has ended badly, which is known at once.
    let failed = reason(&run("sh -c 'sleep 1000 & exit 3'"));
    assert!(failed.contains("exit code 3"), "{failed}");
    // A file without an end.
    let fifo = reason(&run("sh -c 'mkfifo \"$0\"' {output}"));
    assert!(fifo.contains("its {output} had no end"), "{fifo}");
    // stderr may stay open.
    let folder = tempfile::tempdir().expect("a folder");
    let (every, id) = (saved(folder.path(), "1"), folder.path().join("id"));
    let well = run(&format!(
        "sh -c 'sleep 1000 >&2 & echo $! > \"$1\"; cat \"$0\"' '{}' '{}'",
        every.display(),
        id.display()
    ));
    let id = std::fs::read_to_string(id).expect("an id");
    let _ = std::process::Command::new("kill").arg(id.trim()).status();
    assert_eq!(well["status"], "completed", "{well}");
}
