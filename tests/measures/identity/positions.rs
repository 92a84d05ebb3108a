//! Positions without velocities.

use super::*;
use crate::testkit::{crossed, is_its_own, swinging_triangle};
use springcheck::integrators::fixed;
use springcheck::measure::identify::Undecided;
use springcheck::scene::DampingModel;
use std::collections::BTreeSet;

fn without_velocities(rows: Rows) -> Rows {
    Rows { v: None, ..rows }
}

/// Those that positions cannot tell apart: undamped, both symplectic Eulers give Verlet's positions
/// (velocities differ by half a kick); damped, the two still give each other's.
fn class(method: &str, damped: bool) -> BTreeSet<&str> {
    let eulers = ["symplectic_euler", "symplectic_euler_drift_first"];
    let mut class = BTreeSet::from([method]);
    if eulers.contains(&method) || (method == "velocity_verlet" && !damped) {
        class.extend(eulers);
        if !damped {
            class.insert("velocity_verlet");
        }
    }
    class
}

fn names(identity: &Identity) -> BTreeSet<&str> {
    let ids = identity
        .equivalent
        .iter()
        .map(|e| e.split('/').next().unwrap_or(e));
    ids.chain([identity.method.as_str()]).collect()
}

#[test]
fn positions_tell_methods_up_to_what_truly_coincides() {
    let cases = [(0.0, 1), (0.7, 2), (0.0, 2), (0.7, 1)];
    for (method, &(damping, substeps)) in crossed(fixed(), &cases) {
        let scene = swinging_triangle(damping, DampingModel::Axial);
        if !is_its_own(&scene, method) {
            continue;
        }
        let rows = without_velocities(run(&scene, method.id, substeps, 60));
        let identity = name(&scene, &rows);
        let class = class(method.id, damping > 0.0);
        assert_eq!(names(&identity), class, "{}: {identity:?}", method.id);
        assert_eq!(identity.substeps, substeps, "{}: {identity:?}", method.id);
        let same = match class.len() {
            1 => None,
            _ => Some(Undecided::SameMap),
        };
        assert_eq!(identity.undecided, same, "{identity:?}");
        // Found from positions, velocities round once more; measured up to 1.3.
        assert!(identity.defect <= 3.0, "{identity:?}");
        assert_eq!(identity.followed, identity.transitions);
    }
}

#[test]
fn uneven_rows_of_positions_tell_too() {
    let scene = swinging_triangle(0.0, DampingModel::Axial);
    for id in ["explicit_euler", "heun", "rk4", "implicit_midpoint"] {
        let all = without_velocities(run(&scene, id, 1, 120));
        let steps: Vec<u64> = (0..40).map(|k| (k * 7 + 1) / 3).collect();
        let row = |&k: &u64| &all.x[k as usize * all.dim..][..all.dim];
        let rows = Rows {
            x: steps.iter().flat_map(row).copied().collect(),
            steps,
            ..all.clone()
        };
        let identity = name(&scene, &rows);
        assert!(identity.decisive && identity.method == id, "{identity:?}");
    }
}

/// Six decimals of positions at a small step: rows apart tell nothing, and that is said.
#[test]
fn coarse_positions_at_a_small_step_tell_nothing() {
    let mut scene = swinging_triangle(0.0, DampingModel::Axial);
    scene.solver.timestep = 1e-4;
    let mut rows = without_velocities(run(&scene, "rk4", 1, 12));
    for c in &mut rows.x {
        *c = (*c * 1e6).round() / 1e6;
    }
    rows.precision = Precision::Decimals(6);
    rows.precision_v = rows.precision;
    let identity = name(&scene, &rows);
    assert!(
        !identity.decisive && identity.undecided == Some(Undecided::DataTooCoarse),
        "{identity:?}"
    );
    let found = names(&identity);
    assert!(
        found.contains("rk4") && found.contains("velocity_verlet"),
        "{identity:?}"
    );
}
