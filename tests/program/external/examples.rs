//! The programs in `examples/` and the loop in `docs/external.md`, as a reader would run them.

use super::{has, run, theirs};
use crate::testkit::program::{outcomes, output};
use crate::testkit::scenes::shipped;
use serde_json::Value;
use springcheck::integrators::{self, Settings};
use springcheck::physics::{ParticleSystem, State};
use springcheck::scene::Scene;

const NET: &str = "scenes/pa1/scene04.yml";

fn numpy() -> bool {
    has("python3", &["-c", "import numpy"])
}

/// All states of symplectic Euler.
fn states(scene: &Scene, start: &State) -> Vec<State> {
    let system = ParticleSystem::new(scene);
    let row = integrators::find("symplectic_euler").expect("a row");
    let mut integrator = row.build(&Settings::default());
    let mut state = start.clone();
    let h = scene.solver.timestep;
    let step = |_| {
        integrator.step(&system, h, &mut state).expect("a step");
        state.clone()
    };
    (0..scene.steps(h)).map(step).collect()
}

/// How far apart two programs end up that round differently, m: one standard deviation.
///
/// Each step of each program rounds every free coordinate once to the spacing s of doubles at its
/// size: an error spread evenly over ±s/2, of variance s²/12. What an error of step n makes of the
/// distance at the end is taken from the start: g(n) is how far a push of that coordinate drives
/// any particle in n steps, for each metre of push. The errors being independent, variances add:
/// σ² = 2 Σ_c s_c²/12 Σ_n g_c(n)². Forces round too, but by eps of themselves, which moves a position
/// by h² f / m eps = 2.5e-7 s² (30 m/s²) eps a step: nothing.
fn rounding(scene: &Scene) -> f64 {
    const PUSH: f64 = 1e-9;
    let start = ParticleSystem::initial_state(scene);
    let path = states(scene, &start);
    let mut variance = 0.0;
    for at in (0..start.x.len()).filter(|at| !scene.particles[at / 3].fixed) {
        let mut pushed = start.clone();
        pushed.x[at] += PUSH;
        let mut squares = 0.0;
        for (a, b) in path.iter().zip(states(scene, &pushed)) {
            let square =
                |(a, b): (&[f64], &[f64])| a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
            let farthest = a.x.chunks(3).zip(b.x.chunks(3)).map(square);
            squares += farthest.fold(0.0, f64::max) / (PUSH * PUSH);
        }
        let largest = path.iter().fold(0.0, |m: f64, s| m.max(s.x[at].abs()));
        let spacing = f64::EPSILON * 2f64.powf(largest.log2().floor());
        variance += 2.0 * spacing * spacing / 12.0 * squares;
    }
    variance.sqrt()
}

fn from_forces(report: &Value) -> f64 {
    let deviation = &theirs(report)["deviation_m"]["rapier-forces"];
    deviation["max"].as_f64().expect("a deviation")
}

/// rapier-forces is our symplectic Euler, bit for bit, so the distance from it is the distance from
/// ours. Measured: 2.4e-14 m (NumPy) and 1.3e-14 m (C++), of 8.9e-14 m: as long as the programs are
/// this close, many of their roundings are the same.
fn agrees(report: &Value, sigma: f64) {
    let both = outcomes(report);
    assert_eq!(both[0]["deviation_m"]["rapier-forces"]["max"], 0.0);
    let outcome = theirs(report);
    assert_eq!(outcome["status"], "completed", "{outcome}");
    assert_eq!(outcome["kind"], "external");
    assert_eq!(outcome["work"]["steps"], 10_000);
    assert_eq!(outcome["work"]["force_evaluations"], Value::Null);
    let off = from_forces(report);
    eprintln!("off {off:.1e} m, bound {sigma:.1e} m");
    assert!(off <= sigma, "{off:e} > {sigma:e}");
    assert_eq!(outcome["energy"]["class"], both[0]["energy"]["class"]);
    // The same states, so the same energies. What dampers took by time t_n is h (P_0 + ... + P_n-1)
    // by symplectic Euler and, from rows, the same but for half of the ends: h/2 (P_n - P_0) apart,
    // with P_0 = 0 at rest.
    let scene = net();
    let system = ParticleSystem::new(&scene);
    let power = |s: &State| system.forces(s.t, &s.x, &s.v, &mut vec![0.0; s.x.len()]);
    let path = states(&scene, &ParticleSystem::initial_state(&scene));
    let most = path
        .iter()
        .fold(0.0, |m: f64, s| m.max(power(s).dissipated));
    let scale = report["scene"]["energy_scale_j"].as_f64().expect("J");
    let bound = 0.5 * scene.solver.timestep * most / scale;
    let error = |o: &Value| o["energy"]["relative_error_max"].as_f64().expect("S");
    let apart = (error(outcome) - error(&both[0])).abs();
    eprintln!("energy apart {apart:.1e}, bound {bound:.1e}");
    assert!(apart <= bound, "{apart:e} > {bound:e}");
}

fn net() -> Scene {
    shipped("pa1/scene04.yml")
}

#[test]
fn the_numpy_example_is_symplectic_euler_and_a_lost_spring_is_seen() {
    if !numpy() {
        return;
    }
    let sigma = rounding(&net());
    let (report, err) = run(
        NET,
        "numpy=python3 examples/external.py {scene_json} {output}",
        &[],
    );
    assert_eq!(err, "");
    agrees(&report, sigma);

    // The mistake its comment warns of: springs that share a particle count once.
    let source = std::fs::read_to_string("examples/external.py").expect("text");
    let wrong = source.replace("np.add.at(f, i, pull)", "f[i] += pull");
    assert_ne!(wrong, source);
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("lost springs.py");
    std::fs::write(&file, wrong).expect("written");
    let command = format!(
        "lost=python3 '{}' {{scene_json}} {{output}}",
        file.display()
    );
    let (report, _) = run(NET, &command, &[]);
    assert_eq!(theirs(&report)["status"], "completed");
    assert!(from_forces(&report) > 1e-2, "{}", theirs(&report));
}

#[test]
fn the_cpp_example_is_symplectic_euler() {
    if !has("c++", &["--version"]) {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let binary = folder.path().join("external");
    let compiled = std::process::Command::new("c++")
        .args(["-std=c++17", "-O2", "-Wall", "-Wextra", "-Werror"])
        .arg("examples/external.cpp")
        .arg("-o")
        .arg(&binary)
        .output()
        .expect("it starts");
    let errors = String::from_utf8_lossy(&compiled.stderr);
    assert!(compiled.status.success(), "{errors}");
    let command = format!("cpp='{}' {{scene_json}}", binary.display());
    let (report, err) = run(NET, &command, &[]);
    assert_eq!(err, "");
    agrees(&report, rounding(&net()));
}

#[test]
fn the_examples_refuse_what_they_do_not_compute() {
    if !numpy() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let scene = folder.path().join("dragged.yml");
    let yaml = "solver: {type: rk4, timestep: 0.1}\nduration: 1\n\
                particles: [{pos: [0, 0, 0], mass: 1, drag: 0.5}]\n";
    std::fs::write(&scene, yaml).expect("written");
    let (report, err) = run(
        scene.to_str().expect("UTF-8"),
        "numpy=python3 examples/external.py {scene_json} {output}",
        &[],
    );
    assert_eq!(theirs(&report)["status"], "failed");
    // Its stderr is passed on.
    assert_eq!(err, "external.py: cannot compute ['drag']\n");
}

/// The document's loop, with a solver in front that falls freely by explicit Euler.
#[test]
fn the_loop_of_the_document_runs() {
    if !numpy() {
        return;
    }
    let document = std::fs::read_to_string("docs/external.md").expect("text");
    let (_, rest) = document.split_once("```python\n").expect("a loop");
    let (code, _) = rest.split_once("```").expect("its end");
    assert_eq!(code.lines().count(), 10, "it says ten lines");
    let solver = "
class Simulation:
    def __init__(self, scene):
        self.positions, self.velocities = [[0.0, 0.0, 2.0]], [[0.0, 0.0, 0.0]]
    def step(self, h):
        self.positions[0][2] += h * self.velocities[0][2]
        self.velocities[0][2] += h * -9.81
";
    let file = "sys.argv[1]";
    let code = code.replace("\"mine.npz\"", file);
    assert!(code.contains(file), "it saves what is read");
    let folder = tempfile::tempdir().expect("a folder");
    let program = folder.path().join("mine.py");
    std::fs::write(&program, format!("import sys\n{solver}{code}")).expect("written");
    let scene = folder.path().join("fall.yml");
    let yaml = "solver: {type: explicit_euler, timestep: 0.0005}\nduration: 5\n\
                particles: [{pos: [0, 0, 2], mass: 1}]\n";
    std::fs::write(&scene, yaml).expect("written");
    let command = format!("mine=python3 {} {{output}}", program.display());
    let (report, _) = run(scene.to_str().expect("UTF-8"), &command, &[]);
    let outcome = theirs(&report);
    assert_eq!(outcome["status"], "completed", "{outcome}");
    // Explicit Euler is behind symplectic Euler by g h T after T = 5 s; velocities are the same, so
    // the distance is a sum of 10,000 equal terms, good to 10,000 roundings of 120 m.
    let last = outcome["deviation_m"]["rapier-forces"]["final"].as_f64();
    let off = last.expect("m") - 9.81 * 0.0005 * 5.0;
    assert!(off.abs() < 1e4 * 120.0 * f64::EPSILON, "{off:e}");
}

#[test]
fn the_students_midpoint_is_named() {
    if !numpy() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let student = std::fs::read_to_string("examples/student.py").expect("the example");
    let kick = "v = v + h * acceleration(middle)\n";
    let drift = student.find("    x = x + h * v").expect("the mistake");
    let end = drift + student[drift..].find('\n').expect("a line") + 1;
    let without = format!("{}{}", &student[..drift], &student[end..]);
    let both = "x, v = x + h * (v + h / 2 * acceleration(x)), v + h * acceleration(middle)\n";
    let right = without.replace(kick, both);
    assert_ne!(right, student);
    let judged = |name: &str, program: &str| {
        let [program_path, npz] =
            ["py", "npz"].map(|kind| folder.path().join(name).with_extension(kind));
        std::fs::write(&program_path, program).expect("a folder");
        let ran = std::process::Command::new("python3")
            .args([&program_path, &npz])
            .status();
        assert!(ran.expect("python3").success());
        let npz = npz.to_str().expect("UTF-8");
        let scene = "scenes/pa1/scene05.yml";
        let (code, out, _) = output(&["compare", npz, "--scene", scene, "--format", "json"]);
        let mut document: Value = serde_json::from_str(&out).expect("JSON on stdout");
        (code, document["reports"][0].take())
    };
    let (code, report) = judged("student", &student);
    assert_eq!(code, 1);
    let identified = &report["outcomes"][0]["identified"];
    assert_eq!(identified["method"], "midpoint_end_velocity");
    assert_eq!(identified["decisive"], true);
    assert_eq!(report["fault"]["step"], 0);
    assert!(
        report["fault"]["explanation"]
            .as_str()
            .is_some_and(|e| e.contains("at the midpoint"))
    );
    // And with what it says corrected, it is what it says.
    let (code, report) = judged("corrected", &right);
    assert_eq!(code, 0, "{report:#}");
    assert_eq!(report["outcomes"][0]["identified"]["method"], "midpoint");
}
