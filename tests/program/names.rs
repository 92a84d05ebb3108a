//! Texts call the particles of objects by their names; data have ids.

use crate::testkit::program::{altered, json_of, output, word};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A particle without a name, which has id 0, and a rope of five behind it: `rope[n]` has id n + 1.
fn scene(folder: &Path, stiffness: &str) -> PathBuf {
    let text = format!(
        "solver: {{type: explicit_euler, timestep: 0.01}}
duration: 0.5
plot: {{particle_id: \"rope[4]\", dof: 2}}
particles: [{{pos: [5, 0, 0], fixed: true}}]
objects:
- string: {{name: rope, from: [0, 0, 1], to: [0.3, 0, 0], particles: 5, mass: 1, stiffness: {stiffness},
    damping: 1, drag: 1e-20, pins: [start]}}
expect: {{explicit_euler: {{status: completed}}}}
"
    );
    let path = folder.join("scene.yml");
    std::fs::write(&path, text).expect("written");
    path
}

/// The ids behind the word `particle` in a text.
fn ids(text: &str) -> Vec<usize> {
    let words = text.split("particle").skip(1);
    let number = |rest: &str| {
        let rest = rest.trim_start_matches('s').strip_prefix([' ', '\n'])?;
        let end = rest.find(|c: char| !c.is_ascii_digit());
        rest[..end.unwrap_or(rest.len())].parse().ok()
    };
    words.filter_map(number).collect()
}

/// The text says this name, and no id of a particle that has one.
fn says(text: &str, name: &str) {
    // Markdown escapes brackets, and a terminal breaks lines anywhere between words.
    let plain = text.replace('\\', "");
    let plain = plain.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        plain.contains(&format!("particle {name}")),
        "{name}: {text}"
    );
    assert!(ids(&plain).iter().all(|id| *id == 0), "{text}");
}

fn text(args: &[&str], format: &str) -> String {
    // The gate writes no files.
    let quiet: &[&str] = match args[0] {
        "check" => &[],
        _ => &["--no-files"],
    };
    let (_, out, err) = output(&[args, quiet, &["--format", format]].concat());
    assert!(!out.is_empty(), "{args:?}: {err}");
    out
}

/// The name of the particle whose id stands in this sentence of the data.
fn named(sentence: &Value) -> String {
    let sentence = sentence.as_str().expect("a sentence");
    let found = ids(sentence);
    let [id] = found[..] else {
        panic!("{sentence}")
    };
    format!("rope[{}]", id - 1)
}

#[test]
fn every_text_has_names_where_the_data_have_ids() {
    let folder = tempfile::tempdir().expect("a folder");
    // Explicit Euler and RK4 blow up, and the data say where.
    let scene = scene(folder.path(), "1e6");
    let run = [
        "run",
        word(&scene),
        "--integrators",
        "explicit_euler,rk4",
        "--columns",
        "reaction",
    ];
    let (_, report) = json_of(&run);
    let bodies = serde_json::json!([{"name": "rope", "first": 1, "shape": [5]}]);
    assert_eq!(report["scene"]["objects"], bodies);
    let fastest = named(&report["outcomes"][0]["reason"]);
    let check = ["check", word(&scene)];
    for (verb, formats) in [
        (&run[..], &["human", "markdown", "junit", "github"][..]),
        (&check, &["human", "markdown", "junit", "github"]),
    ] {
        for format in formats {
            says(&text(verb, format), &fastest);
        }
    }
    // What holds the rope, which the texts themselves word.
    for format in ["human", "markdown"] {
        says(&text(&run, format), "rope[0] is held");
    }
    // What is read back says the same: the names are in the data.
    let stored = folder.path().join("report.json");
    std::fs::write(&stored, text(&run, "json")).expect("written");
    says(&output(&["show", word(&stored)]).1, &fastest);

    // At rest the rope hangs straight down, and its free end is  farthest.
    let rest = ["rest", word(&scene)];
    for format in ["human", "markdown"] {
        says(&text(&rest, format), "rope[4] is ");
    }

    // The first with a drag that rapier cannot mirror: rope[0] is fixed.
    let stability = ["stability", word(&scene), "--integrators", "rk4"];
    for format in ["human", "markdown"] {
        says(&text(&stability, format), "rope[1]'s drag");
    }
}

#[test]
fn figures_and_errors_have_names() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = scene(folder.path(), "1e6");
    let drawn = folder.path().join("drawn");
    let (code, _, err) = output(&["run", word(&path), "--output", word(&drawn)]);
    assert_eq!(code, 1, "{err}");
    let mut svgs = Vec::new();
    for entry in walk(&drawn) {
        if entry.ends_with("plot.svg") {
            svgs.push(std::fs::read_to_string(&entry).expect("an SVG"));
        }
    }
    assert_eq!(svgs.len(), 1);
    says(&svgs[0], "rope[4], z (m)");

    let text = std::fs::read_to_string(&path).expect("the scene");
    let spring = "springs: [{particle_ids: [2, \"rope[1]\"], stiffness: 1}]\n";
    std::fs::write(&path, text + spring).expect("written");
    let (code, _, err) = output(&["run", word(&path)]);
    assert_eq!(code, 2);
    assert!(err.contains("found rope[1] twice"), "{err}");
}

/// The files below a folder.
fn walk(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let paths = entries.map(|entry| entry.expect("an entry").path());
    paths
        .flat_map(|path| {
            if path.is_dir() {
                walk(&path)
            } else {
                vec![path]
            }
        })
        .collect()
}

#[test]
fn a_comparison_names_what_is_off() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = scene(folder.path(), "100");
    let saved = folder.path().join("saved");
    let run = [
        "run",
        word(&scene),
        "--integrators",
        "rk4",
        "--engines",
        "none",
        "--save",
        "csv",
        "--output",
        word(&saved),
    ];
    output(&run);
    let files = walk(&saved);
    let mut files = files.iter();
    let file = files.find(|path| path.extension().is_some_and(|e| e == "csv"));
    // The particle of id 3 is a metre away in one row.
    let wrong = altered(file.expect("a trajectory"), "wrong.csv", |_, fields| {
        if fields[1] == "3" && fields[0].parse().is_ok_and(|t: f64| (t - 0.2).abs() < 1e-9) {
            let x: f64 = fields[2].parse().expect("a number");
            fields[2] = (x + 1.0).to_string();
        }
    });
    let compare = ["compare", word(&wrong), "--scene", word(&scene)];
    let (_, report) = json_of(&compare);
    assert_eq!(report["fault"]["particle"], 3);
    assert_eq!(named(&report["fault"]["explanation"]), "rope[2]");
    for format in ["human", "markdown"] {
        let text = text(&compare, format);
        // Where it is, and what is wrong with it.
        says(&text, "rope[2]");
        assert!(text.matches("rope").count() >= 2, "{text}");
    }
}
