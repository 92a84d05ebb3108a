use super::samples::{empty, oscillator};
use crate::report::json::{self, Tool};
use crate::verbs::Report;

fn render(reports: &[Report]) -> String {
    json::render(&Tool::this(), reports)
}

#[test]
fn json_has_the_contract_s_keys() {
    let report = oscillator(&[0.01], 1.0, 8);
    let document: serde_json::Value = serde_json::from_str(&render(&[report])).unwrap();
    let value = &document["reports"][0];
    let keys = |value: &serde_json::Value| -> Vec<String> {
        let mut keys: Vec<String> = value.as_object().unwrap().keys().cloned().collect();
        keys.sort();
        keys
    };
    assert_eq!(keys(&document), ["reports", "schema_version", "tool"]);
    assert_eq!(keys(&document["tool"]), ["name", "platform", "version"]);
    assert_eq!(
        keys(value),
        [
            "advice", "checks", "outcomes", "scene", "series", "truth", "verb"
        ]
    );
    assert_eq!(
        keys(&value["scene"]),
        [
            "description",
            "duration",
            "effects",
            "energy_scale_j",
            "file",
            "name",
            "own_integrator",
            "particles",
            "springs",
            "timestep"
        ]
    );
    assert_eq!(
        keys(&value["scene"]["effects"][0]),
        ["evaluations", "id", "members", "wall_ns"]
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
            "explained",
            "identified",
            "kind",
            "momentum",
            "position_error_m",
            "reason",
            "remarks",
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
        [
            "force_evaluations",
            "linear_solves",
            "steps",
            "wall_s",
            "world"
        ]
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
fn json_is_one_object_for_any_number() {
    for count in 0..3 {
        let reports = vec![empty("a"); count];
        let text = render(&reports);
        assert!(text.starts_with("{\n") && text.ends_with("}\n"));
        let value: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(value["schema_version"], 2);
        assert_eq!(value["reports"].as_array().map(Vec::len), Some(count));
    }
}

#[test]
fn json_floats_round_trip() {
    let mut report = empty("floats");
    for value in [0.1, 1.0 / 3.0, f64::MAX, 5e-324, -0.0, 1e22] {
        report.header.scene.energy_scale_j = Some(value);
        let text = render(std::slice::from_ref(&report));
        let (_, read) = json::read::<Report>(text.as_bytes()).unwrap();
        let read = read[0].header.scene.energy_scale_j.unwrap();
        assert_eq!(read.to_bits(), value.to_bits());
    }
}

#[test]
#[cfg(debug_assertions)]
#[should_panic(expected = "NaN")]
fn json_refuses_nan() {
    let mut report = empty("\"NaN\\");
    render(std::slice::from_ref(&report));
    report.header.scene.energy_scale_j = Some(f64::NAN);
    render(std::slice::from_ref(&report));
}
