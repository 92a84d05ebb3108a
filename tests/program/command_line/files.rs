//! Where files go, and what happens where they cannot be written.

use super::{SCENE, short};
use crate::testkit::program::{answer, files, output, refuse_all, report, springcheck, word};
use std::path::Path;

#[test]
fn no_two_scenes_share_a_folder() {
    let folder = tempfile::tempdir().expect("a folder");
    // As the program sees it, without links.
    let root = folder.path().canonicalize().expect("a path");
    let here = root.join("here");
    let text = std::fs::read_to_string(SCENE).expect("a scene");
    let scenes = [
        "here/x.yml",
        "here/x.yaml",
        "here/scenes/x.yml",
        "here/scenes/y.yml",
        "x.yml",
        "here/..yml",
        "here/...yml",
        "here/.yml",
    ];
    for scene in scenes {
        let path = root.join(scene);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        std::fs::write(path, &text).expect("written");
    }
    let named = [
        "x.yml",
        "x.yaml",
        "scenes/x.yml",
        "scenes/y.yml",
        "../x.yml",
        "..yml",
        "...yml",
        ".yml",
    ];
    let args = short(&[&named[..], &["--output", "out", "--quiet"]].concat());
    let (code, out, err) = answer(springcheck().current_dir(&here).args(args));
    assert_eq!(code, 0, "{err}");
    assert_eq!(out.lines().count(), named.len());
    let outside = Path::new("@root").join(root.strip_prefix("/").expect("absolute"));
    let outside = outside.join("x");
    // `scenes/y.yml` is alone in losing its folder.
    let places = [
        "x",
        "x.yaml",
        "scenes/x",
        "y",
        word(&outside),
        "..yml",
        "...yml",
        ".yml",
    ];
    for (place, scene) in places.iter().zip(named) {
        let file = here.join("out").join(place).join("report.json");
        let text = std::fs::read_to_string(&file).expect("a report");
        assert_eq!(report(&text)["scene"]["file"], scene);
    }
    // A scene by several names runs once, under the first.
    let whole = here.join("x.yml");
    let names = ["./x.yml", "../here/x.yml", word(&whole)];
    let several = short(&[&names[..], &["--output", "out", "--quiet"]].concat());
    let (code, out, err) = answer(springcheck().current_dir(&here).args(several));
    assert_eq!((code, out.lines().count()), (0, 1), "{err}");
    assert!(out.starts_with("x.yml: "), "{out}");
}

#[test]
fn without_files_there_is_the_table_alone() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join(SCENE);
    for flags in [&["--no-files"][..], &["--output", "none"]] {
        let args = short(&[&[word(&scene)], flags].concat());
        let (code, out, err) = answer(springcheck().current_dir(folder.path()).args(args));
        assert_eq!((code, err.as_str()), (0, ""));
        assert!(out.contains("rk4") && !out.contains("report: "), "{out}");
        assert!(files(folder.path()).is_empty());
    }
    refuse_all(&short(&[SCENE, "--no-files", "--save", "csv"]), &["--save"]);
    let both = short(&[SCENE, "--no-files", "--output", "x"]);
    refuse_all(&both, &["--output"]);
}

#[test]
fn what_cannot_be_written_is_said_before_the_work_or_else_after_the_table() {
    let folder = tempfile::tempdir().expect("a folder");
    // A file is no folder.
    let file = folder.path().join("file");
    std::fs::write(&file, "").expect("written");
    let into = ["--output", word(&file)];
    for verb in ["run", "stability", "rest", "cost"] {
        refuse_all(&[&[verb, SCENE][..], &into].concat(), &["cannot write to"]);
    }
    // A folder stands where a file has to go: seen only when it is written.
    let place = folder.path().join("oscillator/circle");
    let into = ["--output", word(folder.path())];
    let cases = [
        (short(&[SCENE]), "report.md"),
        (short(&[SCENE, "--save", "csv"]), "rk4@0.01.csv"),
        (vec!["cost", SCENE, "--timestep", "0.1"], "cost.md"),
        (
            vec!["stability", SCENE, "--integrators", "rk4"],
            "stability.md",
        ),
    ];
    for (args, name) in cases {
        std::fs::create_dir_all(place.join(name).join("x")).expect("made");
        let (code, out, err) = output(&[&args[..], &into].concat());
        assert_eq!(code, 2, "{args:?}");
        assert!(out.contains("rk4") && out.contains("next: "), "{out}");
        assert!(!out.contains("report: "), "{out}");
        let says = if name.ends_with("csv") {
            "--save"
        } else {
            name
        };
        assert!(err.contains(says), "{args:?}: {err}");
        std::fs::remove_dir_all(&place).expect("removed");
    }
}

#[test]
fn a_folder_means_its_scenes_and_several_scenes_end_with_a_line_each() {
    let folder = tempfile::tempdir().expect("a folder");
    let root = folder.path();
    let text = std::fs::read_to_string(SCENE).expect("a scene");
    std::fs::create_dir_all(root.join("b/deep")).expect("made");
    for name in [
        "c.yml",
        "b/deep/a.yaml",
        "b/z.yml",
        "b/no.txt",
        ".hidden.yml",
    ] {
        std::fs::write(root.join(name), &text).expect("written");
    }
    let wanted = ["b/deep/a.yaml", "b/z.yml", "c.yml"].map(|name| root.join(name));
    let wanted = wanted.each_ref().map(|path| word(path));
    let scenes = |text: &str| -> Vec<String> {
        let heads = text.lines().map(|line| line.split(": ").next());
        heads
            .map(|head| head.unwrap_or_default().to_owned())
            .collect()
    };
    // Quiet: these lines and nothing else.
    let (code, lines, err) = output(&short(&[word(root), "--no-files", "-q"]));
    assert_eq!((code, err.as_str()), (0, ""));
    assert_eq!(scenes(&lines), wanted);
    let (_, text, _) = output(&short(&[word(root), "--no-files"]));
    let last = text.rsplit("\n\n").next().unwrap_or_default();
    assert_eq!(last, lines);
    assert!(lines.lines().all(|line| line.ends_with('.')), "{lines}");
    // A scene that is stated twice runs once.
    let both = short(&[wanted[0], word(root), "--no-files", "-q"]);
    assert_eq!(scenes(&output(&both).1), wanted);
    let empty = root.join("empty");
    std::fs::create_dir(&empty).expect("made");
    refuse_all(
        &short(&[word(&empty)]),
        &["no scene in this folder", "*.yml"],
    );
}

#[cfg(target_os = "linux")]
#[test]
fn a_working_directory_that_was_removed_does_not_move_the_output() {
    let folder = tempfile::tempdir().expect("a folder");
    let [gone, scenes, out] = ["gone", "scenes", "out"].map(|name| folder.path().join(name));
    for made in [&gone, &scenes] {
        std::fs::create_dir(made).expect("made");
    }
    let scene = scenes.join("s.yml");
    std::fs::copy(SCENE, &scene).expect("copied");
    let program = crate::testkit::program::springcheck_path();
    let args = short(&[word(&scene), "--output", word(&out)]).join("' '");
    let removed = format!("rmdir ../gone; '{}' '{args}'", program.display());
    let status = std::process::Command::new("sh")
        .args(["-c", &removed])
        .current_dir(&gone)
        .output()
        .expect("sh runs");
    assert_eq!(status.status.code(), Some(0));
    assert_eq!(files(&scenes), ["s.yml".to_owned()].into());
    assert_eq!(files(&out), ["@root".to_owned()].into());
}

#[cfg(unix)]
#[test]
fn a_scene_of_a_folder_that_cannot_be_read_is_an_error() {
    for kind in ["link", "pipe"] {
        let folder = tempfile::tempdir().expect("a folder");
        let root = folder.path();
        std::fs::copy(SCENE, root.join("a.yml")).expect("copied");
        let bad = root.join("b.yml");
        match kind {
            "link" => std::os::unix::fs::symlink("nowhere.yml", &bad).expect("linked"),
            _ => {
                let made = std::process::Command::new("mkfifo").arg(&bad).status();
                assert!(made.is_ok_and(|status| status.success()));
            }
        }
        // Who names a pipe may feed it.
        let named = (kind == "link").then_some(bad.as_path());
        for path in [Some(root), named].into_iter().flatten() {
            let mut command = springcheck();
            command.timeout(std::time::Duration::from_secs(60));
            let (code, out, err) = answer(command.args(["check", word(path)]));
            assert_eq!((code, out.as_str()), (2, ""), "{kind}: {err}");
            assert!(err.contains("b.yml"), "{kind}: {err}");
        }
    }
}

#[test]
fn one_scene_is_checked_once_under_its_first_name_and_one_key() {
    let folder = tempfile::tempdir().expect("a folder");
    let root = folder.path().canonicalize().expect("a path");
    let whole = root.join("s.yml");
    std::fs::copy(SCENE, &whole).expect("copied");
    let check = |paths: &[&str], more: &[&str]| {
        let mut command = springcheck();
        let args = [&["check"], paths, more].concat();
        answer(command.current_dir(&root).env_remove("CI").args(args))
    };
    let (code, out, err) = check(&["./s.yml", word(&whole), "."], &[]);
    assert_eq!(code, 0, "{err}");
    assert!(out.starts_with("pass  s.yml  "), "{out}");
    assert!(
        out.ends_with("1 scene: 1 passed, 0 failed, 0 skipped\n"),
        "{out}"
    );
    // The key of the baseline is the same, however the scene was named.
    assert_eq!(check(&["./s.yml"], &["--accept", "base.json"]).0, 0);
    for path in ["s.yml", "././s.yml", "."] {
        let (code, out, err) = check(&[path], &["--baseline", "base.json"]);
        assert_eq!(code, 0, "{path}: {out}{err}");
    }
}
