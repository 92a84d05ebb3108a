//! What holds for every verb: names that a terminal would act on, files, formats, widths, and help.

mod files;
mod screen;
mod targets;
mod words;

use crate::testkit::program::{array, output, report, word};

const SCENE: &str = "scenes/oscillator/circle.yml";
/// Flags of a run that takes no time worth mentioning.
const SHORT: [&str; 6] = [
    "--integrators",
    "rk4",
    "--engines",
    "none",
    "--duration",
    "0.1",
];

fn short<'a>(args: &[&'a str]) -> Vec<&'a str> {
    [&["run"], args, &SHORT].concat()
}

/// Characters that Unicode's annex 9 and ECMA-48 give a meaning beyond their look.
fn acts(c: char) -> bool {
    let turns = [
        0x61c, 0x200e, 0x200f, 0x202a, 0x202b, 0x202c, 0x202d, 0x202e, 0x2066, 0x2067, 0x2068,
        0x2069,
    ];
    c != '\n' && c.is_control() || turns.contains(&u32::from(c))
}

#[test]
fn no_name_acts_on_a_terminal() {
    let folder = tempfile::tempdir().expect("a folder");
    let nasty = "a\u{1b}[31m\u{202e}b\u{200e}\u{200f}\u{61c}\u{2066}\u{9b}1m\u{7}";
    let scene = folder.path().join(format!("{nasty}.yml"));
    let text = std::fs::read_to_string(SCENE).expect("a scene");
    std::fs::write(&scene, text.replace("name: Circle", "name: \"c\u{202e}d\"")).expect("written");
    let scene = word(&scene).to_owned();
    let missing = format!("{scene}x");
    let out = word(folder.path()).to_owned();
    let flag = format!("--{nasty}");
    let calls: [Vec<&str>; 11] = [
        short(&[&scene, "--output", &out]),
        short(&[&scene, "--no-files", "--quiet"]),
        short(&[&scene, "--format", "json"]),
        short(&[&scene, "--format", "jsonl"]),
        short(&[&scene, "--format", "markdown"]),
        short(&[&missing]),
        short(&[&scene, &flag]),
        vec!["run", &scene, "--integrators", nasty],
        vec!["run", &scene, "--format", nasty],
        vec!["compare", &missing, "--scene", SCENE],
        vec!["stability", &scene, "--vary", nasty, "--no-files"],
    ];
    for args in calls {
        let (_, out, err) = output(&args);
        assert!(!out.is_empty() || !err.is_empty(), "{args:?}");
        for text in [out, err] {
            assert!(!text.contains(acts), "{args:?}: {text:?}");
        }
    }
    // The JSON still holds the name as it is.
    let (_, out, _) = output(&short(&[&scene, "--format", "json"]));
    assert_eq!(report(&out)["scene"]["name"], "c\u{202e}d");
}

#[test]
fn json_says_what_the_texts_say_and_lines_are_reports() {
    let (_, text, _) = output(&short(&[SCENE, "--no-files"]));
    let (_, json, _) = output(&short(&[SCENE, "--format", "json"]));
    let whole = report(&json);
    let next = text
        .lines()
        .last()
        .and_then(|line| line.strip_prefix("next: "));
    assert_eq!(whole["advice"][0].as_str(), next);
    let verdict = whole["verdict"].as_str().expect("a verdict");
    assert!(text.contains(verdict), "{verdict} in\n{text}");
    let plain = text.replace("\n  ", " ");
    for remark in array(&whole["remarks"]) {
        let sentence = remark["sentence"].as_str().expect("a sentence");
        assert!(plain.contains(sentence), "{sentence} in\n{text}");
    }
    let scenes = [SCENE, "scenes/oscillator/oscillator.yml"];
    for call in [
        short(&[&scenes[..], &["--format", "jsonl"]].concat()),
        vec!["cost", SCENE, "--timestep", "0.1", "--format", "jsonl"],
        vec!["stability", SCENE, "--engines", "none", "--format", "jsonl"],
        vec!["rest", SCENE, "--format", "jsonl"],
    ] {
        let (code, text, err) = output(&call);
        assert_eq!(code, 0, "{err}");
        assert!(text.ends_with('\n'));
        for (line, scene) in text.lines().zip(scenes) {
            let of_line = report(line);
            assert_eq!(of_line["scene"]["file"], scene);
            for key in ["verdict", "remarks", "advice"] {
                assert!(!of_line[key].is_null(), "{call:?}: {key}");
            }
        }
        let named = call.iter().filter(|arg| arg.ends_with(".yml")).count();
        assert_eq!(text.lines().count(), named);
    }
}

#[test]
fn a_line_a_scene_is_all_that_quiet_prints() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("report.json");
    let (_, json, _) = output(&short(&[SCENE, "--format", "json"]));
    std::fs::write(&file, json).expect("written");
    for call in [
        vec!["stability", SCENE, "--engines", "none", "--no-files"],
        vec!["cost", SCENE, "--timestep", "0.1", "--no-files"],
        vec!["rest", SCENE, "--no-files"],
        vec!["show", word(&file)],
        vec![
            "compare",
            "tests/program/cases/gravity_9_8.npz",
            "--scene",
            "tests/program/cases/gravity_9_8.yml",
        ],
    ] {
        let (_, text, err) = output(&[&call[..], &["-q"]].concat());
        assert_eq!((text.lines().count(), err.as_str()), (1, ""), "{call:?}");
        assert!(text.contains(".yml: "), "{text}");
    }
}
