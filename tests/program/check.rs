//! The gate from the command line: what it selects, prints, accepts, and exits with.

use crate::testkit::program::{answer, array, find, output, springcheck, word};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// A spring that swings under symplectic Euler, and whatever else its file says.
fn scene(folder: &Path, name: &str, more: &str) -> String {
    let path = folder.join(name);
    fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
    let text = format!(
        "solver: {{type: symplectic_euler, timestep: 0.01, gravity: 0}}\nduration: 2\n\
         particles:\n- {{pos: [0, 0, 0], fixed: true}}\n- {{pos: [0.5, 0, 0], mass: 1}}\n\
         springs: [{{particle_ids: [0, 1], stiffness: 50, rest_length: 0}}]\n{more}"
    );
    fs::write(&path, text).expect("written");
    word(&path).to_owned()
}

/// The exit code and what is printed, outside of any CI.
fn check(args: &[&str]) -> (i32, String, String) {
    let mut command = springcheck();
    command
        .arg("check")
        .args(args)
        .env_remove("CI")
        .env_remove("GITHUB_STEP_SUMMARY");
    answer(&mut command)
}

#[test]
fn folders_are_searched_and_every_scene_has_a_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let root = folder.path();
    scene(root, "b.yml", "");
    scene(root, "deep/a.yaml", "");
    scene(root, ".hidden/c.yml", "");
    fs::write(root.join("notes.txt"), "no scene").expect("written");
    let (code, out, _) = check(&[word(root)]);
    assert_eq!(code, 0, "{out}");
    let lines: Vec<&str> = out.lines().collect();
    assert_eq!(lines.len(), 3, "{out}");
    assert!(
        lines[0].contains("b.yml") && lines[1].contains("a.yaml"),
        "{out}"
    );
    assert_eq!(lines[2], "2 scenes: 2 passed, 0 failed, 0 skipped");
}

#[test]
fn nothing_selected_is_no_success() {
    let folder = tempfile::tempdir().expect("a folder");
    assert_eq!(check(&[word(folder.path())]).0, 4);
    let only = scene(folder.path(), "a.yml", "");
    // One scene is the first of four, so the second part is empty.
    assert_eq!(check(&[&only, "--partition", "slice:2/4"]).0, 4);
    assert_eq!(check(&["nowhere"]).0, 2);
    assert_eq!(check(&[&only, "--partition", "slice:5/4"]).0, 2);
    assert_eq!(check(&[]).0, 2);
}

#[test]
fn what_a_scene_expects_is_held_and_a_skip_is_shown() {
    let folder = tempfile::tempdir().expect("a folder");
    let broken = scene(
        folder.path(),
        "a.yml",
        "expect: {rk4: {energy.class: growing}}\n",
    );
    let (code, out, _) = check(&[&broken]);
    assert_eq!(code, 1);
    for said in [
        "FAIL",
        "1 of",
        "expect rk4 energy.class",
        "should be growing",
        "1 scene: 0 passed, 1 failed",
    ] {
        assert!(out.contains(said), "{said}: {out}");
    }
    let skipped = scene(
        folder.path(),
        "b.yml",
        "expect: {rk4: {energy.class: growing}, skip: {expect: \"not decided yet\"}}\n",
    );
    let (code, out, _) = check(&[&skipped]);
    assert_eq!(code, 0, "{out}");
    assert!(out.contains("not decided yet"), "{out}");
    // A typo is no skip.
    for wrong in [
        "expect: {skip: {ordre: \"no\"}}\n",
        "expect: {mine: {status: completed}}\n",
    ] {
        let path = scene(folder.path(), "c.yml", wrong);
        let (code, _, err) = check(&[&path]);
        assert_eq!(code, 2, "{err}");
        assert!(err.contains("c.yml:"), "{err}");
    }
}

#[test]
fn a_step_beyond_the_limit_fails_with_its_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = scene(folder.path(), "a.yml", "");
    let text = fs::read_to_string(&path).expect("read");
    // The limit is 2 / sqrt(50) = 0.2828 s.
    fs::write(&path, text.replace("timestep: 0.01", "timestep: 0.3")).expect("written");
    let (code, out, _) = check(&[&path]);
    assert_eq!(code, 1, "{out}");
    assert!(out.contains("0.2828 s"), "{out}");
    let (_, out, _) = check(&[&path, "--format", "github"]);
    let annotation = format!("::error file={path},line=1,col=34,title=limit symplectic_euler::");
    assert!(out.contains(&annotation), "{out}");
}

#[test]
fn junit_has_a_suite_a_scene_and_a_case_a_check() {
    let folder = tempfile::tempdir().expect("a folder");
    scene(
        folder.path(),
        "a.yml",
        "expect: {rk4: {energy.class: growing}}\n",
    );
    scene(folder.path(), "b.yml", "");
    let file = folder.path().join("out.xml");
    let also = format!("junit={}", word(&file));
    let (code, out, _) = check(&[word(folder.path()), "--format", "json", "--write", &also]);
    assert_eq!(code, 1);
    let json: Value = serde_json::from_str(&out).expect("JSON");
    let xml = fs::read_to_string(&file).expect("written");
    let xml = roxmltree::Document::parse(&xml).expect("well-formed");
    let suites: Vec<_> = xml
        .descendants()
        .filter(|n| n.has_tag_name("testsuite"))
        .collect();
    let reports = array(&json["reports"]);
    assert_eq!(suites.len(), reports.len());
    for (suite, report) in suites.iter().zip(reports) {
        let cases = suite
            .children()
            .filter(|n| n.has_tag_name("testcase"))
            .count();
        assert_eq!(cases, array(&report["checks"]).len());
        let failures = suite
            .descendants()
            .filter(|n| n.has_tag_name("failure"))
            .count();
        let failed = array(&report["checks"])
            .iter()
            .filter(|c| c["status"] == "fail")
            .count();
        assert_eq!(failures, failed);
    }
}

/// XML 1.0, 2.2: the characters that a document may hold; beside those, what acts on a terminal is not in it either.
#[test]
fn junit_is_well_formed_whatever_names_and_programs_say() {
    let folder = tempfile::tempdir().expect("a folder");
    let wrong: String =
        "\u{1}\u{b}\u{1f}\u{7f}\u{9f}\u{202e}\u{fffe}\u{ffff}\u{10ffff}]]><&\"'".into();
    let path = scene(folder.path(), &format!("a{wrong}.yml"), "");
    let program = folder.path().join("p.sh");
    fs::write(
        &program,
        format!("printf '%s' '{}'", wrong.replace('\'', "")),
    )
    .expect("written");
    let mine = format!("m=sh '{}'", word(&program));
    let (code, xml, err) = check(&[&path, "--external", &mine, "--format", "junit"]);
    assert_eq!(code, 1, "{err}");
    let may = |c: char| matches!(u32::from(c), 0x9 | 0xa | 0xd | 0x20..=0xd7ff | 0xe000..=0xfffd | 0x1_0000..);
    assert!(xml.chars().all(may) && !xml.contains('\u{202e}'), "{xml:?}");
    roxmltree::Document::parse(&xml).expect("well-formed");
}

#[test]
fn parts_merge_into_the_bytes_of_the_whole() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["a.yml", "b/c.yml", "b/d.yml", "e.yml"] {
        scene(folder.path(), name, "");
    }
    let root = word(folder.path());
    let (_, whole, _) = check(&[root, "--format", "json"]);
    for by in ["slice", "hash"] {
        let mut parts = Vec::new();
        for part in 1..=3 {
            let partition = format!("{by}:{part}/3");
            let (code, out, _) = check(&[root, "--format", "json", "--partition", &partition]);
            if code != 4 {
                let file = folder.path().join(format!("{by}{part}.json"));
                fs::write(&file, out).expect("written");
                parts.push(word(&file).to_owned());
            }
        }
        parts.reverse();
        let args: Vec<&str> = ["merge"]
            .into_iter()
            .chain(parts.iter().map(String::as_str))
            .collect();
        let (code, merged, err) = output(&args);
        assert_eq!((code, merged.as_str()), (0, whole.as_str()), "{by} {err}");
        let twice: Vec<&str> = [args.clone(), vec![args[1]]].concat();
        assert_eq!(output(&twice).0, 2);
    }
}

#[test]
fn a_baseline_says_what_moved() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = scene(folder.path(), "a.yml", "");
    let baseline = folder.path().join("accepted.json");
    let file = word(&baseline);
    assert_eq!(check(&[&path, "--accept", file]).0, 0);
    let accepted = fs::read_to_string(&baseline).expect("written");
    assert_eq!(check(&[&path, "--baseline", file, "--accept", file]).0, 0);
    assert_eq!(fs::read_to_string(&baseline).expect("written"), accepted);
    // A number within a millionth stays as it stands, digit for digit.
    let energy = "\"energy.initial_j\": 6.25";
    assert!(accepted.contains(energy), "{accepted}");
    let near = accepted.replace(energy, "\"energy.initial_j\": 6.2500001");
    fs::write(&baseline, &near).expect("written");
    assert_eq!(check(&[&path, "--baseline", file, "--accept", file]).0, 0);
    assert_eq!(fs::read_to_string(&baseline).expect("written"), near);
    // One that moved is named.
    let moved = accepted.replace(energy, "\"energy.initial_j\": 6.5");
    fs::write(&baseline, moved).expect("written");
    let (code, out, _) = check(&[&path, "--baseline", file]);
    assert_eq!(code, 1);
    assert!(out.contains("energy.initial_j was 6.5, is 6.25"), "{out}");
    // Another scene has other runs.
    fs::write(&baseline, &accepted).expect("written");
    let text = fs::read_to_string(&path).expect("read");
    fs::write(&path, text.replace("stiffness: 50", "stiffness: 51")).expect("written");
    let (code, out, _) = check(&[&path, "--baseline", file]);
    assert_eq!(code, 1, "{out}");
    assert!(out.contains("the scene has changed"), "{out}");
    // What it is called and expects is no part of them.
    fs::write(&path, format!("name: other\n{text}")).expect("written");
    assert_eq!(check(&[&path, "--baseline", file]).0, 0);
    fs::write(&path, text).expect("written");
    // Never in CI unless forced.
    let mut command = springcheck();
    command
        .args(["check", &path, "--accept", file])
        .env("CI", "true");
    assert_eq!(answer(&mut command).0, 2);
    command.arg("--force");
    assert_eq!(answer(&mut command).0, 0);
    // A scene that the baseline does not know is open, and strictly a failure.
    let other = scene(folder.path(), "b.yml", "");
    assert_eq!(check(&[&other, "--baseline", file]).0, 3);
    assert_eq!(check(&[&other, "--baseline", file, "--strict"]).0, 1);
}

/// Symplectic Euler on the scene above, as a few lines of awk.
const EULER: &str =
    "BEGIN { CONVFMT = OFMT = \"%.17g\"; x = 0.5; v = 0; print \"t,id,x,y,z,vx,vy,vz\"
n = int(2 / h + 0.5)
for (i = 0; i <= n; i++) {
  print i * h \",0,0,0,0,0,0,0\"; print i * h \",1,\" x \",0,0,\" v \",0,0\"
  v = v - 50 * h * x; x = x + h * v } }";

#[cfg(unix)]
#[test]
fn a_program_is_held_to_what_it_claims() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = scene(
        folder.path(),
        "a.yml",
        "externals: [mine]\nexpect: {mine: {energy.class: bounded}}\n",
    );
    // Not given, it is a skip that is said, or with --require-all a failure.
    let (code, out, _) = check(&[&path]);
    assert_eq!(code, 0);
    assert!(
        out.contains("1 skipped") && out.contains("skipped: expect mine"),
        "{out}"
    );
    assert_eq!(check(&[&path, "--require-all"]).0, 1);
    let program = folder.path().join("euler.awk");
    fs::write(&program, EULER).expect("written");
    let mine = format!("mine=awk -v h={{timestep}} -f {}", word(&program));
    let (code, out, err) = check(&[
        &path,
        "--external",
        &mine,
        "--claims",
        "mine=symplectic_euler",
    ]);
    assert_eq!(code, 0, "{out}{err}");
    assert!(
        out.contains("scheme mine: steps as symplectic_euler"),
        "{out}"
    );
    // Without a claim its scheme is said, and not judged.
    let (code, out, _) = check(&[&path, "--external", &mine]);
    assert_eq!(code, 0, "{out}");
    let said = "skipped: scheme mine: claims no scheme, and steps as symplectic_euler";
    assert!(out.contains(said), "{out}");
    // A step of its own, whatever it is told: the same errors at every step.
    let stuck = format!("mine=awk -v h=0.01 -f {}", word(&program));
    let (code, out, _) = check(&[
        &path,
        "--external",
        &stuck,
        "--claims",
        "mine=symplectic_euler",
    ]);
    assert_eq!(code, 1, "{out}");
    assert!(out.contains("does not take the timestep"), "{out}");
    let (code, out, _) = check(&[
        &path,
        "--external",
        &mine,
        "--claims",
        "mine=velocity_verlet",
    ]);
    assert_eq!(code, 1, "{out}");
    for said in [
        "scheme mine: steps as symplectic_euler, not as velocity_verlet",
        "claimed-order mine",
    ] {
        assert!(out.contains(said), "{said}: {out}");
    }
    // Missing, failing, and half a file.
    for wrong in [
        "mine=no_such_program",
        "mine=false",
        "mine=echo 't,id,x,y,z'",
    ] {
        let (code, out, _) = check(&[&path, "--external", wrong]);
        assert_eq!(code, 1, "{wrong}: {out}");
        assert!(out.contains("completes mine"), "{wrong}: {out}");
    }
    assert_eq!(check(&[&path, "--claims", "mine=rk4"]).0, 2);
    assert_eq!(
        check(&[&path, "--external", &mine, "--claims", "mine=rk5"]).0,
        2
    );
}

/// Velocity Verlet whose half kicks take drag at the velocity before them, on the scene above with drag; `twice` is how
/// often gravity acts.
const DAMPED: &str =
    "BEGIN { CONVFMT = OFMT = \"%.17g\"; x = 0.5; y = 0; v = 0; w = 0; print \"t,id,x,y,vx,vy\"
n = int(2 / h + 0.5)
for (i = 0; i <= n; i++) {
  print i * h \",0,0,0,0,0\"; print i * h \",1,\" x \",\" y \",\" v \",\" w
  v = v + h / 2 * (-50 * x - 0.7 * v); w = w + h / 2 * (-50 * y - 0.7 * w)
  x = x + h * v; y = y + h * w
  v = v + h / 2 * (-50 * x - 0.7 * v); w = w + h / 2 * (-50 * y - 0.7 * w) } }";

#[cfg(unix)]
#[test]
fn a_scheme_that_is_no_integrator_here_can_be_claimed_by_a_program_of_a_plane() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = scene(folder.path(), "a.yml", "");
    let text = fs::read_to_string(&path).expect("read");
    let damped = text.replace("mass: 1}", "mass: 1, drag: 0.7}");
    assert_ne!(damped, text);
    fs::write(&path, damped).expect("written");
    let program = folder.path().join("verlet.awk");
    fs::write(&program, DAMPED).expect("written");
    let mine = format!("mine=awk -v h={{timestep}} -f {}", word(&program));
    let claims = |scheme: &str| {
        let claim = format!("mine={scheme}");
        check(&[
            &path,
            "--external",
            &mine,
            "--axes",
            "xy",
            "--claims",
            &claim,
        ])
    };
    let explicit = "velocity_verlet_explicit_damping";
    let (code, out, err) = claims(explicit);
    assert_eq!(code, 0, "{out}{err}");
    assert!(
        out.contains(&format!("scheme mine: steps as {explicit}")),
        "{out}"
    );
    assert!(out.contains("no order is stated"), "{out}");
    let (code, out, _) = claims("velocity_verlet");
    assert_eq!(code, 1, "{out}");
    assert!(
        out.contains(&format!("steps as {explicit}, not as velocity_verlet")),
        "{out}"
    );
    for wrong in ["velocity_verlet_explicit_dampin", "rk4/0", "rk4/x"] {
        let (code, _, err) = claims(wrong);
        assert_eq!(code, 2, "{wrong}: {err}");
    }
    // Without its axes its rows are refused, with the flag that reads them.
    let (code, out, _) = check(&[&path, "--external", &mine]);
    assert_eq!(code, 1, "{out}");
    assert!(out.contains("--axes"), "{out}");
}

#[cfg(unix)]
#[test]
fn a_comparison_is_held_to_what_is_asked() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = scene(folder.path(), "a.yml", "");
    let (code, out, _) = output(&[
        "run",
        &path,
        "--integrators",
        "symplectic_euler",
        "--engines",
        "none",
        "--save",
        "csv",
        "--output",
        word(&folder.path().join("out")),
    ]);
    assert_eq!(code, 0, "{out}");
    let file = find(&folder.path().join("out"), "symplectic_euler@0.01.csv");
    let file = word(&file).to_owned();
    // z = h w = 0.0707: symplectic Euler's energy swings by about z / 2 = 3.5 %.
    for (flags, wanted) in [
        (&["--expect", "symplectic_euler"][..], 0),
        (&["--expect", "rk4"], 1),
        (&["--max-energy", "0.05"], 0),
        (&["--max-energy", "0.02"], 1),
        (&["--max-error", "1"], 0),
        (&["--max-error", "1e-6"], 1),
        (&["--max-error", "-1"], 2),
        (&["--expect", "rk5"], 2),
    ] {
        let args = [&["compare", &file, "--scene", &path], flags].concat();
        let (code, out, err) = output(&args);
        assert_eq!(code, wanted, "{flags:?}: {out}{err}");
    }
}

#[test]
fn every_check_is_explained_and_listed() {
    let (_, listed, _) = output(&["list", "checks"]);
    for row in springcheck::verbs::check::CHECKS {
        assert!(listed.contains(row.id), "{}", row.id);
        let (code, out, _) = output(&["explain", row.id]);
        assert_eq!(code, 0);
        for label in ["requires", "the bound", "what to do"] {
            assert!(out.contains(label), "{}: {out}", row.id);
        }
    }
    for id in [
        "rk4",
        "rapier",
        "springs",
        "midpoint_end_velocity",
        "linearized_implicit",
        "bounded",
        "few samples",
    ]
    .into_iter()
    .chain(springcheck::verbs::scheme::ids())
    .chain(springcheck::measure::CONTACT_LAWS.iter().map(|law| law.0))
    {
        assert_eq!(output(&["explain", id]).0, 0, "{id}");
    }
    let (code, _, err) = output(&["explain", "ordr"]);
    assert_eq!(code, 2);
    assert!(err.contains("did you mean `order`"), "{err}");
}
