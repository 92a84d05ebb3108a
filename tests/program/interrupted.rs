//! What a signal leaves behind: nothing. And what no signal lets the program tidy, the next run does.

use crate::testkit::program::{files, has, output, springcheck_path, word};
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// The limit against hanging.
const LONG: Duration = Duration::from_secs(120);

/// Runs that are far from their end: each is being saved, and a program of two processes runs beside it.
struct Running {
    child: Child,
    place: PathBuf,
    /// Where the program beside has written its processes, and the file it was given.
    notes: PathBuf,
}

fn start(folder: &Path) -> Running {
    let notes = folder.join("notes");
    let script = "sleep 1000 & printf '%s\\n' $$ $! \"$1\" > \"$0.x\"; mv \"$0.x\" \"$0\"; wait";
    let external = format!(
        "p=sh -c '{}' '{}' {{scene_json}}",
        script.replace('\'', "'\\''"),
        notes.display()
    );
    let mut command = Command::new(springcheck_path());
    command
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args([
            "run",
            "scenes/oscillator/circle.yml",
            "scenes/pa1/scene00.yml",
        ])
        .args([
            "--integrators",
            "rk4",
            "--engines",
            "none",
            "--truth",
            "none",
        ])
        .args(["--timestep", "0.01", "--duration", "2e5", "--save", "csv"])
        .args(["--output", word(folder), "--external", &external])
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .process_group(0);
    let running = Running {
        child: command.spawn().expect("it starts"),
        place: folder.join("oscillator/circle"),
        notes,
    };
    let begun = Instant::now();
    while !running.notes.exists() || temporary(&running.place).is_empty() {
        assert!(begun.elapsed() < LONG, "it does not begin");
        std::thread::sleep(Duration::from_millis(10));
    }
    running
}

/// The temporary files in a folder.
fn temporary(place: &Path) -> Vec<String> {
    if !place.exists() {
        return Vec::new();
    }
    let names = files(place).into_iter();
    names
        .filter(|name| name.starts_with(".springcheck-"))
        .collect()
}

fn send(signal: &str, to: &str) {
    let sent = Command::new("kill").args(["-s", signal, "--", to]).status();
    assert!(sent.expect("kill runs").success(), "{signal} to {to}");
}

fn lives(process: &str) -> bool {
    // Dead, or dead and not yet collected by whoever inherited it.
    let shown = Command::new("ps")
        .args(["-o", "stat=", "-p", process])
        .output();
    let state = shown.expect("ps runs").stdout;
    let state = String::from_utf8_lossy(&state).trim().to_owned();
    !state.is_empty() && !state.starts_with('Z')
}

fn tools() -> bool {
    has("ps", &["-A", "-o", "pid=", "-o", "ppid="]) && has("kill", &["-l"])
}

#[test]
fn a_signal_leaves_nothing_behind_and_says_what_was_not_finished() {
    if !tools() {
        return;
    }
    // A shell reports a process that a signal ended with 128 and the signal's number.
    for (signal, number, to_group) in [
        ("INT", 2, false),
        ("TERM", 15, false),
        ("HUP", 1, false),
        ("INT", 2, true),
    ] {
        let folder = tempfile::tempdir().expect("a folder");
        let running = start(folder.path());
        let id = running.child.id();
        let to = if to_group {
            format!("-{id}")
        } else {
            id.to_string()
        };
        send(signal, &to);
        let ended = running.child.wait_with_output().expect("it ends");
        assert_eq!(ended.status.code(), Some(128 + number), "{signal}");
        assert!(ended.stdout.is_empty());
        let says = String::from_utf8(ended.stderr).expect("UTF-8");
        let note = says.lines().last().unwrap_or_default();
        for part in [&format!("SIG{signal}"), "circle.yml", "scene00.yml"] {
            assert!(note.contains(part), "{note}");
        }
        assert_eq!(temporary(&running.place), Vec::<String>::new());
        let notes = std::fs::read_to_string(&running.notes).expect("notes");
        let notes: Vec<&str> = notes.lines().collect();
        assert!(!lives(notes[0]) && !lives(notes[1]), "{signal}");
        let given = Path::new(notes[2]);
        assert!(!given.parent().expect("a folder").exists(), "{signal}");
    }
}

#[test]
fn what_a_killed_run_leaves_is_removed_by_the_next_and_nothing_else_is() {
    if !tools() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let mut running = start(folder.path());
    let next = || {
        let (code, _, err) = output(&[
            "run",
            "scenes/oscillator/circle.yml",
            "--integrators",
            "rk4",
            "--engines",
            "none",
            "--output",
            word(folder.path()),
        ]);
        assert_eq!(code, 0, "{err}");
    };
    // The file of a run that goes on is its own.
    let held = temporary(&running.place);
    next();
    assert_eq!(temporary(&running.place), held);
    running.child.kill().expect("killed");
    running.child.wait().expect("it ends");
    assert_eq!(temporary(&running.place), held);
    let notes = std::fs::read_to_string(&running.notes).expect("notes");
    let notes: Vec<&str> = notes.lines().collect();
    let given = Path::new(notes[2]);
    assert!(given.exists());
    next();
    assert_eq!(temporary(&running.place), Vec::<String>::new());
    // What programs were given, and the folder of it, goes with the next that is started.
    let (_, _, err) = output(&[
        "run",
        "scenes/oscillator/circle.yml",
        "--integrators",
        "rk4",
        "--engines",
        "none",
        "--no-files",
        "--external",
        "p=true {scene_json}",
    ]);
    assert!(!given.parent().expect("a folder").exists(), "{err}");
    // Nobody tidies the programs of a run that was killed.
    notes[..2].iter().for_each(|process| send("KILL", process));
}

/// A program that has ended, while what it left in the background is still to write {output}.
#[test]
fn a_signal_while_output_is_read_ends_what_the_program_left() {
    if !tools() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let id = folder.path().join("id");
    let script = "mkfifo \"$1\"; (exec >/dev/null 2>&1; exec sleep 1000 >\"$1\") & \
                  echo $! > \"$0.x\"; mv \"$0.x\" \"$0\"";
    let script = script.replace('\'', "'\\''");
    let external = format!("p=sh -c '{script}' '{}' {{output}}", id.display());
    let child = Command::new(springcheck_path())
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(["run", "scenes/oscillator/circle.yml", "--no-files"])
        .args(["--integrators", "rk4", "--engines", "none"])
        .args(["--external", &external])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it starts");
    // The pipe is open on both sides as soon as `sh` has become `sleep`: then it is being read.
    let begun = Instant::now();
    let left = loop {
        assert!(begun.elapsed() < LONG, "it does not begin");
        std::thread::sleep(Duration::from_millis(10));
        let id = std::fs::read_to_string(&id).unwrap_or_default();
        let mut ps = Command::new("ps");
        let named = ps.args(["-o", "comm=", "-p", id.trim()]).output();
        let named = named.expect("ps runs").stdout;
        if String::from_utf8_lossy(&named).trim() == "sleep" {
            break id.trim().to_owned();
        }
    };
    send("INT", &child.id().to_string());
    let ended = child.wait_with_output().expect("it ends");
    assert_eq!(ended.status.code(), Some(130));
    // The system may take a moment to end it.
    let begun = Instant::now();
    while lives(&left) {
        assert!(begun.elapsed() < LONG, "it lives on");
        std::thread::sleep(Duration::from_millis(10));
    }
}
