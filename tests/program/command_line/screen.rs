//! The layout on a terminal and off it.

use crate::testkit::program::{output, word};
use serde_json::Value;

/// What the program prints on a terminal of so many columns.
#[cfg(unix)]
fn on_terminal(columns: u32, args: &str) -> Option<String> {
    let program = crate::testkit::program::springcheck_path();
    let command = format!(
        "stty rows 40 cols {columns}; '{}' {args}",
        program.display()
    );
    if !crate::testkit::program::has("script", &["-qec", "true", "/dev/null"]) {
        return None;
    }
    let answer = std::process::Command::new("script")
        .args(["-qec", &command, "/dev/null"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .env(
            "SPRINGCHECK_CACHE",
            concat!(env!("CARGO_TARGET_TMPDIR"), "/cache"),
        )
        .env("NO_COLOR", "1")
        .stdin(std::process::Stdio::null())
        .output()
        .expect("script runs");
    let text = String::from_utf8(answer.stdout).expect("UTF-8");
    Some(text.replace('\r', ""))
}

#[cfg(unix)]
#[test]
fn a_report_is_as_wide_as_the_terminal() {
    for args in [
        "run scenes/pa1/scene01.yml --duration 0.1 --no-files",
        "stability scenes/oscillator/circle.yml --integrators rk4 --engines none --vary springs.stiffness=1..9:40 --steps 0.1..1:4 --budget 1e5 --no-files",
        "rest scenes/hair/clamped.yml --refine 1,2,4 --no-files",
        "cost scenes/oscillator/circle.yml --timestep 0.1,0.05 --no-files",
        "run scenes/pa1/scene01.yml scenes/pa1/scene00.yml --duration 0.1 --no-files",
        "run --help",
        "list integrators",
    ] {
        let mut widest = Vec::new();
        for columns in [60, 80, 100, 130] {
            let Some(text) = on_terminal(columns, &format!("{args} 2>/dev/null")) else {
                return;
            };
            let width = text.lines().map(|line| line.chars().count()).max();
            let width = width.unwrap_or(0) as u32;
            assert!(width <= columns, "{args}: {width}\n{text}");
            widest.push(width);
        }
        assert!(widest[1] > 60, "{args}: {widest:?}");
        // Help has lines of at most 100 columns; what follows the terminal makes use of more.
        if args.starts_with("run scenes") {
            assert!(widest[3] > 100, "{args}: {widest:?}");
        }
    }
    // Columns of the table are left out, and whole words stand in the others.
    let text = on_terminal(80, "run scenes/pa1/scene01.yml --duration 0.1 --no-files");
    let text = text.unwrap_or_default();
    let (table, below) = text.split_once("own integrator |").unwrap_or_default();
    assert!(below.contains("left out for width: "), "{text}");
    assert!(table.contains("symplectic_euler  completed"), "{text}");
    assert!(!table.contains('…'), "{text}");
}

/// Work of a few seconds shows that it goes on, whatever was expected of it, and leaves nothing of that.
#[cfg(unix)]
#[test]
fn a_terminal_shows_that_work_goes_on() {
    let run = "run scenes/oscillator/circle.yml --integrators rk4 --engines none --no-files";
    let waits = format!("{run} --external p='sleep 4'");
    let Some(text) = on_terminal(100, &waits) else {
        return;
    };
    assert!(text.contains("so far"), "{text}");
    let after = text.rsplit("so far)").next().unwrap_or_default();
    // ECMA-48's "erase in line".
    assert!(after.contains("\u{1b}[2K"), "{after:?}");
    let quiet = on_terminal(100, &format!("{waits} -q")).unwrap_or_default();
    assert!(!quiet.contains("so far"), "{quiet}");
}

/// The lengths of the lines of a table, with every timing's spread at its widest and at its narrowest.
#[test]
fn the_layout_does_not_depend_on_how_times_spread() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("report.json");
    let args = [
        "run",
        "scenes/pa1/scene01.yml",
        "--duration",
        "0.1",
        "--format",
        "json",
    ];
    let (_, json, _) = output(&args);
    let shown = |spread: f64| {
        let mut document: Value = serde_json::from_str(&json).expect("JSON");
        for outcome in document["reports"][0]["outcomes"]
            .as_array_mut()
            .expect("outcomes")
        {
            let wall = &mut outcome["work"]["wall_s"];
            *wall = serde_json::json!({"min": 1e-3, "median": 1.23e-3, "mad": spread * 1.23e-3});
        }
        std::fs::write(&file, document.to_string()).expect("written");
        let (_, text, _) = output(&["show", word(&file)]);
        let table = text
            .lines()
            .take_while(|line| !line.starts_with('▸') || line.contains("completed"));
        table
            .map(|line| line.split("1.23 ms").next().unwrap_or_default().to_owned())
            .collect::<Vec<_>>()
    };
    let narrow = shown(0.0);
    assert!(narrow.len() > 8, "{narrow:?}");
    for spread in [0.2, 0.99, 7.0, 5e3] {
        assert_eq!(shown(spread), narrow);
    }
}
