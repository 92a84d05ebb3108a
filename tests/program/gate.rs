//! One's own solver in CI: what `init` writes, the example projects, `expand`, and the workflow of `docs/ci.md`.

use crate::testkit::program::{answer, has, output, refuse_all, springcheck, word};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Runs a line in a POSIX shell in a folder, with the program on its path; the exit code, stdout and stderr.
fn shell(line: &str, folder: &Path) -> (i32, String, String) {
    let program = Path::new(env!("CARGO_BIN_EXE_springcheck"));
    let mut path = vec![program.parent().expect("a folder").to_owned()];
    path.extend(std::env::split_paths(
        &std::env::var_os("PATH").unwrap_or_default(),
    ));
    let mut command = assert_cmd::Command::new("sh");
    command
        .args(["-c", line])
        .current_dir(folder)
        .env("PATH", std::env::join_paths(path).expect("a path"))
        .env_remove("CI")
        .env_remove("GITHUB_STEP_SUMMARY");
    answer(&mut command)
}

fn init(folder: &Path, args: &[&str]) -> (i32, String, String) {
    answer(springcheck().arg("init").args(args).current_dir(folder))
}

/// The last line that `init` printed.
fn next(out: &str) -> &str {
    let line = out.lines().last().expect("a line");
    line.strip_prefix("next: ").expect("a command")
}

/// A change of a file's text; it must be one.
fn change(file: &Path, from: &str, to: &str) {
    let text = std::fs::read_to_string(file).expect("text");
    let changed = text.replace(from, to);
    assert_ne!(changed, text);
    std::fs::write(file, changed).expect("written");
}

#[test]
fn what_init_writes_passes_and_a_fault_in_the_solver_fails() {
    if !has("python3", &["--version"]) {
        return;
    }
    // Plain, and names that a shell and the command's place-holders would take apart.
    for folder in [".", "new", "a 'b' {c} $d/deep"] {
        let root = tempfile::tempdir().expect("a folder");
        let (code, out, err) = init(root.path(), &[folder]);
        assert_eq!((code, err.as_str()), (0, ""), "{out}");
        let (code, said, err) = shell(next(&out), root.path());
        assert_eq!(code, 0, "{}: {said}{err}", next(&out));
        assert!(
            said.contains("1 scene: 1 passed, 0 failed, 0 skipped"),
            "{said}"
        );

        if folder != "." {
            continue;
        }
        // The drift before the kick is another scheme, and a spring that pulls one end only is none.
        let solver = root.path().join(folder).join("solver.py");
        let right = std::fs::read_to_string(&solver).expect("text");
        for (from, to) in [
            ("            f[3 * j + a] -= pull\n", ""),
            (
                "x[a] += h * v[a]",
                "x[a] += h * (v[a] - h * f[a] / scene[\"masses\"][a // 3])",
            ),
            ("c * rate", "0.9 * c * rate"),
        ] {
            change(&solver, from, to);
            let (code, said, _) = shell(next(&out), root.path());
            assert_eq!(code, 1, "{to}: {said}");
            assert!(said.contains("mine"), "{said}");
            std::fs::write(&solver, &right).expect("written");
        }
    }
}

#[test]
fn init_overwrites_nothing() {
    let names = [
        "scene.yml",
        "solver.py",
        ".github/workflows/springcheck.yml",
        "scene.schema.json",
    ];
    let root = tempfile::tempdir().expect("a folder");
    assert_eq!(init(root.path(), &[]).0, 0);
    let mut texts: Vec<String> = Vec::new();
    for name in names {
        let path = root.path().join(name);
        texts.push(std::fs::read_to_string(&path).expect(name));
        // Each of them alone, in another folder.
        let other = tempfile::tempdir().expect("a folder");
        let there = other.path().join(name);
        std::fs::create_dir_all(there.parent().expect("a folder")).expect("made");
        std::fs::write(&there, "mine").expect("written");
        refuse_all(
            &["init", word(other.path())],
            &["nothing was written", word(&there)],
        );
        assert_eq!(std::fs::read_to_string(&there).expect("text"), "mine");
        let entries = std::fs::read_dir(other.path()).expect("a folder").count();
        assert_eq!(entries, 1, "{name}: something was written");
    }
    assert_eq!(init(root.path(), &[]).0, 2);
    for (name, text) in names.iter().zip(texts) {
        assert_eq!(
            std::fs::read_to_string(root.path().join(name)).expect(name),
            text
        );
    }
    // A link that leads nowhere is not followed, and a file is no folder.
    let other = tempfile::tempdir().expect("a folder");
    std::os::unix::fs::symlink("nowhere", other.path().join("scene.yml")).expect("a link");
    refuse_all(&["init", word(other.path())], &["scene.yml"]);
    refuse_all(
        &["init", word(&root.path().join("solver.py"))],
        &["solver.py"],
    );
}

#[test]
fn the_schema_beside_the_scene_is_the_one_printed_and_the_workflow_is_this_version_s() {
    let root = tempfile::tempdir().expect("a folder");
    let (_, out, _) = init(root.path(), &[]);
    let text = |name: &str| std::fs::read_to_string(root.path().join(name)).expect(name);
    assert_eq!(text("scene.schema.json"), output(&["schema", "scene"]).1);
    let first = text("scene.yml");
    let first = first.lines().next().expect("a line");
    assert_eq!(first, "# yaml-language-server: $schema=scene.schema.json");
    let workflow = text(".github/workflows/springcheck.yml");
    let version = format!("springcheck --version {}\n", env!("CARGO_PKG_VERSION"));
    assert!(workflow.contains(&version), "{workflow}");
    // What CI runs is what was printed, and what only CI wants.
    let parsed: Value = serde_yaml::from_str(&workflow).expect("YAML");
    let steps = parsed["jobs"]["check"]["steps"].as_array().expect("steps");
    let mut runs = steps.iter().filter_map(|step| step["run"].as_str());
    let check = runs.next_back().expect("a command");
    let rest = check.strip_prefix(next(&out)).expect("the same command");
    assert_eq!(
        rest,
        " --require-all --format github --write junit=check.xml"
    );
    if has("python3", &["--version"]) {
        let (code, said, err) = shell(check, root.path());
        assert_eq!(code, 0, "{said}{err}");
        let junit = text("check.xml");
        assert!(
            junit.contains("<testsuites") && !junit.contains("<failure"),
            "{junit}"
        );
    }
}

/// The command that a project's README gives.
fn command_of(folder: &Path) -> String {
    let readme = std::fs::read_to_string(folder.join("README.md")).expect("a README");
    let (_, rest) = readme.split_once("```sh\n").expect("a command");
    rest.split_once("```").expect("its end").0.to_owned()
}

/// A copy of what lies in `examples/`.
fn copied() -> (tempfile::TempDir, PathBuf) {
    let root = tempfile::tempdir().expect("a folder");
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let copied = Command::new("cp")
        .arg("-R")
        .arg(&source)
        .arg(root.path())
        .status();
    assert!(copied.expect("cp").success());
    let examples = root.path().join("examples");
    (root, examples)
}

#[test]
fn the_python_project_passes_by_its_one_command() {
    if !has("python3", &["--version"]) {
        return;
    }
    let (_root, examples) = copied();
    let project = examples.join("gate-python");
    let (code, said, err) = shell(&command_of(&project), &project);
    assert_eq!(code, 0, "{said}{err}");
    change(&project.join("solver.py"), "(length - rest)", "length");
    assert_eq!(shell(&command_of(&project), &project).0, 1);
}

#[test]
fn the_cpp_project_passes_by_its_one_command() {
    if !has("c++", &["--version"]) {
        return;
    }
    let (_root, examples) = copied();
    let project = examples.join("gate-cpp");
    let (code, said, err) = shell(&command_of(&project), &project);
    assert_eq!(code, 0, "{said}{err}");
    change(
        &examples.join("external.cpp"),
        "v[a] += h * force[a] / mass[p];",
        "v[a] += h * force[a];",
    );
    assert_eq!(shell(&command_of(&project), &project).0, 1);
}

#[test]
fn expand_prints_what_reads_back_and_what_programs_get() {
    let root = tempfile::tempdir().expect("a folder");
    let scene = "scenes/pa1/scene04.yml";
    let (code, yaml, err) = output(&["expand", scene]);
    assert_eq!((code, err.as_str()), (0, ""));
    let copy = root.path().join("copy.yml");
    std::fs::write(&copy, &yaml).expect("written");
    assert_eq!(output(&["expand", word(&copy)]).1, yaml);
    // The program keeps what it got.
    let got = root.path().join("got.json");
    let keep = format!("kept=cp {{scene_json}} '{}'", got.display());
    let (_, flat, _) = output(&["expand", scene, "--format", "json"]);
    output(&[
        "run",
        scene,
        "--integrators",
        "rk4",
        "--engines",
        "none",
        "--duration",
        "5",
        "--external",
        &keep,
        "--format",
        "json",
    ]);
    assert_eq!(flat, std::fs::read_to_string(&got).expect("kept") + "\n");
    refuse_all(&["expand", "nowhere.yml"], &["there is no such file"]);
    let (code, picture, err) = output(&["expand", scene, "--format", "svg"]);
    assert_eq!((code, err.as_str()), (0, ""));
    assert!(picture.starts_with("<svg") && picture.ends_with("</svg>\n"));
    let formats = ["yaml", "json", "svg"];
    refuse_all(&["expand", scene, "--format", "xml"], &formats);
}

/// What stands between these marks in a document, each time.
fn blocks<'d>(document: &'d str, mark: &str) -> Vec<&'d str> {
    let begins = document.split(mark).skip(1);
    let blocks: Vec<&str> = begins
        .filter_map(|rest| rest.split("\n```").next())
        .collect();
    assert!(!blocks.is_empty(), "{mark}");
    blocks
}

#[test]
fn the_documents_commands_work_and_their_workflow_is_the_one_written() {
    let text = |name: &str| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
        std::fs::read_to_string(path).expect(name)
    };
    let document = text("docs/ci.md");
    let workflow = text("examples/gate-python/.github/workflows/springcheck.yml");
    // Without the two lines that say what it is.
    let from = workflow.find("name:").expect("a name");
    let github = blocks(&document, "```yaml\n")[0];
    assert_eq!(github, workflow[from..].trim_end());
    for yaml in blocks(&document, "```yaml\n") {
        let parsed: Result<Value, _> = serde_yaml::from_str(yaml);
        assert!(parsed.is_ok(), "{yaml}");
    }
    if !has("python3", &["--version"]) {
        return;
    }
    let root = tempfile::tempdir().expect("a folder");
    assert_eq!(init(root.path(), &[]).0, 0);
    std::fs::create_dir(root.path().join("scenes")).expect("a folder");
    let scene = root.path().join("scenes/scene.yml");
    std::fs::copy(root.path().join("scene.yml"), scene).expect("a copy");
    for block in blocks(&document, "```sh\n") {
        let (code, said, err) = shell(&format!("set -e\n{block}"), root.path());
        assert_eq!(code, 0, "{block}: {said}{err}");
    }
    // The README's, after what installs the program.
    let readme = text("README.md");
    let (_, section) = readme.split_once("## Gate your own solver").expect("it");
    let commands = blocks(section, "```\n")[0];
    let (_, commands) = commands.split_once('\n').expect("lines");
    let (code, said, err) = shell(&format!("set -e\n{commands}"), root.path());
    assert_eq!(code, 0, "{commands}: {said}{err}");
    let says = section.split('`').find(|said| said.starts_with("1 scene:"));
    assert!(said.trim_end().ends_with(says.expect("the line")), "{said}");
}
