//! A stored report says and draws what the verb that made it said and drew.

use crate::testkit::program::{altered, files, output, refuse_all, word};
use crate::testkit::scenes;
use springcheck::report::json::{self, Tool};
use springcheck::truth::Demand;
use springcheck::verbs::cost::{CostChoice, CostPlan};
use springcheck::verbs::formats::FORMATS;
use springcheck::verbs::run::{Choice, Plan};
use springcheck::verbs::series;
use springcheck::verbs::session::Quiet;
use springcheck::verbs::stability::StabilityPlan;
use springcheck::verbs::{Report, SeriesState};
use std::path::{Path, PathBuf};

const CIRCLE: &str = "scenes/oscillator/circle.yml";
const FEW: [&str; 2] = ["--integrators", "symplectic_euler,rk4"];

/// The only file of this name below a folder.
fn found(folder: &Path, name: &str) -> PathBuf {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut entries = entries.map(|entry| entry.expect("an entry").path());
    let here = folder.join(name);
    if here.exists() {
        return here;
    }
    let inner = entries.find(|path| path.is_dir()).expect("a folder");
    found(&inner, name)
}

/// What does not lead to files or to another command.
fn said(text: &str) -> String {
    let leads = |line: &&str| line.starts_with("report: ") || line.starts_with("next: ");
    text.lines()
        .filter(|line| !leads(line))
        .collect::<Vec<_>>()
        .join("\n")
}

/// Runs a verb with files, then shows its report with files: everything is the same, byte for byte.
fn same(args: &[&str], stem: &str) {
    let folder = tempfile::tempdir().expect("a folder");
    let [one, two] = ["one", "two"].map(|name| folder.path().join(name));
    let colour = ["--color", "always"];
    let into = |out| ["--output", out];
    let (_, ran, err) = output(&[args, &into(word(&one)), &colour].concat());
    assert!(!err.contains("error"), "{args:?}: {err}");
    let stored = found(&one, &format!("{stem}.json"));
    let shows = ["show", word(&stored)];
    let shown = |more: &[&str]| {
        let (code, out, err) = output(&[&shows, more].concat());
        assert_eq!((code, err.as_str()), (0, ""), "{args:?} {more:?}");
        out
    };
    let again = shown(&[&into(word(&two))[..], &colour].concat());
    assert_eq!(said(&again), said(&ran), "{args:?}");
    let again = found(&two, &format!("{stem}.json"));
    let [before, after] = [&stored, &again].map(|file| file.parent().expect("a folder"));
    let names = files(after);
    assert!(names.is_subset(&files(before)), "{args:?}");
    for name in &names {
        let [before, after] =
            [before, after].map(|at| std::fs::read(at.join(name)).expect("a file"));
        assert!(before == after, "{args:?}: {name}");
    }
    // Trajectories that `--save` wrote are no part of a report.
    let left = files(before)
        .into_iter()
        .filter(|name| !names.contains(name));
    assert_eq!(left.collect::<Vec<_>>(), Vec::<String>::new(), "{args:?}");
    for (format, extension) in [("json", "json"), ("markdown", "md")] {
        let file = stored.with_extension(extension);
        let file = std::fs::read_to_string(file).expect("text");
        assert!(shown(&["--format", format]) == file, "{args:?}: {format}");
    }
}

#[test]
fn runs() {
    same(
        &[&["run", CIRCLE, "--duration", "0.5"], &FEW[..]].concat(),
        "report",
    );
    let steps = ["run", CIRCLE, "--timestep", ".02,.01,.15"];
    same(&[&steps[..], &FEW].concat(), "report");
    // Explicit Euler diverges, rapier takes no isotropic damping, and expectations are judged.
    let hard = ["run", "scenes/hard/spin_isotropic.yml", "--duration", "0.2"];
    same(&hard, "report");
    same(&["run", "scenes/hard/stiff_pair.yml"], "report");
}

#[test]
fn comparisons() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = [
        "run",
        CIRCLE,
        "--duration",
        "0.5",
        "--engines",
        "none",
        "--save",
        "csv",
    ];
    let (code, ..) = output(&[&run[..], &FEW, &["--output", word(folder.path())]].concat());
    assert_eq!(code, 0);
    let clean = found(folder.path(), "rk4@0.01.csv");
    let compare = |file: &Path| same(&["compare", word(file), "--scene", CIRCLE], "report");
    compare(&clean);
    let faulty = altered(&clean, "faulty.csv", |at, fields| {
        if at == 60 {
            let v: f64 = fields[6].parse().expect("a number");
            fields[6] = format!("{:?}", 1.5 * v + 0.1);
        }
    });
    let (code, ..) = output(&["compare", word(&faulty), "--scene", CIRCLE]);
    assert_eq!(code, 1, "it has a fault");
    compare(&faulty);
}

#[test]
fn limits() {
    let plain = ["stability", CIRCLE, "--engines", "none"];
    same(&[&plain[..], &FEW].concat(), "stability");
    let map = ["--vary", "springs.stiffness=1..1e4:3", "--budget", "40000"];
    same(&[&plain[..], &FEW, &map].concat(), "stability");
    let pair = [
        "stability",
        "scenes/hard/stiff_pair.yml",
        "--admissible",
        "1,5",
    ];
    same(
        &[&pair[..], &FEW, &["--engines", "none"]].concat(),
        "stability",
    );
}

#[test]
fn rests() {
    same(&["rest", "scenes/hair/clamped.yml"], "rest");
    same(
        &["rest", "scenes/cloth/net.yml", "--refine", "1,2,4"],
        "rest",
    );
}

#[test]
fn costs() {
    let few = ["--integrators", "rk4,symplectic_euler,dormand_prince54"];
    let small = ["cost", CIRCLE, "--budget", "0.3s", "--steps", "3"];
    same(&[&small[..], &few].concat(), "cost");
    same(
        &[&["cost", CIRCLE, "--timestep", ".05,.01"], &FEW[..]].concat(),
        "cost",
    );
}

/// One text of several reports, as `run` prints them; and a report that has lost its series.
#[test]
fn several_reports_and_lost_series() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    let scenes = ["run", CIRCLE, "scenes/pa1/scene01.yml", "--duration", "0.1"];
    let json = ["--format", "json", "--output", word(&out)];
    let (code, text, _) = output(&[&scenes[..], &FEW, &json].concat());
    assert_eq!(code, 0);
    let both = folder.path().join("both.json");
    std::fs::write(&both, &text).expect("written");
    let show = |file: &Path, more: &[&str]| {
        let (code, out, err) = output(&[&["show", word(file)], more].concat());
        assert_eq!(code, 0, "{err}");
        (out, err)
    };
    let (again, _) = show(&both, &["--format", "json"]);
    assert!(again == text);
    let singly =
        ["oscillator/circle", "pa1/scene01"].map(|scene| out.join(scene).join("report.json"));
    let tables = singly.clone().map(|file| show(&file, &[]).0);
    // They end with the lines that alone are shown with `--quiet`.
    let lines = show(&both, &["--quiet"]).0;
    assert_eq!(show(&both, &[]).0, tables.join("\n") + "\n" + &lines);
    // The series lie beside the single reports only.
    let elsewhere = folder.path().join("elsewhere");
    let (_, err) = show(&both, &["--output", word(&elsewhere)]);
    assert!(err.contains("both.series is missing"), "{err}");
    let left: Vec<String> = files(&elsewhere.join("pa1/scene01")).into_iter().collect();
    assert_eq!(left, ["report.html", "report.json", "report.md"]);
    let (quiet, err) = show(&both, &["--format", "markdown", "--quiet"]);
    assert!(err.is_empty() && !quiet.contains(".svg"));
    // Two reports of one scene have one place.
    let twice: String = {
        let mut value: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        value["reports"][1] = value["reports"][0].clone();
        value.to_string()
    };
    std::fs::write(&both, twice).expect("written");
    let out = ["show", word(&both), "--output", word(&elsewhere)];
    refuse_all(&out, &["two of its reports would be written to"]);
}

/// What several scenes print as one list or one after the other, and its end, is shown again.
#[test]
fn several_scenes_of_the_gate_and_of_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("stored.json");
    let few = [&FEW[..], &["--engines", "none", "--no-files"]].concat();
    let scenes = [CIRCLE, "scenes/oscillator/oscillator.yml"];
    for (verb, more) in [("check", &[][..]), ("run", &few)] {
        for scenes in [&scenes[..1], &scenes] {
            let call = [&[verb], scenes, more].concat();
            let json: Vec<&str> = [&call[..], &["--format", "json"]].concat();
            let json: Vec<&str> = json
                .into_iter()
                .filter(|word| *word != "--no-files")
                .collect();
            std::fs::write(&file, output(&json).1).expect("written");
            for more in [&[][..], &["--quiet"]] {
                let (_, printed, _) = output(&[&call[..], more].concat());
                let (code, shown, err) = output(&[&["show", word(&file)], more].concat());
                assert_eq!((code, err.as_str()), (0, ""));
                // Times are another run's.
                let words = |text: &str| -> Vec<String> {
                    let timed =
                        |line: &str| [" ns", " µs", " ms"].iter().any(|unit| line.contains(unit));
                    let first = |line: &str| line.split_whitespace().next().map(str::to_owned);
                    let word = |line: &str| timed(line).then(|| first(line)).flatten();
                    let lines = said(text);
                    let lines = lines
                        .lines()
                        .map(|line| word(line).unwrap_or(line.to_owned()));
                    lines.collect()
                };
                assert_eq!(words(&shown), words(&printed), "{verb} {more:?}");
            }
            if verb == "check" {
                let (_, printed, _) = output(&call);
                let merged = output(&["merge", word(&file), "--format", "human"]);
                assert_eq!(merged.1, printed);
                let text = folder.path().join("text");
                let also = format!("human={}", word(&text));
                output(&[&call[..], &["--quiet", "--write", &also]].concat());
                assert_eq!(std::fs::read_to_string(&text).expect("written"), printed);
            }
        }
    }
}

#[test]
fn what_is_no_report_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("x.json");
    let name = word(&file).to_owned();
    for (text, says) in [
        ("", "ends too early"),
        ("{\"schema_version\": 2, \"rep", "ends too early"),
        ("t,id,x,y,z\n", "expected the JSON of a report"),
        ("[]", "`schema_version`, `tool` and `reports`"),
        ("{\"schema_version\": 1}", "run it again"),
        ("[{\"schema_version\": 1}]", "run it again"),
        ("{\"schema_version\": 3}", "a later version"),
        (
            "{\"schema_version\": 2, \"tool\": {\"name\": \"a\", \"version\": \"b\", \"platform\": \"c\"}, \"reports\": []}",
            "no report",
        ),
        (
            "{\"schema_version\": 2}",
            "`schema_version`, `tool` and `reports`",
        ),
    ] {
        std::fs::write(&file, text).expect("written");
        refuse_all(&["show", &name], &[&name, says]);
    }
    refuse_all(&["show", word(folder.path())], &["cannot read"]);
    refuse_all(&["show", "no/such.json"], &["cannot read no/such.json"]);
}

/// Every shipped scene under every verb, read back: equal texts, equal figures.
#[test]
fn shipped_scenes_read_back() {
    for path in scenes::files(&scenes::folders()) {
        let mut scene = scenes::shipped(word(&path));
        if scene.particles.len() > 30 {
            continue;
        }
        // Long enough for every kind of outcome.
        scene.duration = scene.duration.min(100.0 * scene.solver.timestep);
        let usual = Choice::default_for(&scene);
        let choice = Choice {
            truth: Demand::Closed,
            prove: false,
            ..usual.clone()
        };
        reads_back(
            &Plan::new(&scene, &choice)
                .execute(&Quiet)
                .expect("no files"),
        );
        let sweep = CostChoice {
            solvers: usual.solvers[..2].to_vec(),
            timesteps: Some(vec![scene.solver.timestep]),
            truth: Demand::Closed,
            ..CostChoice::default_for(&scene)
        };
        reads_back(&CostPlan::new(&scene, &sweep).execute(&Quiet));
    }
    let scene = scenes::shipped("oscillator/damped_over.yml");
    let usual = Choice::default_for(&scene);
    let plan = StabilityPlan {
        scene: &scene,
        solvers: usual.solvers,
        timestep: scene.solver.timestep,
        map: None,
        largest: None,
        admissible: Vec::new(),
    };
    reads_back(&plan.execute(&Quiet).expect("limits"));
}

fn reads_back(report: &Report) {
    let reports = std::slice::from_ref(report);
    let tool = Tool::this();
    let (made_by, mut read) =
        json::read(json::render(&tool, reports).as_bytes()).expect("a report");
    assert_eq!(made_by, tool);
    if let Some(bytes) = series::pack(reports) {
        read = series::unpack(read, &bytes);
    }
    assert!(!matches!(read[0].series, SeriesState::Missing));
    for format in FORMATS {
        let [one, other] = [reports, &read].map(|reports| (format.render)(&tool, reports));
        assert!(one == other, "{}: {}", report.header.scene.file, format.id);
    }
    assert!(report.svg() == read[0].svg());
}
