//! What a run says of rods and strain limits.

use crate::testkit::program::{json, output, word};

/// The terminal's text, without its line breaks, and the first outcome of the JSON.
fn said(scene: &str, flags: &[&str]) -> (String, serde_json::Value) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.yml");
    std::fs::write(&path, scene).expect("written");
    let args = [&["run", word(&path), "--engines", "none"], flags].concat();
    let out = ["--output", word(folder.path())];
    let (code, text, err) = output(&[&args[..], &out].concat());
    assert_eq!(code, 0, "{err}");
    let text: Vec<&str> = text.split_whitespace().collect();
    (text.join(" "), json(&args)["outcomes"][0].clone())
}

/// A mass of 2 kg hangs at the limit of a spring, which carries 1 N of its weight: the limit has the other 18.62 N. In each
/// step the mass falls from rest by a h², a = 18.62/2: symplectic Euler is off by m a² h²/2 less k (a h²)²/2, and the limit
/// undoes the fall.
#[test]
fn a_mass_at_a_strain_limit_is_held_by_it() {
    let scene = "solver: {type: symplectic_euler, timestep: 0.01}
duration: 3
particles: [{pos: [0, 0, 0], fixed: true}, {pos: [0, 0, -1.1], mass: 2}]
springs: [{particle_ids: [0, 1], stiffness: 10, rest_length: 1}]
strain_limit: {ratio: 0.1}
";
    let flags = [
        "--integrators",
        "explicit_euler,symplectic_euler",
        "--columns",
        "reaction,tension",
    ];
    let (text, _) = said(scene, &flags);
    for says in [
        "symplectic_euler ends with the energy that it began with, though its balance with the strain limit falls by 2.6 J",
        "particle 0 is held by (0, 0, 1) N, without what the strain limit does",
        "acts on what is fixed with (0, 0, -18.6) N on average, (0, 0, -55.9) N s in all",
        "limit 10 % met;",
        // All of one engine, though another stands above it.
        "tension symplectic_euler:",
        "reaction symplectic_euler at",
        "strain symplectic_euler:",
    ] {
        assert!(text.contains(says), "{says} in {text}");
    }
    let (_, outcome) = said(scene, &["--integrators", "symplectic_euler"]);
    let number = |at: &str| {
        outcome
            .pointer(at)
            .and_then(serde_json::Value::as_f64)
            .expect("a number")
    };
    let a: f64 = 9.81 - 0.5;
    // Sums of 300 steps, of terms of 20 J.
    let off =
        number("/energy/relative_error_max") * 0.05 - 300.0 * a * a * 1e-4 * (1.0 - 5.0 * 1e-4);
    assert!(off.abs() < 1e-11, "{off:e}");
    let impulse = number("/strain/impulse_n_s/2") + 18.62 * 3.0;
    assert!(impulse.abs() < 1e-11, "{impulse:e}");
}

#[test]
fn sweeps_are_advised_where_they_can_help() {
    let scene = |apart: &str| {
        format!(
            "solver: {{type: symplectic_euler, timestep: 0.01, gravity: 0}}
duration: 0.1
particles: [{{pos: [1, 0, 0], mass: 1}}, {{pos: [1, 0, 0], mass: 1}}, {{pos: [{apart}, 0, 0], fixed: true}}, {{pos: [0, 0, 0], fixed: true}}]
springs: [{{particle_ids: [0, 1], stiffness: 1, rest_length: 1}}, {{particle_ids: [2, 0], stiffness: 1, rest_length: 1}}]
strain_limit: {{ratio: 0.1, also_compression: true, iterations: 3}}
"
        )
    };
    let flags = ["--integrators", "symplectic_euler"];
    let (text, _) = said(&scene("2"), &flags);
    assert!(
        text.contains("spring 0 is at -100 %") && text.contains("no direction"),
        "{text}"
    );
    assert!(!text.contains("take more"), "{text}");
    // Held from both sides: too short for one, with no room for the other.
    let held = "solver: {type: symplectic_euler, timestep: 0.01, gravity: 0}
duration: 0.1
particles: [{pos: [0, 0, 0], fixed: true}, {pos: [0.5, 0, 0], mass: 1}, {pos: [1, 0, 0], fixed: true}]
springs: [{particle_ids: [0, 1], stiffness: 1, rest_length: 1}, {particle_ids: [1, 2], stiffness: 1, rest_length: 1}]
strain_limit: {ratio: 0.1, also_compression: true}
";
    let (text, _) = said(held, &flags);
    assert!(text.contains("hold its ends that close together"), "{text}");
}

/// A pendulum let go level falls for 0.3 s, a part of its swing: its energy error has one sign so far.
#[test]
fn less_than_a_swing_of_rattle_shows_no_trend() {
    let scene = "solver: {type: rattle, timestep: 0.01}
duration: 0.3
particles: [{pos: [0, 0, 0], fixed: true}, {pos: [1, 0, 0], mass: 1}]
rods: [{particle_ids: [0, 1]}]
";
    let (text, _) = said(scene, &["--integrators", "rattle", "--columns", "tension"]);
    assert!(text.contains("less than a period of its swing"), "{text}");
    assert!(!text.contains("a smaller step lessens it"), "{text}");
    assert!(
        text.contains("their tension is from 0 N in rod 0 at 0 s"),
        "{text}"
    );
}
