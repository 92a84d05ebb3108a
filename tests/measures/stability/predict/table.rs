//! One damped oscillator: limits and growth of every method, against its steps, formulas and rows.

use super::*;

const RATIOS: [f64; 5] = [0.0, 0.1, 0.5, 1.0, 2.0];
const W: f64 = 7.0;

/// Where no limit exists the search of one-step maps stops at 12, where it begins at 0.1 in the first
/// cell of 0.003.
fn one_step_law(method: &Method, build: Build) -> Result<(), String> {
    for zeta in RATIOS {
        let predicted = of_oscillator(method, W, zeta);
        let measured = measured_limit(build, zeta, 12.0).expect("solvable steps");
        let agree = match (&predicted, measured) {
            // The bisection ends at 1e-9. Damped, some maps have a double eigenvalue just where the
            // limit is, which rounding moves by its root: 1.5e-8.
            (Limit::At(h), Some(z)) => (h * W - z).abs() < if zeta > 0.0 { 3e-8 } else { 2e-9 },
            (Limit::Never, Some(z)) => z < 0.1,
            (Limit::Unconditional, None) => true,
            _ => false,
        };
        if !agree {
            return Err(format!(
                "{} ζ = {zeta}: {predicted:?}, {measured:?}",
                method.id
            ));
        }
    }
    Ok(())
}

#[test]
fn every_method_on_the_damped_oscillator_is_as_its_one_step_map_says() {
    for method in fixed().iter() {
        // Springs and dampers of one coordinate are along themselves; Oscillator says so of Material.
        one_step_law(method, &own(method)).unwrap();
    }
}

#[test]
fn a_wrong_region_is_seen() {
    let wrong = |id: &str, numerator: &'static [f64]| Method {
        amplification: Amplification::Rational(Rational {
            numerator,
            denominator: &[1.0],
        }),
        ..*method(id)
    };
    // Heun with z² for z²/2; RK4 without its last term.
    let heun = wrong("heun", &[1.0, 1.0, 1.0]);
    assert!(one_step_law(&heun, &own(method("heun"))).is_err());
    let rk4 = wrong("rk4", &[1.0, 1.0, 0.5, 1.0 / 6.0]);
    assert!(one_step_law(&rk4, &own(method("rk4"))).is_err());
    let verlet = Method {
        amplification: method("symplectic_euler").amplification,
        ..*method("velocity_verlet")
    };
    assert!(one_step_law(&verlet, &own(method("velocity_verlet"))).is_err());
}

#[test]
fn published_limits_are_predicted() {
    // ζ = .1, .5, 1, 2; six decimals, half a unit of the last.
    let table: [(&str, [f64; 4]); 5] = [
        ("explicit_euler", [0.2, 1.0, 2.0, 0.535_898]),
        ("heun", [1.049_755, 2.0, 2.0, 0.535_898]),
        ("rk4", [2.950_853, 2.622_542, 2.785_294, 0.746_317]),
        (
            "symplectic_euler",
            [1.809_975, 1.236_068, 0.828_427, 0.472_136],
        ),
        ("velocity_verlet", [2.013_432, 2.399_357, 4.002_670, 8.0]),
    ];
    for (id, limits) in table {
        for (zeta, limit) in RATIOS.into_iter().skip(1).zip(limits) {
            let Limit::At(h) = of_oscillator(method(id), W, zeta) else {
                panic!("{id} {zeta}");
            };
            assert!((h * W - limit).abs() < 1e-6, "{id} {zeta}: {}", h * W);
        }
    }
}

#[test]
fn rows_say_the_same_twice() {
    for method in fixed().iter() {
        let along = of_oscillator(method, W, 0.0);
        let across = about(&Across { w: W }, &[0.0]).predict(method, 0.01).limit;
        let below = |limit: &Limit, stated: f64| match limit {
            // Found by a scan of the map's eigenvalues, whose modulus may exceed 1 by 1e-12, or by the
            // polynomial that vanishes where they do: to the root of that.
            Limit::At(h) => (h * W - stated).abs() < 1e-6,
            _ => false,
        };
        let holds = match method.oscillator.stable {
            Stable::Never => along == Limit::Never && across == Limit::Never,
            Stable::Below(z) => below(&along, z) && below(&across, z),
            Stable::Always => along == Limit::Unconditional && across == Limit::Unconditional,
            Stable::AlwaysAlong { across: z } => along == Limit::Unconditional && below(&across, z),
        };
        assert!(holds, "{}: {along:?}, {across:?}", method.id);
    }
}

#[test]
fn growth_is_that_of_the_energy_law() {
    // Amplitudes grow with half the energy's rate: ln(1 + z²)/2, ln(1 + z⁴/4)/2 a step.
    let h = 0.003;
    let z = h * W;
    for (id, factor) in [("explicit_euler", z * z), ("midpoint", z.powi(4) / 4.0)] {
        let system = Oscillator { w: W, zeta: 0.0 };
        let prediction = about(&system, &[0.0]).predict(method(id), h);
        let growth = prediction.growth_per_s.unwrap();
        let stated = 0.5 * factor.ln_1p() / h;
        // A handful of roundings of a number that does not cancel.
        assert!(
            (growth / stated - 1.0).abs() < 1e-13,
            "{id}: {growth} {stated}"
        );
    }
}
