//! `rest`: the scene it writes, and what it refuses.

use crate::testkit::program::{output, refuse_all, word};
use std::path::{Path, PathBuf};

const HANGING: &str = "scenes/string/hanging.yml";

fn rest(args: &[&str]) -> (i32, String, String) {
    output(&[&["rest", "--no-files"], args].concat())
}

fn written(folder: &Path, release: &[&str]) -> PathBuf {
    let file = folder.join("rest.yml");
    let (code, _, err) = rest(&[&[HANGING, "--write", word(&file)], release].concat());
    assert_eq!(code, 0, "{err}");
    file
}

#[test]
fn a_scene_written_at_rest_is_at_rest() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = written(folder.path(), &[]);
    let (code, text, _) = rest(&[word(&file)]);
    assert_eq!(code, 0);
    assert!(
        text.contains("all forces are balanced at the start"),
        "{text}"
    );
    // Nothing is expected of it that was of the other.
    let (code, ..) = output(&["check", word(&file)]);
    assert_eq!(code, 0);
}

#[test]
fn what_is_released_falls() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = written(folder.path(), &["--release", "string[0]"]);
    let again = folder.path().join("again.yml");
    let (code, text, err) = rest(&[word(&file), "--write", word(&again)]);
    assert_eq!(code, 1);
    assert!(text.contains("NO REST: nothing holds particle"), "{text}");
    assert!(err.contains("nothing is written"), "{err}");
    assert!(!again.exists());
}

#[test]
fn what_cannot_be_written_or_released_is_said() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = folder.path().join("scene.yml");
    std::fs::copy(HANGING, &scene).expect("copied");
    let file = folder.path().join("rest.yml");
    let (scene, file) = (word(&scene), word(&file));
    let cases: [(&[&str], &str); 8] = [
        (&["rest", scene, "--write", scene], "the scene itself"),
        (&["rest", scene, "--release", "0"], "--write"),
        (
            &["rest", scene, "--write", file, "--release", "string[1]"],
            "not fixed",
        ),
        (
            &["rest", scene, "--write", file, "--release", "99"],
            "has 11 particles",
        ),
        (
            &["rest", scene, "--write", file, "--release", "strnig[0]"],
            "string",
        ),
        (
            &["rest", scene, "--write", file, "--release", "0,"],
            "ids with commas",
        ),
        (&["rest", scene, "--refine", "0"], "expected 1 to"),
        (
            &["rest", "scenes/pa1/scene01.yml", "--refine", "2"],
            "no objects",
        ),
    ];
    for (args, says) in cases {
        refuse_all(args, &[says]);
    }
    assert!(!Path::new(file).exists());
}
