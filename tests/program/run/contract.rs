//! The JSON's keys and the default engines, to the letter.

use super::SCENE;
use crate::testkit::program::{json, keys, outcomes, set};

#[test]
fn the_json_has_exactly_the_contracts_keys() {
    let report = json(&["run", SCENE]);
    assert_eq!(
        keys(&report),
        set(&[
            "verb", "scene", "truth", "outcomes", "checks", "advice", "series", "verdict",
            "remarks"
        ])
    );
    assert_eq!(report["verb"], "run");
    assert_eq!(report["series"], false);
    assert_eq!(
        keys(&report["scene"]),
        set(&[
            "name",
            "file",
            "particles",
            "springs",
            "effects",
            "timestep",
            "duration",
            "energy_scale_j",
            "description",
            "own_integrator"
        ])
    );
    assert_eq!(
        keys(&report["scene"]["effects"][0]),
        set(&["id", "members", "evaluations", "wall_ns"])
    );
    assert_eq!(
        keys(&report["truth"]),
        set(&["kind", "method", "error_bound_m", "horizon_s", "reason"])
    );
    assert_eq!(report["truth"]["kind"], "closed_form");
    for outcome in outcomes(&report) {
        assert_eq!(
            keys(outcome),
            set(&[
                "engine",
                "kind",
                "timestep",
                "substep",
                "status",
                "stopped_at_s",
                "reason",
                "position_error_m",
                "velocity_error_m_s",
                "deviation_m",
                "energy",
                "momentum",
                "work",
                "identified",
                "explained",
                "remarks",
            ])
        );
        assert_eq!(
            keys(&outcome["energy"]),
            set(&[
                "initial_j",
                "final_j",
                "relative_error_max",
                "drift_per_s",
                "drift_per_s_ci",
                "fluctuation",
                "samples",
                "class",
                "kinetic_final_j",
                "potential_final_j",
                "dissipated_j",
                "injected_j",
            ])
        );
        assert_eq!(
            keys(&outcome["work"]),
            set(&[
                "steps",
                "force_evaluations",
                "linear_solves",
                "wall_s",
                "world"
            ])
        );
        assert_eq!(
            keys(&outcome["work"]["wall_s"]),
            set(&["min", "median", "mad"])
        );
        for deviation in outcome["deviation_m"].as_object().expect("a map").values() {
            assert_eq!(keys(deviation), set(&["final", "max", "first_exceeds_s"]));
        }
    }
    for check in report["checks"].as_array().expect("checks") {
        assert_eq!(
            keys(check),
            set(&[
                "id",
                "subject",
                "status",
                "measured",
                "bound",
                "derivation",
                "message"
            ])
        );
        assert_eq!(check["status"], "pass");
    }
}

#[test]
fn the_default_engines_come_in_the_contracts_order() {
    let report = json(&["run", "scenes/oscillator/circle.yml"]);
    let engines: Vec<&str> = outcomes(&report)
        .iter()
        .map(|o| o["engine"].as_str().expect("an id"))
        .collect();
    assert_eq!(
        engines,
        [
            "explicit_euler",
            "symplectic_euler",
            "midpoint",
            "velocity_verlet",
            "rk4",
            "implicit_euler",
            "rapier",
            "rapier-forces",
        ]
    );
    // A kept force is kept: one evaluation a step, and one to start.
    assert_eq!(report["outcomes"][3]["work"]["force_evaluations"], 501);
    // 500 steps of each: explicit Euler multiplies the energy by (1 + h² k/m)^500 = 11.47.
    let energy = &report["outcomes"][0]["energy"];
    let ratio = energy["final_j"].as_f64().expect("J") / energy["initial_j"].as_f64().expect("J");
    assert!((ratio / 1.005_f64.powi(500) - 1.0).abs() < 1e-12, "{ratio}");
    assert_eq!(energy["class"], "growing");
    assert_eq!(report["outcomes"][1]["energy"]["class"], "bounded");
    let report = json(&["run", "scenes/oscillator/oscillator.yml"]);
    let rapier = &report["outcomes"][6];
    assert_eq!(
        (&rapier["engine"], &rapier["energy"]["class"]),
        (&"rapier".into(), &"dissipating".into())
    );
}
