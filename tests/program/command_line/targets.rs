//! Files that somebody names: what they may be, and when it is said that they cannot be written.

use super::{SCENE, short};
use crate::testkit::program::{answer, files, output, refuse_all, springcheck, word};
use std::path::{Path, PathBuf};

/// The gate on a copy of a scene in this folder.
fn check(folder: &Path, more: &[&str]) -> (i32, String, String) {
    let scene = folder.join("s.yml");
    std::fs::copy(SCENE, &scene).expect("copied");
    let mut command = springcheck();
    command.current_dir(folder).env_remove("CI");
    answer(command.args(["check", "s.yml"]).args(more))
}

/// What is no JSON of reports fails here.
fn is_report(path: &Path) -> bool {
    let text = std::fs::read(path).unwrap_or_default();
    serde_json::from_slice::<serde_json::Value>(&text).is_ok_and(|json| json["reports"].is_array())
}

#[cfg(unix)]
#[test]
fn links_are_followed_and_what_is_no_regular_file_is_written_into() {
    use std::os::unix::fs::{FileTypeExt, PermissionsExt, symlink};
    let folder = tempfile::tempdir().expect("a folder");
    let root = folder.path();
    std::fs::create_dir(root.join("far")).expect("made");
    let real = root.join("far/real.json");
    std::fs::write(&real, "before").expect("written");
    std::fs::set_permissions(&real, PermissionsExt::from_mode(0o640)).expect("set");
    symlink("far/real.json", root.join("link")).expect("linked");
    symlink("link", root.join("link2")).expect("linked");
    symlink("far/new.json", root.join("dangling")).expect("linked");
    symlink("circle", root.join("circle")).expect("linked");
    let is_link = |name: &str| {
        root.join(name)
            .symlink_metadata()
            .is_ok_and(|m| m.is_symlink())
    };

    // The last file of a chain is replaced whole, beside itself, and keeps its permissions.
    let (code, _, err) = check(root, &["--write", "json=link2", "--accept", "dangling"]);
    assert_eq!(code, 0, "{err}");
    assert!(is_link("link") && is_link("link2") && is_link("dangling"));
    assert!(is_report(&real) && root.join("far/new.json").is_file());
    let mode = real.metadata().expect("a file").permissions().mode();
    assert_eq!(mode & 0o777, 0o640);
    assert_eq!(
        files(&root.join("far")).len(),
        2,
        "nothing temporary is left"
    );
    let (code, _, err) = check(root, &["--write", "json=circle"]);
    assert_eq!(code, 2, "{err}");
    assert!(is_link("circle"));

    // A report's files too.
    let place = root.join("out/s");
    std::fs::create_dir_all(&place).expect("made");
    symlink("../../far/page.md", place.join("report.md")).expect("linked");
    let args = short(&["s.yml", "--output", "out", "--save", "csv"]);
    symlink("../../far/rows.csv", place.join("rk4@0.01.csv")).expect("linked");
    assert_eq!(answer(springcheck().current_dir(root).args(args)).0, 0);
    assert!(is_link("out/s/report.md") && is_link("out/s/rk4@0.01.csv"));
    assert!(root.join("far/page.md").is_file() && root.join("far/rows.csv").is_file());

    // A pipe stays one, and its reader gets the whole.
    let pipe = root.join("pipe");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    assert!(made.is_ok_and(|status| status.success()));
    let reader = {
        let pipe = pipe.clone();
        std::thread::spawn(move || std::fs::read(pipe).expect("read"))
    };
    assert_eq!(check(root, &["--write", "json=pipe"]).0, 0);
    let got = reader.join().expect("it ends");
    assert!(serde_json::from_slice::<serde_json::Value>(&got).is_ok());
    assert!(
        pipe.symlink_metadata()
            .expect("there")
            .file_type()
            .is_fifo()
    );
}

/// A full device and stdout, by names of this test's own: those in /dev would be lost to a mistake.
#[cfg(target_os = "linux")]
#[test]
fn a_full_device_is_an_error_and_stdout_is_written_into() {
    use std::os::unix::fs::{FileTypeExt, symlink};
    use std::process::{Command, Stdio};
    let folder = tempfile::tempdir().expect("a folder");
    let root = folder.path();
    // The numbers of /dev/full. Only an administrator makes devices.
    let full = root.join("full");
    let made = Command::new("mknod")
        .arg(&full)
        .args(["c", "1", "7"])
        .stderr(Stdio::null())
        .status();
    let opened = std::fs::File::options().write(true).open(&full);
    if made.is_ok_and(|status| status.success()) && opened.is_ok() {
        symlink("full", root.join("link")).expect("linked");
        for flags in [
            ["--write", "junit=full"],
            ["--accept", "full"],
            ["--write", "junit=link"],
        ] {
            let (code, _, err) = check(root, &flags);
            assert_eq!(code, 2, "{err}");
            assert!(err.contains("No space left on device"), "{err}");
            assert!(
                full.symlink_metadata()
                    .expect("there")
                    .file_type()
                    .is_char_device()
            );
        }
    } else {
        eprintln!("NOT TESTED: no device can be made here");
    }
    // What is printed and what goes to the same open file are both there.
    check(root, &[]);
    symlink("/proc/self/fd/1", root.join("stdout")).expect("linked");
    let out = root.join("out.txt");
    let ended = Command::new(crate::testkit::program::springcheck_path())
        .current_dir(root)
        .env_remove("CI")
        .args(["check", "s.yml", "--quiet", "--write", "jsonl=stdout"])
        .stdout(std::fs::File::create(&out).expect("made"))
        .status();
    assert_eq!(ended.expect("it runs").code(), Some(0));
    let text = std::fs::read_to_string(&out).expect("UTF-8");
    assert!(
        text.contains("1 scene: 1 passed") && text.contains("\"reports\""),
        "{text}"
    );
    for flag in ["--help", "--version"] {
        let full = std::fs::File::options()
            .write(true)
            .open("/dev/full")
            .expect("Linux");
        let status = Command::new(crate::testkit::program::springcheck_path())
            .arg(flag)
            .stdout(full)
            .stderr(Stdio::null())
            .status();
        assert_eq!(status.expect("it runs").code(), Some(2), "{flag}");
    }
}

#[test]
fn nothing_that_is_read_or_written_otherwise_is_written_over() {
    let folder = tempfile::tempdir().expect("a folder");
    let root = folder.path();
    check(root, &["--accept", "base.json"]);
    let args = ["--output", "out", "--save", "csv"];
    let run = short(&[&["s.yml"], &args[..]].concat());
    assert_eq!(answer(springcheck().current_dir(root).args(run)).0, 0);
    std::fs::copy(root.join("out/s/rk4@0.01.csv"), root.join("tr.csv")).expect("copied");
    let names = ["s.yml", "tr.csv", "base.json"].map(|name| root.join(name));
    let read = |path: &PathBuf| std::fs::read(path).expect("read");
    let before = names.each_ref().map(read);
    let whole = format!(
        "json={}",
        word(&root.canonicalize().expect("a path").join("s.yml"))
    );
    let cases: [&[&str]; 9] = [
        &["--write", "json=s.yml"],
        &["--write", "json=./out/../s.yml"],
        &["--write", &whole],
        // It is not of this part.
        &["t.yml", "--partition", "slice:2/2", "--write", "json=s.yml"],
        &["--accept", "s.yml"],
        &["--trajectory", "m=tr.csv", "--write", "json=tr.csv"],
        &["--baseline", "base.json", "--write", "json=base.json"],
        &["--accept", "x.json", "--write", "json=x.json"],
        &["--write", "json=x.json", "--write", "junit=./x.json"],
    ];
    std::fs::copy(SCENE, root.join("t.yml")).expect("copied");
    for more in cases {
        let (code, out, err) = check(root, more);
        assert_eq!((code, out.as_str()), (2, ""), "{more:?}: {err}");
        assert!(err.contains("the file would be lost"), "{more:?}: {err}");
    }
    assert_eq!(names.each_ref().map(read), before);
    assert!(!root.join("x.json").exists());
    let (code, _, err) = check(root, &["--baseline", "base.json", "--accept", "base.json"]);
    assert_eq!(code, 0, "{err}");
}

#[test]
fn what_cannot_be_written_is_said_before_the_work() {
    let folder = tempfile::tempdir().expect("a folder");
    let root = folder.path();
    std::fs::create_dir(root.join("there")).expect("made");
    std::fs::write(root.join("file"), "").expect("written");
    for path in ["there", "no/x", "file/x", "..", ""] {
        for flags in [["--write", &format!("json={path}")], ["--accept", path]] {
            let (code, out, err) = check(root, &flags);
            assert_eq!((code, out.as_str()), (2, ""), "{flags:?}: {err}");
            assert!(!err.contains(".springcheck-"), "{err}");
        }
    }
    let wrong = ["check", SCENE, "--write", "junti=x"];
    refuse_all(&wrong, &["unknown format `junti`", "mean `junit`"]);
}

#[test]
fn init_writes_everything_or_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let root = folder.path();
    std::fs::write(root.join(".github"), "a file").expect("written");
    for name in [".", "new/deep"] {
        if name != "." {
            std::fs::create_dir_all(root.join("new")).expect("made");
            std::fs::write(root.join("new/deep"), "a file").expect("written");
        }
        let (code, out, err) = answer(springcheck().current_dir(root).args(["init", name]));
        assert_eq!((code, out.as_str()), (2, ""), "{err}");
        assert!(err.contains("nothing was written"), "{err}");
    }
    assert_eq!(files(root), [".github", "new"].map(str::to_owned).into());
    assert_eq!(files(&root.join("new")).len(), 1);
}

#[test]
fn a_name_with_a_line_end_stays_on_one_line() {
    for args in [
        ["check", "a\nx.yml"],
        ["explain", "a\nb"],
        ["show", "a\nx.json"],
        ["merge", "a\nx.json"],
    ] {
        let (code, _, err) = output(&args);
        assert_eq!(code, 2);
        assert_eq!(err.lines().count(), 1, "{args:?}: {err}");
    }
}

/// A disk that is full when the archive is packed: the scratch files, half as large, still had room.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_said_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let program = crate::testkit::program::springcheck_path();
    let words = [
        "run",
        SCENE,
        "--integrators",
        "rk4",
        "--engines",
        "none",
        "--save",
        "npz",
    ];
    // 501 instants of two particles: 24 kB of positions, as much of velocities, 52 kB in all. POSIX counts in 512 bytes.
    let command = format!(
        "trap '' XFSZ; ulimit -f 80; exec '{}' '{}' --output '{}'",
        program.display(),
        words.join("' '"),
        word(folder.path())
    );
    let ended = std::process::Command::new("sh")
        .args(["-c", &command])
        .output();
    let ended = ended.expect("sh runs");
    let err = String::from_utf8(ended.stderr).expect("UTF-8");
    assert_eq!(ended.status.code(), Some(2), "{err}");
    assert!(err.contains("--save"), "{err}");
    assert_eq!(err.lines().count(), 1, "{err}");
    assert!(!err.contains(".springcheck-"), "{err}");
}
