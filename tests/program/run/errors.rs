//! What is refused, and that nothing is left behind.

use super::SCENE;
use crate::testkit::program::{refuse, word};

#[test]
fn usage_and_scene_errors_exit_with_2_and_write_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let bad = folder.path().join("bad.yml");
    std::fs::write(&bad, "solver: {type: rk5, timestep: 0.1}\nparticles: []\n").expect("written");
    let bad = word(&bad);
    let cases: [(&[&str], &str); 14] = [
        (&[bad], "bad.yml:1:16"),
        (&["missing.yml"], "missing.yml"),
        (&["benches"], "no scene in this folder"),
        (&[SCENE, "--integrators", "rk5"], "symplectic_euler"),
        (&[SCENE, "--engines", "bullet"], "rapier-forces"),
        (&[SCENE, "--timestep", "0"], "positive"),
        (&[SCENE, "--timestep", "nan"], "positive"),
        (&[SCENE, "--timestep", "-1"], "-1"),
        (&[SCENE, "--timestep", "7"], "duration"),
        (&[SCENE, "--duration", "inf"], "positive"),
        (&[SCENE, "--rapier", "iterations=0"], "iterations"),
        (&[SCENE, "--rapier", "velocity=3"], "pgs"),
        (&[SCENE, "--every", "3"], "--save"),
        (&[], "SCENE"),
    ];
    refuse("run", &cases);
}
