//! How far methods are stable on the damped oscillator: published numbers. What a row says of the
//! undamped one is a law of the public kit (`conformance`).

use crate::testkit::mutants::{self, mutant};
use crate::testkit::{Build, method, own};
use springcheck::conformance::measured_limit;

/// Published limits with damping ratio ζ; None is no limit.
const DAMPED: [(&str, [Option<f64>; 4]); 11] = [
    (
        "explicit_euler",
        [Some(0.2), Some(1.0), Some(2.0), Some(0.535_898)],
    ),
    (
        "midpoint",
        [Some(1.049_755), Some(2.0), Some(2.0), Some(0.535_898)],
    ),
    (
        "heun",
        [Some(1.049_755), Some(2.0), Some(2.0), Some(0.535_898)],
    ),
    (
        "ralston",
        [Some(1.049_755), Some(2.0), Some(2.0), Some(0.535_898)],
    ),
    (
        "rk3",
        [
            Some(2.154_049),
            Some(2.521_659),
            Some(2.512_745),
            Some(0.673_288),
        ],
    ),
    (
        "ssprk3",
        [
            Some(2.154_049),
            Some(2.521_659),
            Some(2.512_745),
            Some(0.673_288),
        ],
    ),
    (
        "rk4",
        [
            Some(2.950_853),
            Some(2.622_542),
            Some(2.785_294),
            Some(0.746_317),
        ],
    ),
    (
        "symplectic_euler",
        [
            Some(1.809_975),
            Some(1.236_068),
            Some(0.828_427),
            Some(0.472_136),
        ],
    ),
    (
        "symplectic_euler_drift_first",
        [
            Some(1.809_975),
            Some(1.236_068),
            Some(0.828_427),
            Some(0.472_136),
        ],
    ),
    // With the exact flow the kick saturates at x / (2 ζ w), so overdamped the limit is 4 ζ.
    (
        "velocity_verlet",
        [Some(2.013_432), Some(2.399_357), Some(4.002_670), Some(8.0)],
    ),
    ("implicit_euler", [None; 4]),
];

fn damped_limit_law(id: &str, limits: [Option<f64>; 4], build: Build) -> Result<(), String> {
    for (zeta, limit) in [0.1, 0.5, 1.0, 2.0].into_iter().zip(limits) {
        let found = measured_limit(build, zeta, 12.0).expect("solvable steps");
        let holds = match (found, limit) {
            (Some(found), Some(limit)) => (found - limit).abs() < 1e-6,
            (None, None) => true,
            _ => false,
        };
        if !holds {
            return Err(format!(
                "{id}, ζ = {zeta}: stated {limit:?}, measured {found:?}"
            ));
        }
    }
    Ok(())
}

#[test]
fn limits_with_damping_are_the_published_ones() {
    for (id, limits) in DAMPED {
        damped_limit_law(id, limits, &own(method(id))).unwrap();
    }
}

#[test]
fn limits_with_damping_kill_mutants() {
    let verlet = DAMPED[9];
    let explicit = mutant(mutants::verlet_with_explicit_damping);
    assert!(damped_limit_law(verlet.0, verlet.1, &explicit).is_err());
    let symplectic = DAMPED[7];
    let half = mutant(mutants::symplectic_euler_at_half_the_step);
    assert!(damped_limit_law(symplectic.0, symplectic.1, &half).is_err());
}
