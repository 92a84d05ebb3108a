//! More coordinates than are solved whole.

use super::*;
use springcheck::integrators::DampingTreatment;

/// A sheet of `rows` by `columns` pinned along its first column, jittered, dampers unequal: nothing
/// decouples.
fn cloth(rows: usize, columns: usize, damping: f64) -> Scene {
    let mut random = Random(7);
    let mut particles = Vec::new();
    let mut springs = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let position = [
                column as f64 + 0.1 * random.next(),
                row as f64 + 0.1 * random.next(),
                0.2 * random.next(),
            ];
            particles.push(particle(position, 0.1, column == 0));
            let own = row * columns + column;
            let mut join = |other: usize| {
                let damping = damping * (1.5 + random.next());
                springs.push(spring(own, other, 300.0, damping, 0.9));
            };
            if column > 0 {
                join(own - 1);
            }
            if row > 0 {
                join(own - columns);
            }
        }
    }
    scene(particles, springs, DampingModel::Axial)
}

#[test]
fn krylov_spaces_find_what_dense_solvers_do() {
    // 12 x 15 particles, 14 of 15 free: 504 coordinates, coupled.
    let dense = Effort {
        symmetric: 2_000,
        unsymmetric: 2_000,
        ..Effort::FULL
    };
    let sparse = Effort {
        symmetric: 10,
        unsymmetric: 10,
        ..Effort::FULL
    };
    for (damping, methods) in [
        (0.0, ["symplectic_euler", "velocity_verlet", "pefrl"]),
        (1.0, ["rk4", "rk4", "rk4"]),
    ] {
        let (system, state) = built(&cloth(12, 15, damping));
        let with = |effort| Linearised::new(&system, &state, effort);
        let (whole, part) = (with(dense), with(sparse));
        for id in methods {
            let limits = [&whole, &part].map(|l| l.predict(method(id), 0.01).limit);
            let [Limit::At(whole), Limit::At(part)] = limits else {
                panic!("{id}, damping {damping}: {limits:?}");
            };
            let off = (part / whole - 1.0).abs();
            assert!(off < 1e-9, "{id}, damping {damping}: {off:e}");
        }
        let omegas = [&whole, &part].map(|l| l.omega_max().unwrap());
        assert!((omegas[0] / omegas[1] - 1.0).abs() < 1e-9, "{omegas:?}");
    }
}

#[test]
fn large_and_damped_is_as_small_and_damped() {
    // Single-kick methods by their definite matrix, against the search of the one-step map.
    let (system, state) = built(&cloth(3, 4, 2.0));
    // With exact flows, which have a definite matrix whatever shares a particle.
    let with = |id: &str, stages: Option<&'static [springcheck::integrators::Stage]>| {
        let Amplification::Composition(own, damping) = method(id).amplification else {
            panic!("{id}");
        };
        let damping = match damping {
            DampingTreatment::Sweeps => DampingTreatment::ExactFlow,
            other => other,
        };
        Method {
            amplification: Amplification::Composition(stages.unwrap_or(own), damping),
            ..*method(id)
        }
    };
    let map_only = |id: &str| {
        // PEFRL's treatment of any list of stages goes through the map: Verlet twice, at half the step,
        // is Verlet.
        let stages: &'static [springcheck::integrators::Stage] = match id {
            "velocity_verlet" => &[
                springcheck::integrators::Stage::Kick(0.25),
                springcheck::integrators::Stage::Drift(0.5),
                springcheck::integrators::Stage::Kick(0.5),
                springcheck::integrators::Stage::Drift(0.5),
                springcheck::integrators::Stage::Kick(0.25),
            ],
            _ => &[
                springcheck::integrators::Stage::Kick(0.5),
                springcheck::integrators::Stage::Drift(0.5),
                springcheck::integrators::Stage::Kick(0.5),
                springcheck::integrators::Stage::Drift(0.5),
            ],
        };
        with(id, Some(stages))
    };
    let linearised = Linearised::new(&system, &state, Effort::FULL);
    for id in ["velocity_verlet", "symplectic_euler"] {
        let once = linearised.predict(&with(id, None), 0.01).limit;
        let twice = linearised.predict(&map_only(id), 0.01).limit;
        let (Limit::At(once), Limit::At(twice)) = (&once, &twice) else {
            panic!("{id}: {once:?} {twice:?}");
        };
        // The map's search ends where the radius passes 1 by 1e-10.
        assert!(
            (twice / once / 2.0 - 1.0).abs() < 1e-8,
            "{id}: {once} {twice}"
        );
    }
}

/// Without any eigenvalue: by the stiffest vector and a radius.
const BLIND: Effort = Effort {
    unsymmetric: 0,
    outermost: 0,
    ..Effort::FULL
};

/// A limit known from a bound holds: the true one is no less than what is called certain, and where
/// `factor` is 1 near what is estimated.
fn bound_law(factor: f64) -> Result<(), String> {
    let (system, state) = built(&cloth(4, 5, 1.0));
    let with = |effort| Linearised::new(&system, &state, effort);
    let (known, blind) = (with(Effort::FULL), with(BLIND));
    let rk4 = method("rk4");
    let Limit::At(exact) = known.predict(rk4, 0.01).limit else {
        return Err("RK4 has a limit".to_owned());
    };
    let guess = blind.predict(rk4, 0.01);
    let Limit::At(estimate) = guess.limit else {
        return Err(format!("{guess:?}"));
    };
    let reason = guess.reason.unwrap_or_default();
    let sure = reason
        .split("certainly stable up to ")
        .nth(1)
        .and_then(|rest| rest.split(' ').next()?.parse::<f64>().ok())
        .ok_or(reason)?;
    // Estimated to a tenth; shown in three digits.
    let near = (factor * estimate / exact - 1.0).abs() < 0.1;
    if near && factor * sure <= exact * 1.005 && sure < estimate {
        Ok(())
    } else {
        Err(format!("exact {exact}, estimate {estimate}, sure {sure}"))
    }
}

#[test]
fn a_bound_stands_in_where_eigenvalues_are_too_many() {
    bound_law(1.0).unwrap();
    assert!(bound_law(1.2).is_err());
    // What oscillates is seen to do so, and A-stable methods need no eigenvalues.
    let (system, state) = built(&cloth(4, 5, 1.0));
    let with = |effort| Linearised::new(&system, &state, effort);
    let (known, blind) = (with(Effort::FULL), with(BLIND));
    let (w, estimate) = (known.omega_max().unwrap(), blind.omega_max().unwrap());
    assert!((estimate / w - 1.0).abs() < 0.05, "{estimate} {w}");
    let implicit = blind.predict(method("implicit_midpoint"), 0.01).limit;
    assert_eq!(implicit, Limit::Unconditional);
    // Midpoint is bound by modes nobody knows: no number is better than a wrong one.
    let midpoint = blind.predict(method("midpoint"), 0.01).limit;
    assert!(matches!(midpoint, Limit::Unknown(_)), "{midpoint:?}");
}

#[test]
fn thousands_of_coordinates_coupled_by_damping_have_answers() {
    let (system, state) = built(&cloth(30, 31, 1.0));
    let linearised = Linearised::new(&system, &state, Effort::BRIEF);
    let w = linearised.omega_max().expect("it oscillates");
    for id in ["symplectic_euler", "velocity_verlet", "rk4"] {
        let limit = linearised.predict(method(id), 1e-3).limit;
        let Limit::At(limit) = limit else {
            panic!("{id}: {limit:?}");
        };
        // Undamped 2, 2 and 2.83; damping moves them by less than half here.
        assert!((1.0..4.5).contains(&(limit * w)), "{id}: {limit} x {w}");
    }
    for id in ["implicit_euler", "implicit_midpoint", "tr_bdf2"] {
        let limit = linearised.predict(method(id), 1e-3).limit;
        assert_eq!(limit, Limit::Unconditional, "{id}");
    }
}

#[test]
fn the_same_bits_come_out_again() {
    let (system, state) = built(&cloth(4, 6, 1.0));
    let once = || {
        let effort = Effort {
            unsymmetric: 10,
            ..Effort::FULL
        };
        let linearised = Linearised::new(&system, &state, effort);
        fixed()
            .iter()
            .map(|m| format!("{:?}", linearised.predict(m, 0.01)))
            .collect::<Vec<_>>()
    };
    let first = once();
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(3)
        .build()
        .unwrap();
    assert_eq!(first, pool.install(once));
}
