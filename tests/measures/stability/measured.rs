//! Measured limits against the kit's one-step matrices, on scenes whose forces are linear, and what
//! the measurement does where there is no theory.

use crate::testkit::scenes::{self, parsed};
use crate::testkit::{crossed, method};
use rayon::prelude::*;
use springcheck::conformance::measured_limit;
use springcheck::conformance::systems::Oscillator;
use springcheck::integrators::{EnergyLaw, Method, Settings, Stable, fixed};
use springcheck::measure::stability::Cell;
use springcheck::measure::stability::{Limit, MakeRun, MeasuredLimit, classify, measure};
use springcheck::physics::{ParticleSystem, State};
use springcheck::scene::Scene;
use springcheck::solvers::{Run, Setting, Solver, Unsupported};
use std::sync::atomic::{AtomicU64, Ordering};

/// What the limits are promised to; bisection ends at half of it.
const PROMISED: f64 = 1e-3;
/// The kit's oscillator's frequency, rad/s.
const W: f64 = 7.0;
/// How far limits of theory are looked for.
const UPTO: f64 = 12.0;
const ZETAS: [f64; 5] = [0.0, 0.1, 0.5, 1.0, 2.0];
const PATIENT: u64 = 100_000_000;

/// One particle on a spring of rest length 0, off the axes and under gravity.
fn oscillator(zeta: f64) -> Scene {
    let mut scene = scenes::oscillator(W * W, 0.5);
    (scene.solver.timestep, scene.solver.gravity) = (0.01, -9.81);
    scene.particles[1].position = [0.5, 0.1, 0.2];
    scene.springs[0].damping = 2.0 * zeta * W;
    scene
}

/// Wall, 1 kg, 2 kg, wall; springs of 40, 30 and 20 N/m.
fn network() -> Scene {
    parsed(
        "solver: {type: explicit_euler, timestep: 0.01}
particles:
- {pos: [0, 0, 0], fixed: true}
- {pos: [1, 0, 0], mass: 1}
- {pos: [2, 0.5, 0], mass: 2}
- {pos: [3, 0, 0], fixed: true}
springs:
- {particle_ids: [0, 1], stiffness: 40, rest_length: 0}
- {particle_ids: [1, 2], stiffness: 30, rest_length: 0}
- {particle_ids: [2, 3], stiffness: 20, rest_length: 0}
",
    )
}

/// Its largest frequency: w² is an eigenvalue of [[70, -30], [-15, 25]].
fn network_w() -> f64 {
    let (trace, det) = (95.0, 70.0 * 25.0 - 30.0 * 15.0);
    f64::sqrt(0.5 * (trace + f64::sqrt(trace * trace - 4.0 * det)))
}

/// Drag alone: v' = -4 v and v' = -0.5 v, the textbook's test equation.
fn drag() -> Scene {
    parsed(
        "solver: {type: explicit_euler, timestep: 0.01}
particles:
- {pos: [0, 0, 0], vel: [1, 0, 0], mass: 1, drag: 4}
- {pos: [0, 1, 0], vel: [1, 0, 0], mass: 2, drag: 1}
",
    )
}

pub(super) fn engine(
    method: &'static Method,
) -> impl Fn(&Scene, f64) -> Result<Run, Unsupported> + Sync {
    move |scene, h| {
        let system = ParticleSystem::new(scene);
        Solver::method(method).start(scene, &system, &Setting::step(h))
    }
}

pub(super) fn found(make: &MakeRun, scene: &Scene, near: Option<f64>) -> MeasuredLimit {
    let h = scene.solver.timestep;
    let system = ParticleSystem::new(scene);
    measure(scene, &system, make, h, near, PATIENT, &|_| ())
}

/// Limits of theory and of measurement, h w, agree.
fn limit_law(found: &Limit, w: f64, theory: Option<f64>) -> Result<(), String> {
    let holds = match (found, theory) {
        (Limit::At(h), Some(z)) => (h * w / z - 1.0).abs() < PROMISED,
        // Below the kit's own rounding: never.
        (Limit::Never, Some(z)) => z < 0.01,
        (Limit::Unconditional, None) => true,
        _ => false,
    };
    if holds {
        Ok(())
    } else {
        Err(format!("measured {found:?} x {w}, theory {theory:?}"))
    }
}

fn theory(method: &'static Method, zeta: f64) -> Option<f64> {
    let build = || method.build(&Settings::default());
    measured_limit(&build, zeta, UPTO).unwrap()
}

/// Methods whose map is linear where the forces are: all but those that leave out the stiffness across
/// springs, whose direction turns. No scene has motion along a spring alone, since every free particle
/// moves in all three directions: on theirs it is tested that they are not called linear, and on drag
/// alone, where nothing turns, that they are.
fn linear_methods() -> Vec<&'static Method> {
    let turns = |m: &&Method| !matches!(m.oscillator.stable, Stable::AlwaysAlong { .. });
    fixed().iter().filter(turns).collect()
}

#[test]
fn limits_of_every_method_are_those_of_theory() {
    let methods = linear_methods();
    let cases = crossed(&methods, &ZETAS);
    cases.par_iter().for_each(|&(&method, &zeta)| {
        let theory = theory(method, zeta);
        // As the prediction hands it in, without which a gap in the stable region (PEFRL's from
        // 2.989 to 3.505) may be stepped over.
        let near = theory.filter(|z| *z > 0.01).map(|z| z / W);
        let found = found(&engine(method), &oscillator(zeta), near);
        limit_law(&found.limit, W, theory)
            .unwrap_or_else(|e| panic!("{}, ζ = {zeta}: {e}; {:?}", method.id, found.reason));
    });
}

#[test]
fn a_map_is_linear_unless_it_leaves_out_what_turns() {
    let linear = |method, scene: &Scene| found(&engine(method), scene, None).linear;
    for method in fixed().iter() {
        let whole = linear_methods().iter().any(|m| m.id == method.id);
        assert_eq!(linear(method, &oscillator(0.1)), whole, "{}", method.id);
        assert!(linear(method, &drag()), "{}", method.id);
    }
}

#[test]
fn patience_that_ends_leaves_a_bracket() {
    let scene = oscillator(0.0);
    let make = engine(method("velocity_verlet"));
    let system = ParticleSystem::new(&scene);
    let limit = 2.0 / W;
    let after = |patience| measure(&scene, &system, &make, 0.01, None, patience, &|_| ()).limit;
    // What is called stable is, what is called unstable is not, and more patience narrows it.
    let mut width = f64::INFINITY;
    let mut brackets = 0;
    for patience in [2_000, 3_000, 4_000, 6_000, 8_000] {
        if let Limit::Between(low, high) = after(patience) {
            assert!(low <= limit && limit <= high, "{low} {limit} {high}");
            assert!(high - low <= width, "{low} {high} {width}");
            width = high - low;
            brackets += 1;
        }
    }
    assert!(brackets > 0);
    assert!(matches!(after(400_000), Limit::At(_)));
}

#[test]
fn a_guess_only_shortens_the_search() {
    for (id, zeta) in [
        ("rk4", 0.5),
        ("explicit_euler", 0.1),
        ("velocity_verlet", 0.0),
    ] {
        let method = method(id);
        let theory = theory(method, zeta);
        for factor in [0.03, 0.4, 0.999, 1.3, 20.0] {
            let near = theory.map(|z| factor * z / W);
            let found = found(&engine(method), &oscillator(zeta), near);
            limit_law(&found.limit, W, theory).unwrap_or_else(|e| panic!("{id} x {factor}: {e}"));
        }
    }
}

#[test]
fn the_law_of_limits_kills_mutants() {
    // A search that ends at a width of 1e-2 is off by half of that in the mean.
    let (z, coarse) = (2.0, 1.0 - 5e-3);
    assert!(limit_law(&Limit::At(coarse * z / W), W, Some(z)).is_err());

    // A bound of 1e4 on the energy over 20,000 steps instead of growth: explicit Euler at ζ = 0.1 is
    // called stable up to 1.2 % beyond its limit: 1e4 = (1 + 0.04 δ)^20,000.
    let zeta = 0.1;
    let scene = oscillator(zeta);
    let bounded = |h: f64| {
        let mut engine = engine(method("explicit_euler"))(&scene, h).unwrap();
        // About the equilibrium, 9.81 / 49 m down.
        let energy = |s: &State| {
            let x = [s.x[3], s.x[4], s.x[5] + 9.81 / 49.0];
            let square = |v: &[f64]| v.iter().map(|c| c * c).sum::<f64>();
            square(&s.v[3..]) + 49.0 * square(&x)
        };
        let start = energy(engine.state());
        (0..20_000).all(|_| engine.advance(1).is_ok() && energy(engine.state()) < 1e4 * start)
    };
    let (mut low, mut high) = (0.1 / W, 0.4 / W);
    while high - low > 1e-4 * low {
        let middle = 0.5 * (low + high);
        if bounded(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    assert!(limit_law(&Limit::At(low), W, Some(0.2)).is_err());
    assert!((low * W / 0.2 - 1.012).abs() < 2e-3, "{}", low * W);
}

/// Growth of the undamped oscillator's amplitude, 1/s, as the row says.
fn growth_in_theory(method: &Method, w: f64, h: f64) -> Option<f64> {
    match method.oscillator.energy {
        EnergyLaw::Factor { factor, .. } => Some(0.5 * factor(h * w).ln() / h),
        _ => None,
    }
}

#[test]
fn a_network_has_the_limits_of_its_stiffest_mode() {
    linear_methods().par_iter().for_each(|method| {
        let w = network_w();
        let theory = theory(method, 0.0);
        let near = theory.filter(|z| *z > 0.01).map(|z| z / w);
        let scene = network();
        let found = found(&engine(method), &scene, near);
        limit_law(&found.limit, w, theory).unwrap_or_else(|e| panic!("{}: {e}", method.id));
        if found.limit == Limit::Never {
            let measured = found.growth_per_s.unwrap();
            let expected = growth_in_theory(method, w, scene.solver.timestep).unwrap();
            assert!((measured / expected - 1.0).abs() < 1e-6, "{}", method.id);
        } else {
            assert_eq!(found.growth_per_s, None, "{}", method.id);
        }
    });
}

/// Up to which h every eigenvalue of the one-step matrix of an overdamped oscillator is real, not
/// negative and at most 1.
fn smooth_in_theory(method: &Method, zeta: f64) -> Option<f64> {
    let system = Oscillator { w: 1.0, zeta };
    let column = |h: f64, x: f64, v: f64| {
        let mut state = State::new(vec![x], vec![v]);
        let mut integrator = method.build(&Settings::default());
        integrator.step(&system, h, &mut state).unwrap();
        [state.x[0], state.v[0]]
    };
    let smooth = |h: f64| {
        let ([a, c], [b, d]) = (column(h, 1.0, 0.0), column(h, 0.0, 1.0));
        let (half, det) = (0.5 * (a + d), a * d - b * c);
        let disc = half * half - det;
        let root = disc.max(0.0).sqrt();
        disc >= -1e-9 && half - root >= -1e-12 && half + root <= 1.0 + 1e-12
    };
    let first = (1..4_000)
        .map(|i| 12.0 * f64::from(i) / 4_000.0)
        .find(|h| !smooth(*h))?;
    let (mut low, mut high) = (first - 12.0 / 4_000.0, first);
    while high - low > 1e-9 {
        let middle = 0.5 * (low + high);
        if smooth(middle) {
            low = middle
        } else {
            high = middle
        }
    }
    Some(low)
}

#[test]
fn smooth_up_to_where_an_eigenvalue_turns_negative() {
    for (&method, &zeta) in crossed(&linear_methods(), &[1.5, 2.0]) {
        let expected = smooth_in_theory(method, zeta);
        let theory = theory(method, zeta);
        let found = found(&engine(method), &oscillator(zeta), theory.map(|z| z / W));
        let measured = found.smooth_below_s.map(|h| W * h);
        match (measured, expected) {
            (Some(m), Some(e)) => {
                assert!((m / e - 1.0).abs() < PROMISED, "{} {m} {e}", method.id)
            }
            (m, e) => assert_eq!(m, e, "{} {zeta}", method.id),
        }
    }
    // Nothing is smooth that oscillates.
    let found = found(&engine(method("explicit_euler")), &oscillator(0.5), None);
    assert_eq!(found.smooth_below_s, None);
}

#[test]
fn the_test_equation_is_smooth_then_oscillates_then_explodes() {
    let scene = drag();
    let make = engine(method("explicit_euler"));
    let found = found(&make, &scene, None);
    let Limit::At(limit) = found.limit else {
        panic!("{found:?}")
    };
    let smooth = found.smooth_below_s.unwrap();
    assert!((limit / 0.5 - 1.0).abs() < PROMISED, "{limit}");
    assert!((smooth / 0.25 - 1.0).abs() < PROMISED, "{smooth}");
    let signs = |h: f64| {
        let mut engine = make(&scene, h).unwrap();
        let mut v = vec![1.0_f64];
        for _ in 0..20 {
            engine.advance(1).unwrap();
            v.push(engine.state().v[0]);
        }
        let turns = v.windows(2).filter(|w| w[0] * w[1] < 0.0).count();
        (turns, v[20].abs() > 1.0)
    };
    assert_eq!(signs(0.98 * smooth), (0, false));
    assert_eq!(signs(1.02 * smooth), (20, false));
    assert_eq!(signs(1.02 * limit), (20, true));
}

/// Stable as symplectic Euler, but for a window.
fn with_a_window(scene: &Scene, h: f64) -> Result<Run, Unsupported> {
    let id = if (0.1..0.15).contains(&h) {
        "explicit_euler"
    } else {
        "symplectic_euler"
    };
    engine(method(id))(scene, h)
}

#[test]
fn stability_need_not_be_monotone() {
    for near in [None, Some(2.0 / W), Some(0.12)] {
        let found = found(&with_a_window, &oscillator(0.0), near);
        let Limit::At(limit) = found.limit else {
            panic!("{found:?}")
        };
        assert!((limit / 0.1 - 1.0).abs() < PROMISED, "{near:?}: {limit}");
    }
}

/// A spring pulled tight, with a damper along it.
fn taut() -> Scene {
    parsed(
        "solver: {type: explicit_euler, timestep: 0.001, gravity: 0}
particles:
- {pos: [0, 0, 0], fixed: true}
- {pos: [1, 0, 0], mass: 1}
- {pos: [2, 0, 0], fixed: true}
springs:
- {particle_ids: [0, 1], stiffness: 50, rest_length: 0.5, damping: 1}
- {particle_ids: [1, 2], stiffness: 50, rest_length: 0.5, damping: 1}
",
    )
}

#[test]
fn a_motion_hidden_by_symmetry_is_shaken_out() {
    // Along: w² = 100, c = 2, so explicit Euler is stable up to c / k = 0.02. Across: w² = 2 T / l =
    // 50, undamped: never, but for what the dampers take from a motion wide enough to stretch them,
    // which bounds it where growth, 50 h² a step, is slow.
    let scene = taut();
    let make = engine(method("explicit_euler"));
    let found = found(&make, &scene, None);
    let Limit::At(limit) = found.limit else {
        panic!("{found:?}")
    };
    assert!(limit < 0.1 * 0.02, "{found:?}");
    // Not shaken it stays on its line, also where it is pushed along it.
    let mut pushed = scene.clone();
    pushed.particles[1].velocity = [1.0, 0.0, 0.0];
    let mut engine = make(&pushed, 0.018).unwrap();
    for _ in 0..20_000 {
        engine.advance(1).unwrap();
    }
    assert!(engine.state().v[3].abs() < 1e-6 && engine.state().v[4] == 0.0);
}

/// `links` masses of 0.1 kg hanging on springs of 0.1 m, at rest length.
fn chain(links: usize, stiffness: f64) -> Scene {
    let mut scene = scenes::chain(links, 0.1, 0.1, stiffness);
    (scene.solver.timestep, scene.solver.gravity) = (1.0 / 60.0, -9.81);
    scene
}

fn rapier(scene: &Scene, h: f64) -> Result<Run, Unsupported> {
    let rapier = springcheck::solvers::find("rapier").unwrap();
    rapier.start(scene, &ParticleSystem::new(scene), &Setting::step(h))
}

#[test]
fn rapier_gains_energy_on_a_stiff_chain() {
    let cell = |links, k, h| classify(&chain(links, k), &rapier, h, 1_000, &|_| ());
    assert_eq!(cell(20, 1e6, 1.0 / 60.0), Cell::Failed);
    assert_eq!(cell(20, 1e6, 1.0 / 6e3), Cell::Stable);
    assert_eq!(cell(20, 1e3, 1.0 / 60.0), Cell::Stable);

    let scene = chain(4, 1e4);
    let found = found(&rapier, &scene, None);
    let Limit::At(limit) = found.limit else {
        panic!("{found:?}")
    };
    // The sweeps after the drift do not converge: the joint's own scheme would be stable.
    assert!((1e-3..1.0 / 60.0).contains(&limit), "{found:?}");
    assert_eq!(cell(4, 1e4, 0.5 * limit), Cell::Stable);
    assert_eq!(cell(4, 1e4, 2.0 * limit), Cell::Failed);
}

#[test]
fn a_cell_is_what_its_run_does() {
    let cell = |id: &str, z: f64, zeta: f64| {
        let scene = oscillator(zeta);
        classify(&scene, &engine(method(id)), z / W, 2_000, &|_| ())
    };
    for (id, z, zeta, expected) in [
        ("symplectic_euler", 0.01, 0.0, Cell::Stable),
        // The energy swings by a factor of twenty, for ever.
        ("symplectic_euler", 1.9, 0.0, Cell::Stable),
        ("symplectic_euler", 2.01, 0.0, Cell::Failed),
        ("implicit_midpoint", 3.0, 0.0, Cell::Stable),
        // (1 + z²)^2000: e^1.8 and e^20.
        ("explicit_euler", 0.03, 0.0, Cell::Growing),
        ("explicit_euler", 0.1, 0.0, Cell::Growing),
        // Either side of z = 2 ζ; what dampers take is no numerical dissipation.
        ("explicit_euler", 0.9, 0.5, Cell::Stable),
        ("explicit_euler", 1.1, 0.5, Cell::Failed),
        ("implicit_midpoint", 1.0, 0.5, Cell::Stable),
        // z⁶/72 = 1e-5 a step, and 0.16.
        ("rk4", 0.3, 0.0, Cell::Stable),
        ("rk4", 1.5, 0.0, Cell::Dissipating),
        ("implicit_euler", 0.1, 0.0, Cell::Dissipating),
    ] {
        assert_eq!(cell(id, z, zeta), expected, "{id}, z = {z}, ζ = {zeta}");
    }
    let unsupported = |_: &Scene, _: f64| -> Result<Run, Unsupported> {
        Err(Unsupported {
            reason: "not here".into(),
        })
    };
    let scene = oscillator(0.0);
    assert_eq!(
        classify(&scene, &unsupported, 0.01, 10, &|_| ()),
        Cell::Failed
    );
    let found = found(&unsupported, &scene, None);
    assert_eq!(found.limit, Limit::Unknown("not here".into()));
}

#[test]
fn patience_and_progress_are_counted_in_steps() {
    let scene = oscillator(0.0);
    let make = engine(method("velocity_verlet"));
    let system = ParticleSystem::new(&scene);
    let ticked = AtomicU64::new(0);
    let tick = |steps| {
        ticked.fetch_add(steps, Ordering::Relaxed);
    };
    let short = measure(&scene, &system, &make, 0.01, None, 1_000, &tick);
    assert!(matches!(short.limit, Limit::Unknown(_)), "{short:?}");
    // The last few hundred steps are taken before they are counted, by two engines.
    assert!(short.steps <= 1_000 + 2 * 256, "{}", short.steps);
    assert_eq!(short.steps, ticked.into_inner());
    // The same bits again.
    assert_eq!(found(&make, &scene, None), found(&make, &scene, None));
}
