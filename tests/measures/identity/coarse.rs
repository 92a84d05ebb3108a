//! Rounded data: named where it can be, and said to be too coarse where not.

use super::*;
use crate::testkit::{crossed, is_its_own, swinging_triangle};
use springcheck::integrators::fixed;
use springcheck::measure::identify::{FIT, TRUTH, Undecided};
use springcheck::scene::DampingModel;

fn rounded(mut rows: Rows, precision: Precision) -> Rows {
    let round = |c: f64| match precision {
        Precision::Double => c,
        Precision::Single => f64::from(c as f32),
        Precision::SingleDecimals(d) => format!("{:.*}", d as usize, c as f32)
            .parse()
            .expect("a number"),
        Precision::Decimals(d) => format!("{c:.*}", d as usize).parse().expect("a number"),
        Precision::Digits(d) => {
            let text = format!("{c:.*e}", d as usize - 1);
            text.parse().expect("a number")
        }
    };
    for c in rows.x.iter_mut().chain(rows.v.iter_mut().flatten()) {
        *c = round(*c);
    }
    rows.precision = precision;
    rows.precision_v = precision;
    rows
}

const ROUNDINGS: [Precision; 3] = [
    Precision::Single,
    Precision::Digits(6),
    Precision::Decimals(6),
];

/// Whatever is said holds: a decisive name is the right one, else the right one is in the class, and
/// the reason is that the data is too coarse.
fn honest(identity: &Identity, method: &str, substeps: u32) -> Result<(), String> {
    let right = identity.method == method && identity.substeps == substeps;
    let listed = identity.method == method
        || identity
            .equivalent
            .iter()
            .any(|e| e.split('/').next() == Some(method));
    let held = match identity.undecided {
        None => right && identity.decisive,
        Some(Undecided::SameMap | Undecided::DataTooCoarse) => listed && !identity.decisive,
        Some(Undecided::Near) => false,
    };
    if held && identity.followed == identity.transitions && identity.defect <= FIT {
        Ok(())
    } else {
        Err(format!("{method}/{substeps}: {identity:?}"))
    }
}

#[test]
fn what_is_said_of_rounded_data_holds() {
    let cases = [(0.7, 1), (0.0, 3)];
    let cases = cases.map(|case| ROUNDINGS.map(|precision| (case, precision)));
    let damped = swinging_triangle(0.7, DampingModel::Axial);
    let mut methods = fixed().to_vec();
    methods.retain(|method| is_its_own(&damped, method));
    let tried = crossed(&methods, cases.as_flattened());
    let mut decided = 0;
    for (method, ((damping, substeps), precision)) in &tried {
        let scene = swinging_triangle(*damping, DampingModel::Axial);
        if !is_its_own(&scene, method) {
            continue;
        }
        let rows = run(&scene, method.id, *substeps, 200);
        let found = found(&scene, &rounded(rows, *precision), None);
        let Some(identity) = found.identity else {
            // Substeps whose error these digits do not show.
            let scheme = found.explained.and_then(|explained| explained.scheme);
            assert_eq!(scheme.as_deref(), Some(TRUTH), "{}", method.id);
            assert!(*substeps > 1, "{}", method.id);
            continue;
        };
        honest(&identity, method.id, *substeps).unwrap();
        decided += usize::from(identity.decisive);
    }
    // The rest are methods of high order, which such data does not tell apart at this step.
    assert!(2 * decided >= tried.len(), "{decided} of {}", tried.len());
}

/// They differ from implicit Euler by the bending of forces over a step, which six digits do not show.
const LINEARISED: [&str; 2] = [
    "linearized_implicit_predicted",
    "linearized_implicit_at_start",
];

/// First-order methods differ by h², which six digits show at h = 0.01.
#[test]
fn six_digits_tell_methods_of_low_order() {
    let scene = swinging_triangle(0.7, DampingModel::Axial);
    for method in fixed()
        .iter()
        .filter(|m| m.order == 1 && !LINEARISED.contains(&m.id))
    {
        for precision in ROUNDINGS {
            let identity = name(&scene, &rounded(run(&scene, method.id, 1, 200), precision));
            let named = identity.decisive && identity.method == method.id;
            assert!(
                named || method.id == "implicit_euler",
                "{precision:?} {identity:?}"
            );
        }
    }
}

/// Three decimals show no method of order two or four from another.
#[test]
fn three_decimals_do_not_decide() {
    let scene = swinging_triangle(0.0, DampingModel::Axial);
    for id in ["midpoint", "velocity_verlet", "rk4", "trapezoidal"] {
        let rows = rounded(run(&scene, id, 1, 200), Precision::Decimals(3));
        let identity = name(&scene, &rows);
        honest(&identity, id, 1).unwrap();
        assert_eq!(
            identity.undecided,
            Some(Undecided::DataTooCoarse),
            "{identity:?}"
        );
    }
}

/// What there is no time to compare is not told apart: rows that several methods explain never have one name alone.
#[test]
fn few_replays_decide_nothing() {
    let scene = swinging_triangle(0.0, DampingModel::Axial);
    let rows = rounded(run(&scene, "rk4", 1, 200), Precision::Decimals(4));
    for budget in [500_000, 2_000_000, 20_000_000] {
        let identity = found_within(budget, &scene, &rows, None).identity;
        let identity = identity.expect("something to replay");
        honest(&identity, "rk4", 1).unwrap();
        assert!(!identity.decisive, "{budget}: {identity:?}");
    }
}

/// The law is not empty: rounded data of another method, or of another scene, breaks it.
#[test]
fn the_law_of_rounded_data_kills_mutants() {
    let scene = swinging_triangle(0.0, DampingModel::Axial);
    let rows = rounded(run(&scene, "explicit_euler", 1, 200), Precision::Digits(6));
    let identity = name(&scene, &rows);
    assert!(honest(&identity, "explicit_euler", 1).is_ok());
    assert!(honest(&identity, "symplectic_euler", 1).is_err());
    assert!(honest(&identity, "explicit_euler", 2).is_err());
    let mut stiffer = scene.clone();
    stiffer.springs[0].stiffness *= 1.01;
    let identity = name_of(&stiffer, &rows, None);
    assert!(identity.is_none_or(|identity| honest(&identity, "explicit_euler", 1).is_err()));
}

/// Single transitions are too coarse for five decimals at a small step; longer stretches are not.
#[test]
fn differences_add_up_over_longer_stretches() {
    let mut scene = swinging_triangle(0.0, DampingModel::Axial);
    scene.solver.timestep = 1e-3;
    for id in [
        "explicit_euler",
        "symplectic_euler",
        "symplectic_euler_drift_first",
    ] {
        let rows = rounded(run(&scene, id, 1, 300), Precision::Decimals(5));
        let identity = name(&scene, &rows);
        let rest = identity
            .equivalent
            .iter()
            .filter(|e| integrators::find(e).is_some());
        assert!(identity.method == id && rest.count() == 0, "{identity:?}");
        // Three rows leave no longer stretch.
        let few = Rows {
            steps: rows.steps[..3].to_vec(),
            x: rows.x[..3 * rows.dim].to_vec(),
            v: rows.v.as_ref().map(|v| v[..3 * rows.dim].to_vec()),
            ..rows.clone()
        };
        let identity = name(&scene, &few);
        assert!(
            !identity.decisive && identity.undecided == Some(Undecided::DataTooCoarse),
            "{identity:?}"
        );
    }
}
