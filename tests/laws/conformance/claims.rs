//! Any claim that is changed is caught, whichever row it is changed on and whichever way.

use crate::testkit::{method, own, part};
use rayon::prelude::*;
use springcheck::conformance::{self, Claims, check};
use springcheck::integrators::{EnergyLaw, Method, PerStep, Stable, fixed};
use springcheck::measure::CheckStatus;

fn status(law: &str, row: &'static Method, claims: &Claims) -> CheckStatus {
    conformance::find(law)
        .expect(law)
        .check(&own(row), claims)
        .status
}

fn fails(law: &str, row: &'static Method, claims: &Claims) {
    assert_eq!(
        status(law, row, claims),
        CheckStatus::Fail,
        "{law}: {}: {claims:?}",
        row.id
    );
}

#[test]
fn claims_too_high_and_too_low_are_caught() {
    fixed().par_iter().enumerate().for_each(|(at, row)| {
        let own = Claims::from(row);
        for &order in part(&[row.order - 1, row.order + 1], 2, at) {
            fails("order", row, &Claims { order, ..own });
            fails("order-driven", row, &Claims { order, ..own });
        }
        for &damped in part(&[row.order_damped - 1, row.order_damped + 1], 2, at) {
            let claims = Claims {
                order_damped: Some(damped),
                ..own
            };
            fails("order-damped", row, &claims);
            // Of the balance less may be claimed.
            let balance = status("balance", row, &claims);
            assert_eq!(
                balance == CheckStatus::Fail,
                damped > row.order_damped,
                "{}",
                row.id
            );
        }
        fails(
            "symplecticity",
            row,
            &Claims {
                symplectic: !row.symplectic,
                ..own
            },
        );
        fails(
            "reversal",
            row,
            &Claims {
                reversible: !row.reversible,
                ..own
            },
        );
        let exact = !row.exact;
        fails("exactness", row, &Claims { exact, ..own });
        for by in [-1, 1] {
            let evaluations = Some(match row.evaluations {
                PerStep::Exactly(n) => PerStep::Exactly(n.saturating_add_signed(by)),
                PerStep::PerIteration { plus } => PerStep::PerIteration {
                    plus: plus.saturating_add_signed(by),
                },
            });
            fails("evaluations", row, &Claims { evaluations, ..own });
        }
    });
}

#[test]
fn other_limits_are_caught() {
    fixed().par_iter().for_each(|row| {
        let mut oscillator = row.oscillator;
        let mut others = vec![
            Stable::Never,
            Stable::Always,
            Stable::AlwaysAlong { across: 2.0 },
        ];
        if let Stable::Below(limit) = oscillator.stable {
            others.extend([limit - 2e-6, limit + 2e-6].map(Stable::Below));
        } else {
            others.push(Stable::Below(2.0));
        }
        if let Stable::AlwaysAlong { across } = oscillator.stable {
            let near = [across - 2e-6, across + 2e-6];
            others.extend(near.map(|across| Stable::AlwaysAlong { across }));
        }
        for other in others
            .into_iter()
            .filter(|other| *other != row.oscillator.stable)
        {
            oscillator.stable = other;
            let claims = Claims {
                oscillator: Some(oscillator),
                ..Claims::from(row)
            };
            let laws = ["stability", "stability-across"].map(|law| status(law, row, &claims));
            assert!(laws.contains(&CheckStatus::Fail), "{}: {other:?}", row.id);
        }
    });
}

fn formula(law: EnergyLaw) -> &'static str {
    match law {
        EnergyLaw::Factor { formula, .. } | EnergyLaw::Band { formula, .. } => formula,
        EnergyLaw::Bounded => "bounded",
    }
}

#[test]
fn other_energy_laws_are_caught() {
    fixed().par_iter().for_each(|row| {
        let real = row.oscillator.energy;
        // Bounded is what stays in a band, and what is kept.
        let is_bounded = !matches!(real, EnergyLaw::Factor { .. }) || formula(real) == "1";
        let mut laws: Vec<EnergyLaw> = fixed().iter().map(|row| row.oscillator.energy).collect();
        laws.sort_by_key(|law| formula(*law));
        laws.dedup_by_key(|law| formula(*law));
        for other in laws {
            let mut oscillator = row.oscillator;
            oscillator.energy = other;
            let claims = Claims {
                oscillator: Some(oscillator),
                ..Claims::from(row)
            };
            let so = formula(other) == formula(real) || formula(other) == "bounded" && is_bounded;
            let expected = if so {
                CheckStatus::Pass
            } else {
                CheckStatus::Fail
            };
            assert_eq!(
                status("energy", row, &claims),
                expected,
                "{}: {}",
                row.id,
                formula(other)
            );
        }
    });
}

/// Multiples of the initial energy at z.
type Band = springcheck::integrators::OfZ<(f64, f64)>;

#[test]
fn bands_too_wide_or_too_narrow_at_one_edge_are_caught() {
    let bands: [(&str, Band); 5] = [
        ("velocity_verlet", &|z| (1.0 - z * z / 3.9, 1.0)),
        ("velocity_verlet", &|z| (1.0 - z * z / 4.1, 1.0)),
        ("velocity_verlet", &|z| {
            (1.0 - z * z / 4.0, 1.0 + z * z / 400.0)
        }),
        ("symplectic_euler", &|z| {
            (1.0 - z / 2.0, 1.0 / (1.0 - z / 2.0))
        }),
        ("symplectic_euler", &|z| {
            (1.0 / (1.0 + z / 2.0), 1.0 + z / 2.0)
        }),
    ];
    for (id, band) in bands {
        let row = method(id);
        let mut oscillator = row.oscillator;
        oscillator.energy = EnergyLaw::Band { band, formula: "" };
        let claims = Claims {
            oscillator: Some(oscillator),
            ..Claims::from(row)
        };
        fails("energy", row, &claims);
    }
}

#[test]
fn what_is_not_claimed_is_skipped() {
    let claims = Claims {
        symplectic: true,
        reversible: true,
        ..Claims::of_order(2)
    };
    let findings = check(&own(method("velocity_verlet")), &claims);
    let skipped: Vec<&str> = findings
        .iter()
        .filter(|finding| finding.status == CheckStatus::Skip)
        .map(|finding| finding.law)
        .collect();
    assert_eq!(
        skipped,
        [
            "order-damped",
            "balance",
            "energy",
            "stability",
            "stability-across",
            "evaluations"
        ]
    );
    let others = findings
        .iter()
        .filter(|finding| !skipped.contains(&finding.law));
    for finding in others {
        assert_eq!(finding.status, CheckStatus::Pass, "{finding:?}");
    }
}

#[test]
fn claims_out_of_range_fail_and_end() {
    let row = method("velocity_verlet");
    let nan: Band = &|_| (f64::NAN, f64::NAN);
    let mut oscillator = row.oscillator;
    oscillator.energy = EnergyLaw::Band {
        band: nan,
        formula: "",
    };
    let claims = |oscillator| Claims {
        oscillator: Some(oscillator),
        ..Claims::from(row)
    };
    fails("energy", row, &claims(oscillator));
    oscillator.energy = EnergyLaw::Factor {
        factor: &|_| f64::NAN,
        formula: "",
    };
    fails("energy", row, &claims(oscillator));
    for limit in [0.0, -1.0, 1e12, f64::INFINITY, f64::NAN] {
        oscillator.stable = Stable::Below(limit);
        fails("stability", row, &claims(oscillator));
        fails("stability-across", row, &claims(oscillator));
    }
}
