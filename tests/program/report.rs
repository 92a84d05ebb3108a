//! `springcheck report`: one page of a scene with its motion in it, and an index of several.

use crate::testkit::program::{output, refuse, springcheck, word};
use serde_json::Value;
use std::path::Path;

/// Two scenes of one oscillator, the second with a name that would be markup.
fn scenes(folder: &Path) -> [String; 2] {
    ["plain", "<script>alert(1)</script>"].map(|name| {
        let file = folder.join(format!("{}.yml", if name == "plain" { "a" } else { "b" }));
        let text = format!(
            "name: '{name}'\nsolver: {{type: rk4, timestep: 0.05, gravity: 0}}\nduration: 1\n\
             particles: [{{pos: [0, 0, 0], fixed: true}}, {{pos: [0.5, 0, 0], mass: 1}}]\n\
             springs: [{{particle_ids: [0, 1], stiffness: 50, rest_length: 0}}]\n"
        );
        std::fs::write(&file, text).expect("a scene");
        word(&file).to_owned()
    })
}

/// What lies between two texts.
fn between<'a>(text: &'a str, begin: &str, end: &str) -> &'a str {
    let (_, rest) = text.split_once(begin).expect("the beginning");
    rest.split_once(end).expect("the end").0
}

#[test]
fn a_page_of_each_scene_and_an_index_of_both() {
    let folder = tempfile::tempdir().expect("a folder");
    let [a, b] = scenes(folder.path());
    let to = folder.path().join("pages");
    let args = ["-q", "report", &a, &b, "--budget", "500ms", "--output"];
    springcheck().args(args).arg(&to).assert().success();
    let index = std::fs::read_to_string(to.join("index.html")).expect("an index");
    assert!(index.contains("2 scenes") && !index.contains("<script>alert"));
    let mut links = 0;
    for part in index.split("<a href=\"").skip(1) {
        let link = part.split('"').next().expect("a link").replace("%40", "@");
        let page = std::fs::read_to_string(to.join(&link)).expect("the page of a link");
        links += 1;
        for id in ["report-0", "report-1", "report-2"] {
            assert!(page.contains(&format!("<article id=\"{id}\">")), "{id}");
        }
        // Two scripts of its own: what is played, and what plays it.
        assert_eq!(page.matches("<script").count(), 2, "{link}");
        assert!(!page.contains("src=") && !page.contains("@import"));
        let played = between(&page, "type=\"application/json\">", "</script>");
        let played: Value = serde_json::from_str(played).expect("JSON");
        let engines = played["engines"].as_array().expect("engines");
        let ids: Vec<&str> = engines.iter().filter_map(|e| e["id"].as_str()).collect();
        assert_eq!(ids[0], "rk4");
        assert!(ids.contains(&"rapier") && ids.contains(&"truth"), "{ids:?}");
        let t = played["t"].as_array().expect("times");
        // All 20 steps and the start.
        assert_eq!((t.len(), t[20].as_f64()), (21, Some(1.0)));
    }
    assert_eq!(links, 2);
}

#[test]
fn a_page_on_stdout_has_its_figures_and_motion() {
    let folder = tempfile::tempdir().expect("a folder");
    let [a, _] = scenes(folder.path());
    let (_, page, _) = output(&["run", &a, "--format", "html"]);
    for part in [
        "<figure><svg",
        "id=\"player\"",
        "id=\"playback\"",
        "data-engine=\"rk4\"",
    ] {
        assert!(page.contains(part), "{part}");
    }
}

#[test]
fn a_scene_that_is_none_is_refused_before_anything_runs() {
    let folder = tempfile::tempdir().expect("a folder");
    let [a, _] = scenes(folder.path());
    refuse("report", &[(&[&a, "missing.yml"], "missing.yml")]);
}
