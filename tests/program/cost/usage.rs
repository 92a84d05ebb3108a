//! What the flags take, and what is said of what they do not.

use super::*;

#[test]
fn integrators_are_methods_and_pairs_once_each_in_their_order() {
    let swept = |list: &str| {
        let args = ["--engines", "none", "--budget", "0.01s", "--steps", "2"];
        let report = json(&[&[SCENE, "--integrators", list][..], &args].concat());
        engines(&report).join(",")
    };
    assert_eq!(swept("rk4,heun,rk4"), "rk4,heun");
    assert_eq!(swept("dop853"), "dop853");
    let both = "dop853,rk4,dormand_prince54,dop853,heun";
    assert_eq!(swept(both), "rk4,heun,dop853,dormand_prince54");
    let all = swept("all");
    let ids = springcheck::integrators::ids(springcheck::integrators::fixed());
    let pairs = springcheck::integrators::ids(springcheck::integrators::pairs());
    assert_eq!(all.split(',').count(), ids.len() + pairs.len());
    assert!(all.starts_with("symplectic_euler,explicit_euler,"));
    assert!(all.ends_with(&pairs.join(",")), "{all}");
}

#[test]
fn what_cannot_be_meant_exits_with_2_and_says_what_can() {
    let one = "1e-3";
    let cases: [(&[&str], &str); 43] = [
        (&[], "SCENE"),
        (&["missing.yml"], "missing.yml"),
        (&[SCENE, SCENE], "unexpected argument"),
        (&[SCENE, "--integrators", "rk5"], "tr_bdf2"),
        (&[SCENE, "--integrators", "rk5"], "dop853"),
        (&[SCENE, "--integrators", "rk5,dop853"], "tr_bdf2"),
        (&[SCENE, "--integrators", "rk5,dop853"], "dormand_prince54"),
        (&[SCENE, "--integrators", ""], "symplectic_euler"),
        (&[SCENE, "--engines", "bullet"], "rapier-forces"),
        (&[SCENE, "--rapier", "dt=0.1"], "leave dt out"),
        (&[SCENE, "--rapier", "dt=0.1,iterations=8"], "--timestep"),
        (&[SCENE, "--rapier", "iterations=0"], "from 1 to"),
        (&[SCENE, "--targets", "-1e-3"], "metres from 1e-30 to 1e30"),
        (&[SCENE, "--targets", "0"], "metres from 1e-30 to 1e30"),
        (&[SCENE, "--targets", "nan"], "metres from 1e-30 to 1e30"),
        (&[SCENE, "--targets", "inf"], "metres from 1e-30 to 1e30"),
        (&[SCENE, "--targets", "1e300"], "metres from 1e-30 to 1e30"),
        (
            &[SCENE, "--targets", "1e-3,-1"],
            "metres from 1e-30 to 1e30",
        ),
        (&[SCENE, "--targets", ""], "metres from 1e-30 to 1e30"),
        (&[SCENE, "--targets", "small"], "metres from 1e-30 to 1e30"),
        (&[SCENE, "--targets", &[one; 33].join(",")], "at most 32"),
        (&[SCENE, "--steps", "1"], "2..=200"),
        (&[SCENE, "--steps", "201"], "2..=200"),
        (&[SCENE, "--steps=-3"], "2..=200"),
        (
            &[
                SCENE,
                "--integrators",
                "dop853",
                "--engines",
                "none",
                "--timestep",
                "1",
            ],
            "leave --timestep out",
        ),
        (&[SCENE, "--steps", "1e300"], "--steps"),
        (&[SCENE, "--steps", "nan"], "--steps"),
        (&[SCENE, "--steps", ""], "--steps"),
        (&[SCENE, "--budget", "0"], "a time such as 60s"),
        (&[SCENE, "--budget=-1s"], "a time such as 60s"),
        (&[SCENE, "--budget", "nan"], "a time such as 60s"),
        (&[SCENE, "--budget", "inf"], "a time such as 60s"),
        (&[SCENE, "--budget", "1e300"], "a time such as 60s"),
        (&[SCENE, "--budget", "soon"], "a time such as 60s"),
        (&[SCENE, "--timestep", "0"], "positive seconds"),
        (&[SCENE, "--timestep", "nan"], "positive seconds"),
        (&[SCENE, "--timestep", "6"], "at most the duration"),
        (&[SCENE, "--timestep", "1e-10"], "at most 1e9 steps"),
        (
            &[SCENE, "--timestep", "0.1", "--steps", "3"],
            "cannot be used",
        ),
        (
            &[SCENE, "--timestep", "0.1", "--budget", "3s"],
            "cannot be used",
        ),
        (&[SCENE, "--duration", "0"], "positive seconds"),
        (&[SCENE, "--duration", "inf"], "positive seconds"),
        (&[SCENE, "--truth", "perhaps"], "closed"),
    ];
    refuse("cost", &cases);
}
