//! The JSON, and the laws between its keys.

use super::*;

const REACHED: [&str; 7] = [
    "engine",
    "timestep",
    "tolerance",
    "error_m",
    "wall_median_s",
    "force_evaluations",
    "at_most",
];

/// Exactly the contract's keys, and null only where it allows it.
pub fn keep_the_contract(report: &Value) {
    let top = [
        "verb", "series", "scene", "truth", "outcomes", "checks", "advice", "verdict", "remarks",
        "cost",
    ];
    assert_eq!(keys(report), set(&top));
    assert_eq!(report["verb"], "cost");
    assert_eq!(report["outcomes"], Value::Array(Vec::new()));
    let cost = &report["cost"];
    let wanted = ["duration_s", "horizon_s", "floor_m", "targets", "curves"];
    assert_eq!(keys(cost), set(&wanted));
    let truth = report["truth"]["kind"] != "none";
    for key in ["horizon_s", "floor_m"] {
        assert_eq!(cost[key].is_number(), truth, "{key}");
    }
    let integrators = curves(report).iter().filter(|c| c["kind"] == "integrator");
    let integrators = integrators.count();
    for target in array(&cost["targets"]) {
        let wanted = [
            "error_m",
            "cheapest",
            "fewest_evaluations",
            "ranking",
            "reference",
            "reason",
        ];
        assert_eq!(keys(target), set(&wanted));
        let (ranking, reference) = (array(&target["ranking"]), array(&target["reference"]));
        let judged = target["reason"].is_null();
        assert_eq!(ranking.len(), if judged { integrators } else { 0 });
        let all = if judged { curves(report).len() } else { 0 };
        assert_eq!(ranking.len() + reference.len(), all);
        let first = ranking
            .first()
            .map_or(&Value::Null, |rank| &rank["reached"]);
        assert_eq!(&target["cheapest"], first);
        assert_eq!(target["fewest_evaluations"].is_null(), first.is_null());
        for rank in ranking.iter().chain(reference) {
            let wanted = [
                "engine",
                "reached",
                "wall_ratio",
                "reason",
                "more_steps",
                "extrapolated_wall_ratio",
            ];
            assert_eq!(keys(rank), set(&wanted));
            let reached = &rank["reached"];
            assert_ne!(reached.is_null(), rank["reason"].is_null(), "{rank}");
            if !reached.is_null() {
                assert_eq!(keys(reached), set(&REACHED));
                assert!(rank["more_steps"].is_null(), "{rank}");
            }
        }
    }
    for curve in curves(report) {
        let wanted = [
            "engine",
            "kind",
            "order",
            "observed_order",
            "slope_points",
            "points",
            "pareto",
            "explanation",
        ];
        assert_eq!(keys(curve), set(&wanted));
        let ours = curve["kind"] == "integrator";
        assert_eq!(curve["order"].is_number(), ours, "{}", curve["engine"]);
        assert_eq!(curve["explanation"].is_null(), ours);
        let points = array(&curve["points"]);
        for index in array(&curve["slope_points"])
            .iter()
            .chain(array(&curve["pareto"]))
        {
            let at = index.as_u64().expect("an index") as usize;
            assert!(points[at]["error_m"].is_number());
        }
        for point in points {
            keep_the_contract_in(point, ours, truth);
        }
    }
}

fn keep_the_contract_in(point: &Value, ours: bool, truth: bool) {
    let wanted = [
        "timestep",
        "tolerance",
        "steps",
        "status",
        "reason",
        "error_m",
        "error_final_m",
        "energy_error",
        "at_floor",
        "wall_s",
        "force_evaluations",
        "linear_solves",
        "newton_iterations",
    ];
    assert_eq!(keys(point), set(&wanted));
    let completed = point["status"] == "completed";
    assert_eq!(point["reason"].is_null(), completed);
    assert!(completed || point["error_m"].is_null());
    assert!(truth || point["error_m"].is_null());
    assert_eq!(point["error_m"].is_null(), point["error_final_m"].is_null());
    assert_eq!(point["wall_s"].is_null(), !completed);
    if completed {
        assert_eq!(keys(&point["wall_s"]), set(&["min", "median", "mad"]));
        assert_eq!(point["force_evaluations"].is_u64(), ours, "{point}");
    }
}

#[test]
fn the_json_has_exactly_the_contracts_keys() {
    let report = small(&[SCENE, "--rapier", "iterations=8", "--targets", "1e-9,1e-2"]);
    keep_the_contract(&report);
    // Pairs after methods, rapier's rows after all; a row of one's own beside those that are swept anyway.
    let wanted = [
        "rk4",
        "symplectic_euler",
        "dormand_prince54",
        "rapier",
        "rapier(iterations=1)",
        "rapier(iterations=16)",
        "rapier(iterations=8)",
    ];
    assert_eq!(engines(&report), wanted);
    let targets = array(&report["cost"]["targets"]);
    let errors: Vec<f64> = targets.iter().map(|t| number(&t["error_m"])).collect();
    assert_eq!(errors, [1e-2, 1e-9], "coarse to fine, however typed");
    assert_eq!(report["cost"]["duration_s"], 5.0);
    for curve in curves(&report) {
        let pair = curve["engine"] == "dormand_prince54";
        let swept = if pair { "tolerance" } else { "timestep" };
        let settings = array(&curve["points"]).iter().map(|p| number(&p[swept]));
        let settings: Vec<f64> = settings.collect();
        assert!(settings.is_sorted_by(|a, b| a > b), "{settings:?}");
        for point in array(&curve["points"]) {
            assert_eq!(point["tolerance"].is_number(), pair);
        }
    }
}

#[test]
fn without_truth_there_are_prices_and_nobody_is_ranked() {
    // Two free particles in the plane: no closed form, and nothing else was allowed.
    let scene = "scenes/hard/spinning_pair.yml";
    for truth in ["closed", "none"] {
        let report = small(&[scene, "--truth", truth, "--engines", "none"]);
        keep_the_contract(&report);
        for target in array(&report["cost"]["targets"]) {
            let reason = target["reason"].as_str().expect("a reason");
            assert!(reason.starts_with("no truth"), "{reason}");
        }
        let points = curves(&report).iter().flat_map(|c| array(&c["points"]));
        assert!(points.clone().count() >= 6, "all are swept none the less");
        assert!(points.clone().all(|p| p["energy_error"].is_number()));
    }
}

#[test]
fn positions_are_held_against_the_truth_up_to_its_horizon() {
    // Past t = 1.7 the stars have met four times: with a truth that good the horizon is the whole run, so
    // this asks for longer.
    let report = small(&["scenes/hard/pleiades.yml", "--duration", "40"]);
    keep_the_contract(&report);
    let horizon = number(&report["cost"]["horizon_s"]);
    assert!(horizon > 3.0 && horizon < 40.0, "{horizon}");
}
