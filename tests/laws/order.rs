//! The observed order of every method against its row, on scenes with exact and with converged truths.

use crate::testkit::gauss::Gauss;
use crate::testkit::line::{Line, released};
use crate::testkit::mutants::{self, Step, mutant};
use crate::testkit::scenes::shipped;
use crate::testkit::{built, method, own};
use springcheck::integrators::{DampingTreatment, Integrator, Splitting, Stage, StepError, fixed};
use springcheck::measure::CheckStatus;
use springcheck::measure::order::{MeasuredOrder, RATIOS, Reason, Study, Verdict, check, observed};
use springcheck::physics::{ParticleSystem, State, System};
use springcheck::scene::Scene;
use springcheck::truth::{Motion, States};
use std::f64::consts::TAU;
use std::sync::atomic::{AtomicU64, Ordering};

/// The scenes that say in their description that they are made for this.
const DESIGNATED: [&str; 3] = [
    "order/undamped.yml",
    "order/axial.yml",
    "order/isotropic.yml",
];

/// What `measure` finds on a shipped scene, whose truth is Gauss-Legendre's.
fn on<T>(path: &str, measure: impl FnOnce(&Study, &Scene) -> T) -> T {
    let scene = shipped(path);
    let (system, start) = built(&scene);
    let truth = Gauss::new(&system, start, scene.duration, 1e-3);
    let bar = truth.error_bar(scene.duration);
    // Nothing but rounding: measured 2.1e-15 to 4.4e-15 m.
    assert!(bar < 1.5e-14, "{path}: {bar:e}");
    let study = Study::of_scene(&scene, &system, &truth, scene.duration);
    measure(&study, &scene)
}

#[test]
fn every_method_is_of_its_order_on_designated_scenes() {
    for path in DESIGNATED {
        on(path, |study, scene| {
            let description = scene.description.as_deref().unwrap_or_default();
            assert!(description.starts_with("Designated for measuring orders"));
            for row in fixed().iter() {
                let MeasuredOrder { observed, .. } = study.method(row);
                assert_eq!(
                    observed.verdict,
                    Verdict::Meets,
                    "{path}, {}: {observed:?}",
                    row.id
                );
                assert_eq!(observed.used.len(), 5);
            }
        });
    }
}

#[test]
fn no_method_falls_below_its_order_on_an_oscillator() {
    for path in [
        "oscillator/oscillator.yml",
        "oscillator/step_050.yml",
        "oscillator/step_150.yml",
        "oscillator/damped_under.yml",
        "oscillator/damped_critical.yml",
        "oscillator/damped_over.yml",
    ] {
        let scene = shipped(path);
        let (system, _) = built(&scene);
        let truth = released(&scene);
        let study = Study::of_scene(&scene, &system, &truth, f64::INFINITY);
        for row in fixed().iter() {
            let measured = study.method(row);
            let seen = &measured.observed;
            assert!(
                matches!(seen.verdict, Verdict::Meets | Verdict::Above),
                "{path}, {}: {measured:?}",
                row.id
            );
            assert_eq!(check(row.id, &measured).status, CheckStatus::Pass);
        }
    }
}

/// The two bodies of `order/kepler.yml`, by Kepler's equation E - e sin E = t.
struct Kepler;

impl Motion for Kepler {
    fn states(&self, times: &[f64]) -> States {
        let mut states = States::with_room(6, times.len());
        for &t in times {
            let (e, mean) = (0.6_f64, t % TAU);
            // Newton's iteration, from where it cannot overshoot (Danby 1987).
            let mut anomaly = mean + 0.85 * e * mean.sin().signum();
            for _ in 0..20 {
                let (s, c) = anomaly.sin_cos();
                anomaly -= (anomaly - e * s - mean) / (1.0 - e * c);
            }
            let ((s, c), root) = (anomaly.sin_cos(), (1.0 - e * e).sqrt());
            let rate = 1.0 / (1.0 - e * c);
            let x = [c - e, root * s, 0.0];
            let v = [-s * rate, root * c * rate, 0.0];
            let both = |of: [f64; 3]| -> Vec<f64> {
                [-0.25, 0.75]
                    .iter()
                    .flat_map(|part| of.map(|c| part * c))
                    .collect()
            };
            states.push(&both(x), &both(v));
        }
        states
    }

    /// A time is rounded, and turned by twice the largest speed.
    fn error_bar(&self, t: f64) -> f64 {
        16.0 * f64::EPSILON * (1.0 + 2.0 * t)
    }
}

/// Thirty rounds of an ellipse at a hundredth: errors at the end are as large as the ellipse, or rounding has grown
/// over them. Over a horizon that is short enough every method shows its order.
#[test]
fn on_a_long_fast_motion_the_horizon_is_shorter() {
    let scene = shipped("order/kepler.yml");
    let (system, _) = built(&scene);
    let study = Study::of_scene(&scene, &system, &Kepler, scene.duration);
    let mut shorter = 0;
    for row in fixed().iter() {
        let measured = study.method(row);
        let order = measured.observed.order.unwrap_or(f64::NAN);
        // A verdict allows for TOLERANCE; twice that, since a leading term may nearly cancel here.
        assert!(
            (order - f64::from(row.order)).abs() <= 0.1,
            "{}: {measured:?}",
            row.id
        );
        let said = check(row.id, &measured);
        assert_eq!(said.status, CheckStatus::Pass, "{}", said.message);
        assert_eq!(measured.shortened, measured.until < scene.duration);
        assert_eq!(said.message.contains("over the first"), measured.shortened);
        shorter += usize::from(measured.shortened);
    }
    // Yoshida's method and PEFRL show theirs over the whole time.
    assert!((12..fixed().len()).contains(&shorter), "{shorter}");
    // Mutants are seen there, too.
    for (stated, step) in [
        (2, mutants::verlet_with_a_stale_force as Step),
        (4, mutants::rk4_with_swapped_weights),
    ] {
        let seen = study.measure(stated, &mutant(step)).observed;
        assert_eq!(seen.verdict, Verdict::Misses, "{seen:?}");
    }
}

#[test]
fn free_fall_is_exact_from_order_two_up() {
    let scene = shipped("pa1/scene00.yml");
    let (system, start) = built(&scene);
    let (z, g) = (start.x[2], scene.solver.gravity);
    let truth = Line {
        dim: 3,
        at: 2,
        rest: start.x,
        x: Box::new(move |t| (z + 0.5 * g * t * t, g * t)),
        bar: 16.0 * f64::EPSILON * 123.0,
    };
    let study = Study::of_scene(&scene, &system, &truth, scene.duration);
    for row in fixed().iter() {
        let measured = study.method(row);
        let said = check(row.id, &measured);
        if row.order == 1 {
            assert_eq!(measured.observed.verdict, Verdict::Meets, "{measured:?}");
            assert_eq!(said.status, CheckStatus::Pass);
        } else {
            let exact = Verdict::Inconclusive(Reason::Exact);
            assert_eq!(measured.observed.verdict, exact, "{measured:?}");
            assert_eq!(said.status, CheckStatus::Inconclusive);
            assert!(said.message.contains("exact"), "{}", said.message);
        }
    }
    // The mutant: gravity off by 1e-9 is not exact, and of no order.
    let heavier = || -> Box<dyn Integrator> {
        let mut scene = scene.clone();
        scene.solver.gravity *= 1.0 + 1e-9;
        Box::new(Elsewhere(own(method("rk4"))(), built(&scene).0))
    };
    let seen = study.measure(4, &heavier).observed;
    assert_eq!(seen.verdict, Verdict::Misses, "{seen:?}");
    // Were the truth wrong instead, the control would be, too: no method is to blame.
    let wrong = Line {
        x: Box::new(move |t| (z + 0.5 * g * (1.0 + 1e-9) * t * t, g * t)),
        ..truth
    };
    let study = Study::of_scene(&scene, &system, &wrong, scene.duration);
    assert_eq!(
        study.method(method("rk4")).observed.verdict,
        Verdict::Inconclusive(Reason::NotSmooth)
    );
}

/// Integrates a system of its own instead of the one it is given.
struct Elsewhere(Box<dyn Integrator>, ParticleSystem);

impl Integrator for Elsewhere {
    fn step(&mut self, _: &dyn System, h: f64, state: &mut State) -> Result<(), StepError> {
        self.0.step(&self.1, h, state)
    }
}

#[test]
fn wrong_integrators_miss_the_order_they_state() {
    let cases: [(&str, u32, Step, f64); 6] = [
        (
            DESIGNATED[0],
            2,
            mutants::midpoint_drifting_with_the_end_velocity,
            1.0,
        ),
        (
            DESIGNATED[0],
            4,
            mutants::yoshida_with_swapped_coefficients,
            3.0,
        ),
        (DESIGNATED[0], 4, mutants::rk4_with_a_wrong_weight, 0.0),
        (DESIGNATED[0], 4, mutants::rk4_with_swapped_weights, 2.0),
        (DESIGNATED[0], 2, mutants::verlet_with_a_stale_force, 1.0),
        (DESIGNATED[1], 2, mutants::verlet_with_explicit_damping, 1.0),
    ];
    for (path, stated, step, true_order) in cases {
        on(path, |study, _| {
            let measured = study.measure(stated, &mutant(step));
            let seen = &measured.observed;
            assert_eq!(seen.verdict, Verdict::Misses, "{measured:?}");
            let off = seen.order.map(|order| (order - true_order).abs());
            assert!(off.is_some_and(|off| off < 0.1), "{measured:?}");
            let said = check("mine", &measured);
            assert_eq!(said.status, CheckStatus::Fail);
            assert_eq!(
                (said.measured, said.bound),
                (seen.order, Some(f64::from(stated) - 0.05))
            );
        });
    }
}

/// A composition of drifts and kicks by these coefficients in turn, drift first.
fn composed(coefficients: &[f64]) -> impl Fn() -> Box<dyn Integrator> + Sync + use<> {
    let stages = coefficients.iter().enumerate().map(|(i, &c)| match i % 2 {
        0 => Stage::Drift(c),
        _ => Stage::Kick(c),
    });
    let stages: &'static [Stage] = stages.collect::<Vec<_>>().leak();
    move || Box::new(Splitting::new(stages, DampingTreatment::ExactFlow))
}

/// Ruth 1983 (IEEE Trans. Nucl. Sci. 30), order 3, as a list of kicks and drifts. With two drifts
/// swapped it keeps energy bounded all the same, and is of first order.
#[test]
fn swapped_coefficients_show_in_the_order() {
    on(DESIGNATED[0], |study, _| {
        // The first drift has no length, so that the list begins with a kick.
        let right = [
            0.0,
            7.0 / 24.0,
            2.0 / 3.0,
            0.75,
            -2.0 / 3.0,
            -1.0 / 24.0,
            1.0,
        ];
        let mut swapped = right;
        swapped.swap(2, 4);
        for (coefficients, verdict, order) in [
            (right, Verdict::Meets, 3.0),
            (swapped, Verdict::Misses, 1.0),
        ] {
            let seen = study.measure(3, &composed(&coefficients)).observed;
            assert_eq!(seen.verdict, verdict, "{seen:?}");
            // Measured 2.9996 and 1.0001.
            assert!(
                (seen.order.unwrap_or(f64::NAN) - order).abs() < 1e-3,
                "{seen:?}"
            );
        }
    });
}

/// Yoshida's triple jump on `yoshida4`: order 6.
fn sixth_order(inner: f64) -> impl Fn() -> Box<dyn Integrator> + Sync + use<> {
    let jump = |order: f64| 1.0 / (2.0 - 2_f64.powf(1.0 / (order + 1.0)));
    let triple = |w: f64, parts: &[f64]| -> Vec<f64> {
        [w, 1.0 - 2.0 * w, w]
            .iter()
            .flat_map(|w| parts.iter().map(move |part| w * part))
            .collect()
    };
    let parts = triple(jump(4.0), &triple(inner, &[1.0]));
    let halves = parts.iter().flat_map(|w| [0.5 * w, *w, 0.5 * w, 0.0]);
    composed(&halves.collect::<Vec<_>>())
}

#[test]
fn above_order_four_steps_lie_closer() {
    let right = 1.0 / (2.0 - 2_f64.powf(1.0 / 3.0));
    for path in [DESIGNATED[0], DESIGNATED[1]] {
        on(path, |study, _| {
            let measured = study.measure(6, &sixth_order(right));
            assert_eq!(measured.observed.verdict, Verdict::Meets, "{measured:?}");
            let used = &measured.observed.used;
            assert!(
                used.windows(2)
                    .all(|p| (p[0].h / p[1].h - 1.3).abs() < 0.16),
                "{used:?}"
            );
            // As eighth, and with the inner jump a thousandth off: second order in the end.
            let eighth = study.measure(8, &sixth_order(right)).observed.verdict;
            assert_eq!(eighth, Verdict::Misses);
            let wrong = study
                .measure(6, &sixth_order(1.001 * right))
                .observed
                .verdict;
            assert_eq!(wrong, Verdict::Misses);
        });
    }
}

/// Steps far beyond the motion's own: implicit Euler is at rest at once, and its error the same at each.
#[test]
fn steps_too_coarse_are_no_miss() {
    let mut scene = shipped("oscillator/oscillator.yml");
    scene.springs[0].stiffness = 5e7;
    let (system, _) = built(&scene);
    let truth = released(&scene);
    let study = Study::of_scene(&scene, &system, &truth, scene.duration).budget(200_000);
    let MeasuredOrder {
        observed: seen,
        points,
        ..
    } = study.method(method("implicit_euler"));
    assert_eq!(seen.verdict, Verdict::Inconclusive(Reason::NotAsymptotic));
    // What the errors alone would say.
    assert_eq!(observed(&points, 1).verdict, Verdict::Misses);
}

/// Methods that damp the motion away err by its amplitude at each step, and seem to be of order 0.
#[test]
fn a_motion_damped_away_is_no_miss() {
    for (path, duration) in [
        ("oscillator/oscillator.yml", 12.0),
        ("oscillator/oscillator.yml", 20.0),
        ("oscillator/oscillator.yml", 40.0),
        ("oscillator/circle.yml", 40.0),
    ] {
        let mut scene = shipped(path);
        scene.duration = duration;
        let (system, start) = built(&scene);
        let truth = Gauss::new(&system, start, duration, 4e-3);
        let study = Study::of_scene(&scene, &system, &truth, duration);
        for row in fixed().iter() {
            let measured = study.method(row);
            let seen = &measured.observed;
            // By the errors alone, as they come in.
            let missed = (RATIOS + 1..=measured.points.len())
                .filter_map(|n| measured.points.get(..n))
                .any(|points| observed(points, row.order).verdict == Verdict::Misses);
            assert_ne!(seen.verdict, Verdict::Misses, "{path}, {}", row.id);
            // Off by 0.487 to 0.500 of the way the motion goes there.
            if [
                "implicit_euler",
                "linearized_implicit_predicted",
                "linearized_implicit_at_start",
            ]
            .contains(&row.id)
            {
                // Over a shorter time they follow it.
                let shorter = measured.shortened && seen.verdict == Verdict::Meets;
                assert!(missed || shorter, "{path}, {}: {measured:?}", row.id);
            }
        }
        // A mutant is told from them where its error is small: of first order, not second.
        let seen = study
            .measure(2, &mutant(mutants::verlet_with_a_stale_force))
            .observed;
        // At 40 s the budget ends before the control has run.
        if duration <= 20.0 {
            assert_eq!(
                seen.verdict,
                Verdict::Misses,
                "{path}, {duration}: {seen:?}"
            );
        }
    }
}

/// A particle below the origin on a spring of stiffness 10 and rest length 1, let go at this length.
/// It stays below, where z = -l and l'' = g - k (l - 1) - c l' is linear.
fn dropped(length: f64) -> (Scene, Line) {
    let mut scene = shipped("oscillator/oscillator.yml");
    let (k, c, g) = (10.0, 0.1, 9.81);
    (scene.duration, scene.solver.timestep) = (5.0, 1e-3);
    scene.solver.gravity = -g;
    scene.particles[1].position = [0.0, 0.0, -length];
    let spring = &mut scene.springs[0];
    (spring.stiffness, spring.damping, spring.rest_length) = (k, c, 1.0);
    let (rest, decay) = (1.0 + g / k, 0.5 * c);
    let u = (k - decay * decay).sqrt();
    let truth = Line {
        dim: 6,
        at: 5,
        rest: vec![0.0; 6],
        x: Box::new(move |t| {
            let envelope = (length - rest) * (-decay * t).exp();
            let (s, c) = (u * t).sin_cos();
            let l = rest + envelope * (c + decay / u * s);
            (-l, envelope * k / u * s)
        }),
        bar: 16.0 * f64::EPSILON * 4.0 * u,
    };
    (scene, truth)
}

/// Ends in one place have no direction between them: the force jumps as they part, and most methods
/// are of order 1 there, the control too.
#[test]
fn forces_that_jump_are_no_miss() {
    let (scene, truth) = dropped(0.0);
    let (system, _) = built(&scene);
    let study = Study::of_scene(&scene, &system, &truth, f64::INFINITY);
    for row in fixed().iter() {
        let measured = study.method(row);
        let verdict = measured.observed.verdict;
        let alone = observed(&measured.points, row.order).verdict;
        assert_ne!(verdict, Verdict::Misses, "{}: {measured:?}", row.id);
        if ["midpoint", "velocity_verlet", "rk4"].contains(&row.id) {
            let expected = Verdict::Inconclusive(Reason::NotSmooth);
            assert_eq!((verdict, alone), (expected, Verdict::Misses), "{}", row.id);
            let said = check(row.id, &measured);
            assert_eq!(said.status, CheckStatus::Inconclusive);
            assert!(said.message.contains("not smooth"), "{}", said.message);
        }
    }
    // Let go from elsewhere on the same spring nothing jumps, and a miss is one.
    let (scene, truth) = dropped(0.5);
    let (system, _) = built(&scene);
    let study = Study::of_scene(&scene, &system, &truth, f64::INFINITY);
    for row in fixed().iter() {
        let seen = study.method(row).observed;
        assert_eq!(seen.verdict, Verdict::Meets, "{}: {seen:?}", row.id);
    }
    for (stated, step) in [
        (2, mutants::verlet_with_a_stale_force as Step),
        (2, mutants::midpoint_drifting_with_the_end_velocity),
        (4, mutants::rk4_with_swapped_weights),
    ] {
        let seen = study.measure(stated, &mutant(step)).observed;
        assert_eq!(seen.verdict, Verdict::Misses, "{seen:?}");
    }
}

/// Counts the steps of all its kind.
struct Counted(Box<dyn Integrator>, &'static AtomicU64);

impl Integrator for Counted {
    fn step(&mut self, system: &dyn System, h: f64, state: &mut State) -> Result<(), StepError> {
        self.1.fetch_add(1, Ordering::Relaxed);
        self.0.step(system, h, state)
    }
}

#[test]
fn a_ladder_keeps_to_its_budget() {
    static STEPS: AtomicU64 = AtomicU64::new(0);
    let scene = shipped("oscillator/damped_over.yml");
    let (system, _) = built(&scene);
    let truth = released(&scene);
    let build =
        || -> Box<dyn Integrator> { Box::new(Counted(own(method("explicit_euler"))(), &STEPS)) };
    for (budget, enough) in [(0, false), (1_000, false), (30_000, true), (100_000, true)] {
        STEPS.store(0, Ordering::Relaxed);
        let study = Study::of_scene(&scene, &system, &truth, scene.duration).budget(budget);
        let seen = study.measure(1, &build).observed;
        assert_eq!(seen.order.is_some(), enough, "{budget}: {seen:?}");
        // Six coordinates. The last horizon's coarse level, 31 steps, is run twice however little is left.
        let spent = 6 * STEPS.load(Ordering::Relaxed);
        assert!(spent <= budget + 6 * 31, "{budget}: {spent}");
    }
}

/// The same bits whoever computes them.
#[test]
fn threads_change_nothing() {
    on(DESIGNATED[1], |study, _| {
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let all = || {
                fixed()
                    .iter()
                    .map(|row| study.method(row))
                    .collect::<Vec<_>>()
            };
            pool.expect("threads").install(all)
        };
        assert_eq!(with(1), with(4));
    });
}

#[test]
fn without_a_horizon_there_is_no_order() {
    let scene = shipped("oscillator/oscillator.yml");
    let (system, _) = built(&scene);
    let truth = released(&scene);
    for until in [0.0, -1.0, f64::NAN] {
        let study = Study::of_scene(&scene, &system, &truth, until);
        let measured = study.method(method("rk4"));
        assert_eq!(
            measured.observed.verdict,
            Verdict::Inconclusive(Reason::TooFew),
            "{until}"
        );
        let said = check("rk4", &measured);
        assert_eq!(
            (said.status, said.measured),
            (CheckStatus::Inconclusive, None)
        );
    }
}
