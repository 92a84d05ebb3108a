//! What is refused, and that nothing is left behind.

use super::{SCENE, output};

#[test]
fn usage_and_scene_errors_exit_with_2_and_write_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    let bad = folder.path().join("bad.yml");
    std::fs::write(&bad, "solver: {type: rk5, timestep: 0.1}\nparticles: []\n").expect("written");
    let bad = bad.to_str().expect("UTF-8");
    let cases: [(&[&str], &str); 14] = [
        (&["run", bad], "bad.yml:1:16"),
        (&["run", "missing.yml"], "missing.yml"),
        (&["run", "scenes"], "scenes"),
        (&["run", SCENE, "--integrators", "rk5"], "symplectic_euler"),
        (&["run", SCENE, "--engines", "bullet"], "rapier-forces"),
        (&["run", SCENE, "--timestep", "0"], "positive"),
        (&["run", SCENE, "--timestep", "nan"], "positive"),
        (&["run", SCENE, "--timestep", "-1"], "-1"),
        (&["run", SCENE, "--timestep", "7"], "duration"),
        (&["run", SCENE, "--duration", "inf"], "positive"),
        (&["run", SCENE, "--rapier", "iterations=0"], "iterations"),
        (&["run", SCENE, "--rapier", "velocity=3"], "pgs"),
        (&["run", SCENE, "--every", "3"], "--save"),
        (&["run"], "SCENE"),
    ];
    for (args, says) in cases {
        let args = [args, &["--output", out.to_str().expect("UTF-8")]].concat();
        let (code, stdout, stderr) = output(&args);
        assert_eq!(code, 2, "{args:?}");
        assert!(stdout.is_empty(), "{args:?}: {stdout}");
        assert!(stderr.contains(says), "{args:?}: {stderr}");
        assert!(!stderr.contains("panicked"), "{stderr}");
        assert!(!out.exists(), "{args:?} wrote something");
    }
}
