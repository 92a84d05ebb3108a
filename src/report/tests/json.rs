use super::samples::{empty, oscillator};
use crate::report::json;

#[test]
fn json_has_the_contract_s_keys() {
    let report = oscillator(&[0.01], 1.0, 8);
    let value: serde_json::Value = serde_json::from_str(&json::render(&report)).unwrap();
    let keys = |value: &serde_json::Value| -> Vec<String> {
        let mut keys: Vec<String> = value.as_object().unwrap().keys().cloned().collect();
        keys.sort();
        keys
    };
    assert_eq!(
        keys(&value),
        ["checks", "outcomes", "scene", "schema_version", "truth"]
    );
    assert_eq!(
        keys(&value["scene"]),
        [
            "duration",
            "effects",
            "energy_scale_j",
            "file",
            "name",
            "particles",
            "springs",
            "timestep"
        ]
    );
    assert_eq!(
        keys(&value["scene"]["effects"][0]),
        ["evaluations", "id", "members"]
    );
    assert_eq!(
        keys(&value["truth"]),
        ["error_bound_m", "horizon_s", "kind", "method", "reason"]
    );
    let outcome = &value["outcomes"][0];
    assert_eq!(
        keys(outcome),
        [
            "deviation_m",
            "energy",
            "engine",
            "identified",
            "kind",
            "momentum",
            "position_error_m",
            "reason",
            "status",
            "stopped_at_s",
            "substep",
            "timestep",
            "velocity_error_m_s",
            "work"
        ]
    );
    assert_eq!(
        keys(&outcome["deviation_m"]["rapier"]),
        ["final", "first_exceeds_s", "max"]
    );
    assert_eq!(
        keys(&outcome["work"]),
        ["force_evaluations", "linear_solves", "steps", "wall_s"]
    );
    assert_eq!(keys(&outcome["work"]["wall_s"]), ["mad", "median", "min"]);
    assert_eq!(outcome["status"], "completed");
    assert_eq!(outcome["energy"]["class"], "bounded");
    assert_eq!(
        keys(&value["checks"][0]),
        [
            "bound",
            "derivation",
            "id",
            "measured",
            "message",
            "status",
            "subject"
        ]
    );
}

#[test]
fn json_is_an_array_for_several() {
    let reports = [empty("a"), empty("b")];
    assert!(json::render_all(&reports).starts_with("[\n"));
    assert_eq!(json::render_all(&reports[..1]), json::render(&reports[0]));
    assert_eq!(json::render_all(&[]), "[]\n");
    assert!(json::render(&reports[0]).ends_with("}\n"));
}

#[test]
fn json_floats_round_trip() {
    let mut report = empty("floats");
    for value in [0.1, 1.0 / 3.0, f64::MAX, 5e-324, -0.0, 1e22] {
        report.scene.energy_scale_j = Some(value);
        let read: serde_json::Value = serde_json::from_str(&json::render(&report)).unwrap();
        let read = read["scene"]["energy_scale_j"].as_f64().unwrap();
        assert_eq!(read.to_bits(), value.to_bits());
    }
}

#[test]
#[cfg(debug_assertions)]
#[should_panic(expected = "NaN")]
fn json_refuses_nan() {
    let mut report = empty("\"NaN\\");
    json::render(&report);
    report.scene.energy_scale_j = Some(f64::NAN);
    json::render(&report);
}
