//! What follows from coefficients, against what is published, and of coefficients that are wrong.

use crate::testkit::{method, own};
use springcheck::conformance::{Claims, find};
use springcheck::integrators::{
    Amplification, Coefficients, DampingTreatment, EnergyLaw, Method, MethodRow, REGISTRY,
    Settings, Stable, Stage, Tableau, fixed,
};
use springcheck::measure::CheckStatus;

/// Hairer, Nørsett, Wanner, Solving ODEs I; Hairer, Lubich, Wanner, Geometric Numerical Integration; and the
/// papers on the rows: id, order, order with damping, symplectic, reversible.
const PUBLISHED: [(&str, [u32; 2], [bool; 2]); 25] = [
    ("explicit_euler", [1, 1], [false, false]),
    ("symplectic_euler", [1, 1], [true, false]),
    ("symplectic_euler_drift_first", [1, 1], [true, false]),
    ("midpoint", [2, 2], [false, false]),
    ("heun", [2, 2], [false, false]),
    ("ralston", [2, 2], [false, false]),
    ("velocity_verlet", [2, 2], [true, true]),
    ("position_verlet", [2, 2], [true, true]),
    ("boris", [2, 2], [true, true]),
    ("rattle", [2, 2], [true, true]),
    ("shake", [2, 2], [true, true]),
    ("rk3", [3, 3], [false, false]),
    ("ssprk3", [3, 3], [false, false]),
    ("rk4", [4, 4], [false, false]),
    ("yoshida4", [4, 4], [true, true]),
    ("pefrl", [4, 4], [true, true]),
    ("implicit_euler", [1, 1], [false, false]),
    ("linearized_implicit_predicted", [1, 1], [false, false]),
    ("linearized_implicit_at_start", [1, 1], [false, false]),
    ("linearized_implicit_material", [1, 1], [false, false]),
    ("implicit_midpoint", [2, 2], [true, true]),
    ("trapezoidal", [2, 2], [false, true]),
    ("tr_bdf2", [2, 2], [false, false]),
    ("dormand_prince54", [5, 5], [false, false]),
    ("dop853", [8, 8], [false, false]),
];

#[test]
fn orders_and_symmetries_are_the_published_ones() {
    for (row, (id, orders, [symplectic, reversible])) in REGISTRY.iter().zip(PUBLISHED) {
        assert_eq!(row.id, id);
        assert_eq!([row.order, row.order_damped], orders, "{id}");
        assert_eq!(row.symplectic, symplectic, "{id}");
        assert_eq!(row.reversible, reversible, "{id}");
    }
    // With textbook kicks a splitting is of first order in the damping.
    for stages in [Stage::VERLET, Stage::YOSHIDA4, Stage::PEFRL] {
        let textbook = with(Coefficients::Composition(
            stages,
            DampingTreatment::Explicit,
        ));
        assert_eq!(textbook.order_damped, 1);
        assert!(textbook.order > 1);
    }
}

#[test]
fn limits_are_the_published_ones() {
    let limit = |id: &str| match method(id).oscillator.stable {
        Stable::Below(z) => z,
        other => panic!("{id}: {other:?}"),
    };
    assert!((limit("rk4") - 8_f64.sqrt()).abs() < 1e-15);
    for id in ["rk3", "ssprk3"] {
        assert!((limit(id) - 3_f64.sqrt()).abs() < 1e-15, "{id}");
    }
    assert_eq!(limit("symplectic_euler"), 2.0);
    assert_eq!(limit("velocity_verlet"), 2.0);
    // Published to six decimals.
    assert!((limit("yoshida4") - 1.573_402).abs() < 5e-7);
    assert!((limit("pefrl") - 2.989_450).abs() < 5e-7);
    let across = Stable::AlwaysAlong { across: 2.0 };
    let material = method("linearized_implicit_material").oscillator.stable;
    assert_eq!(material, across);
    // Hairer, Wanner, Solving ODEs II, IV.2: on the negative axis.
    let real = [
        ("explicit_euler", 2.0),
        ("rk3", 2.512_745_326_618_329),
        ("ssprk3", 2.512_745_326_618_329),
        ("rk4", 2.785_293_563_405_282),
    ];
    for (id, wanted) in real {
        let Amplification::Rational(rational) = method(id).amplification else {
            panic!("{id}");
        };
        let Stable::Below(real) = rational.reach(nalgebra::Complex::new(-3.0, 0.0)) else {
            panic!("{id}");
        };
        assert!((real - wanted).abs() < 1e-14, "{id} {real}");
        let outward = rational.reach(nalgebra::Complex::new(1.0, 0.0));
        assert_eq!(outward, Stable::Never);
    }
}

/// What a formula says, written a second time for machines.
fn stated(formula: &str, z: f64) -> Vec<f64> {
    let corner = (2.0 + 2_f64.sqrt()).powi(2);
    match formula {
        "1 + z²" => vec![1.0 + z * z],
        "1 + z⁴/4" => vec![1.0 + z.powi(4) / 4.0],
        "1 - z⁴/12 + z⁶/36" => vec![1.0 - z.powi(4) / 12.0 + z.powi(6) / 36.0],
        "1 - z⁶/72 + z⁸/576" => vec![1.0 - z.powi(6) / 72.0 + z.powi(8) / 576.0],
        "1/(1 + z²)" => vec![1.0 / (1.0 + z * z)],
        "1" => vec![1.0],
        "1 - (z²/(z² + (2 + √2)²))²" => vec![1.0 - (z * z / (z * z + corner)).powi(2)],
        "[1/(1 + z/2), 1/(1 - z/2)]" => vec![1.0 / (1.0 + z / 2.0), 1.0 / (1.0 - z / 2.0)],
        "[1 - z²/4, 1]" => vec![1.0 - z * z / 4.0, 1.0],
        "[1, 1/(1 - z²/4)]" => vec![1.0, 1.0 / (1.0 - z * z / 4.0)],
        other => panic!("{other} is not known"),
    }
}

fn computed(law: EnergyLaw, z: f64) -> Option<(&'static str, Vec<f64>)> {
    match law {
        EnergyLaw::Factor { factor, formula } => Some((formula, vec![factor(z)])),
        EnergyLaw::Band { band, formula } => Some((formula, <[f64; 2]>::from(band(z)).to_vec())),
        EnergyLaw::Bounded => None,
    }
}

fn formula_law(row: &Method, formula: Option<&str>) -> Result<(), String> {
    for z in [0.01, 0.1, 0.5, 1.0, 1.5, 1.9] {
        let Some((own, found)) = computed(row.oscillator.energy, z) else {
            continue;
        };
        // The row states none.
        if formula.is_none() && own == "|R(iz)|²" {
            continue;
        }
        for (found, wanted) in found.iter().zip(stated(formula.unwrap_or(own), z)) {
            // Near its limit the upper edge of a band multiplies roundings of z by 1/(1 - z/2).
            if (found / wanted - 1.0).abs() > 1e-14 {
                return Err(format!("{} at {z}: {found}, {wanted}", row.id));
            }
        }
    }
    Ok(())
}

#[test]
fn formulas_for_people_are_what_is_computed() {
    for row in fixed().iter() {
        formula_law(row, None).unwrap();
    }
    formula_law(method("midpoint"), Some("1 + z²")).unwrap_err();
    formula_law(method("velocity_verlet"), Some("[1, 1/(1 - z²/4)]")).unwrap_err();
}

fn with(coefficients: Coefficients) -> Method {
    Method::new(MethodRow {
        id: "own",
        name: "one's own",
        coefficients,
        energy: None,
        source: "",
        not: "",
    })
}

/// Every swap of two neighbours that differ.
fn swapped<T: Copy + PartialEq + 'static>(values: &[T]) -> impl Iterator<Item = &'static [T]> {
    let at = (1..values.len()).filter(|&at| values[at - 1] != values[at]);
    at.map(|at| {
        let mut values = values.to_vec();
        values.swap(at - 1, at);
        &*values.leak()
    })
}

#[test]
fn swapped_weights_give_another_order_and_the_claim_fails() {
    let mut mutants = Vec::new();
    for row in fixed().iter().filter(|row| row.order > 1) {
        match row.coefficients {
            Coefficients::Tableau(tableau) => mutants.extend(
                swapped(tableau.b)
                    .map(|b| (row, with(Coefficients::Tableau(Tableau { b, ..tableau })))),
            ),
            Coefficients::Composition(stages, damping) if row.order > 2 => mutants.extend(
                swapped(stages).map(|s| (row, with(Coefficients::Composition(s, damping)))),
            ),
            _ => {}
        }
    }
    assert!(mutants.len() > 10);
    let law = find("order").expect("a law");
    for (row, mutant) in &mutants {
        assert!(mutant.order < row.order, "{}: {}", row.id, mutant.order);
        let build = || mutant.build(&Settings::default());
        let found = law.check(&build, &Claims::from(*row));
        assert_eq!(found.status, CheckStatus::Fail, "{}", row.id);
        // But the order that follows from what it is made of holds.
        let honest = law.check(&build, &Claims::from(mutant));
        assert_ne!(
            honest.status,
            CheckStatus::Fail,
            "{}: {}",
            row.id,
            honest.message
        );
    }
}

/// Heun's (1900) and Ruth's symplectic method (1983): both of order 3.
#[test]
fn methods_that_are_not_in_the_registry_have_facts_too() {
    let heun3 = with(Coefficients::Tableau(Tableau {
        a: &[&[], &[1.0 / 3.0], &[0.0, 2.0 / 3.0]],
        b: &[0.25, 0.0, 0.75],
        c: &[0.0, 1.0 / 3.0, 2.0 / 3.0],
    }));
    let ruth3 = with(Coefficients::Composition(
        &[
            Stage::Kick(7.0 / 24.0),
            Stage::Drift(2.0 / 3.0),
            Stage::Kick(3.0 / 4.0),
            Stage::Drift(-2.0 / 3.0),
            Stage::Kick(-1.0 / 24.0),
            Stage::Drift(1.0),
        ],
        DampingTreatment::Explicit,
    ));
    assert_eq!([heun3.order, heun3.order_damped], [3, 3]);
    assert_eq!([ruth3.order, ruth3.order_damped], [3, 1]);
    assert!(ruth3.symplectic && !ruth3.reversible);
    for method in [heun3, ruth3] {
        let build = || method.build(&Settings::default());
        for finding in springcheck::conformance::check(&build, &Claims::from(&method)) {
            assert_ne!(finding.status, CheckStatus::Fail, "{finding:?}");
        }
    }
    // The kit's own rows go the same way.
    let verlet = method("velocity_verlet");
    let again = with(verlet.coefficients);
    let findings = springcheck::conformance::check(&own(verlet), &Claims::from(&again));
    assert!(findings.iter().all(|f| f.status != CheckStatus::Fail));
}
