//! What is left out, drag alone, and springs that turn.

use super::*;

#[test]
fn an_axial_damper_leaves_motion_across_undamped() {
    // Stretched from 1 to 1.5: k = 50 along, k/3 across; c = 2 along, m = 1.
    let mut scene = scene(
        vec![
            particle([0.0; 3], 1.0, true),
            particle([0.0, 0.0, -1.5], 1.0, false),
        ],
        vec![spring(0, 1, 50.0, 2.0, 1.0)],
        DampingModel::Axial,
    );
    assert!(!is_linear(&scene));
    let axial = start(&scene).predict(method("explicit_euler"), 0.01);
    assert_eq!(axial.limit, Limit::Never);
    let across = (50.0_f64 / 3.0).sqrt();
    let growth = 0.5 * (0.01 * across).powi(2).ln_1p() / 0.01;
    assert!((axial.growth_per_s.unwrap() / growth - 1.0).abs() < 1e-12);
    assert!(
        axial
            .reason
            .unwrap()
            .starts_with("undamped mode of 4.08 rad/s")
    );
    // Resisting all motion it allows the least of 2 ζ/ω = c / k: across, c = 2, k/3: 0.12; along .04.
    scene.damping_model = DampingModel::Isotropic;
    let isotropic = start(&scene).predict(method("explicit_euler"), 0.01);
    let Limit::At(limit) = isotropic.limit else {
        panic!("{isotropic:?}");
    };
    assert!((limit / 0.04 - 1.0).abs() < 1e-14, "{limit}");
    assert!(isotropic.growth_per_s.unwrap() < 0.0);
    // What leaves out the turning has its limit across: 2/ω without damping there.
    scene.damping_model = DampingModel::Axial;
    let material = start(&scene).predict(method("linearized_implicit_material"), 0.01);
    let Limit::At(limit) = material.limit else {
        panic!("{material:?}");
    };
    assert!((limit * across / 2.0 - 1.0).abs() < 1e-14, "{limit}");
}

#[test]
fn what_rests_or_grows_in_truth_is_left_out_and_counted() {
    let counts = |scene: &Scene| -> Vec<usize> {
        let count = |what: &String| what.split(' ').next()?.parse().ok();
        start(scene).excluded().iter().filter_map(count).collect()
    };
    let corners = [
        [0.0, 0.0, 0.0],
        [1.0, 0.1, 0.0],
        [0.2, 1.1, 0.3],
        [0.3, 0.2, 0.9],
    ];
    let edges = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)];
    let free = |stretch: f64, damping: f64| {
        let particles = corners.map(|c| particle(c, 0.5, false)).to_vec();
        let length = |a: usize, b: usize| {
            let squares = (0..3).map(|i| (corners[a][i] - corners[b][i]).powi(2));
            squares.sum::<f64>().sqrt()
        };
        let springs = edges
            .map(|(a, b)| {
                spring(
                    a,
                    b,
                    30.0,
                    damping * (1.0 + a as f64),
                    length(a, b) / stretch,
                )
            })
            .to_vec();
        scene(particles, springs, DampingModel::Axial)
    };
    // A tetrahedron at rest: 3 translations and 3 rotations, dampers or not.
    assert_eq!(counts(&free(1.0, 0.0)), [6]);
    assert_eq!(counts(&free(1.0, 0.3)), [6]);
    // Under tension turning meets a force: what is left are the translations.
    assert_eq!(counts(&free(1.01, 0.0))[0], 3);
    // A compressed spring between fixed ends buckles both ways across; Verlet's limit stays that along.
    let buckling = scene(
        vec![
            particle([0.0; 3], 1.0, true),
            particle([1.0, 0.0, 0.0], 1.0, false),
            particle([2.0, 0.0, 0.0], 1.0, true),
        ],
        vec![spring(0, 1, 8.0, 0.0, 1.5), spring(1, 2, 8.0, 0.0, 1.5)],
        DampingModel::Axial,
    );
    let linearised = start(&buckling);
    assert_eq!(counts(&buckling), [2]);
    assert!(linearised.excluded()[0].contains("grow in truth"));
    let Limit::At(limit) = linearised.predict(method("velocity_verlet"), 0.01).limit else {
        panic!();
    };
    assert!((limit / 0.5 - 1.0).abs() < 1e-14, "{limit}");
    // Nothing at all: three modes at rest, and no step is too large.
    let lone = scene(
        vec![particle([0.0; 3], 1.0, false)],
        Vec::new(),
        DampingModel::Axial,
    );
    assert_eq!(counts(&lone), [3]);
    for method in fixed().iter() {
        let prediction = start(&lone).predict(method, 0.01);
        assert_eq!(prediction.limit, Limit::Unconditional, "{}", method.id);
        assert_eq!(prediction.growth_per_s, Some(0.0), "{}", method.id);
    }
}

/// Quadratic drag is linearised about the start, relative to the air: along the motion at the rate 2 c |u| / m, across at
/// half of that.
#[test]
fn drag_that_is_not_linear_has_the_limit_of_its_start() {
    let mut scene = scene(
        vec![particle([0.0; 3], 0.5, false)],
        Vec::new(),
        DampingModel::Axial,
    );
    scene.particles[0].velocity = [0.0, 3.0, -4.0];
    scene.particles[0].quadratic_drag = 0.2;
    let limit = |scene: &Scene| {
        assert!(!is_linear(scene));
        match start(scene).predict(method("explicit_euler"), 0.01).limit {
            Limit::At(limit) => limit,
            other => panic!("{other:?}"),
        }
    };
    // 2 / rate; a few roundings of it.
    let rate = |speed: f64| 2.0 * 0.2 * speed / 0.5;
    assert!((limit(&scene) * rate(5.0) / 2.0 - 1.0).abs() < 1e-14);
    scene.air = Some(Air {
        velocity: [12.0, 3.0, -4.0],
        ..Air::default()
    });
    assert!((limit(&scene) * rate(12.0) / 2.0 - 1.0).abs() < 1e-14);
}

/// A plate of equal masses in the wind: the drag of its triangle damps the mean of its corners along the normal at the
/// rate density C A |u·n| / (3 m), and nothing else. Air that blows at it also turns and stretches it in the
/// linearised equations, and nothing comes back from there.
#[test]
fn air_at_a_plate_damps_its_mean_motion() {
    let mut random = Random(7);
    for case in 0..24 {
        let mut vector = |size: f64| [(); 3].map(|()| size * random.next());
        let (wind, far) = (vector(30.0), vector(if case < 12 { 1.0 } else { 1e3 }));
        let mut corners = [(); 3].map(|()| vector(1.0));
        // Half of them lie in the plane of two axes and bear the wind at right angles.
        let wind = if case % 2 == 0 {
            corners.iter_mut().for_each(|corner| corner[2] = 0.0);
            [0.0, 0.0, wind[2]]
        } else {
            wind
        };
        let mass = 0.01;
        let particles = corners.map(|c| particle([0, 1, 2].map(|k| c[k] + far[k]), mass, false));
        let mut scene = scene(particles.to_vec(), Vec::new(), DampingModel::Axial);
        scene.triangles = vec![Triangle {
            corners: [0, 1, 2],
            air_drag: 1.3,
        }];
        scene.air = Some(Air {
            velocity: wind,
            density: 1.2,
        });
        let edge = |to: usize| [0, 1, 2].map(|k| corners[to][k] - corners[0][k]);
        let (a, b) = (edge(1), edge(2));
        let normal = [0, 1, 2].map(|k| {
            let (l, m) = ((k + 1) % 3, (k + 2) % 3);
            a[l] * b[m] - a[m] * b[l]
        });
        // The normal is 2 A n.
        let through: f64 = (0..3).map(|k| normal[k] * wind[k]).sum();
        let rate = 1.2 * 1.3 * 0.5 * through.abs() / (3.0 * mass);
        for (id, z) in [("explicit_euler", 2.0), ("rk4", 2.785_293_563_405_282)] {
            let Limit::At(limit) = start(&scene).predict(method(id), 0.01).limit else {
                panic!("{case}: {:?}", start(&scene).predict(method(id), 0.01));
            };
            let off = (limit * rate / z - 1.0).abs();
            // Corners a kilometre away know their edges of a metre to 1e-13, and the edges may be a tenth of that.
            assert!(
                off < if case < 12 { 1e-13 } else { 1e-11 },
                "{case} {id}: {off:e}"
            );
        }
    }
}

#[test]
fn drag_alone_is_the_textbook_test_equation() {
    // x' = -k x for the velocity, k = drag / m = 4.
    let mut scene = scene(
        vec![particle([0.0; 3], 0.5, false)],
        Vec::new(),
        DampingModel::Axial,
    );
    scene.particles[0].drag = 2.0;
    assert!(is_linear(&scene));
    let linearised = start(&scene);
    assert_eq!(linearised.omega_max(), None);
    // Limit and smoothness in units of 1/k; RK4's interval is published (Hairer, Wanner).
    let rows: [(&str, Option<f64>, Option<f64>); 8] = [
        ("explicit_euler", Some(2.0), Some(1.0)),
        // 1 - u + u²/2 has no root.
        ("midpoint", Some(2.0), Some(2.0)),
        (
            "rk4",
            Some(2.785_293_563_405_282),
            Some(2.785_293_563_405_282),
        ),
        ("symplectic_euler", Some(2.0), Some(1.0)),
        ("velocity_verlet", None, None),
        ("pefrl", None, None),
        ("implicit_euler", None, None),
        ("trapezoidal", None, Some(2.0)),
    ];
    for (id, limit, smooth) in rows {
        let prediction = linearised.predict(method(id), 0.01);
        let close = |a: f64, b: f64| (a - b).abs() < 1e-12;
        let holds = match (&prediction.limit, limit) {
            (Limit::At(h), Some(u)) => close(4.0 * h, u),
            (Limit::Unconditional, None) => true,
            _ => false,
        } && match (prediction.smooth_below_s, smooth) {
            (Some(h), Some(u)) => close(4.0 * h, u),
            (None, None) => true,
            _ => false,
        };
        assert!(holds, "{id}: {prediction:?}");
        // Decay at k and nothing slower, to the order of the method.
        let growth = prediction.growth_per_s.unwrap();
        assert!((growth / -4.0 - 1.0).abs() < 0.03, "{id}: {growth}");
    }
}

#[test]
fn a_spring_that_turns_is_tightest_where_it_is_stretched() {
    // The limit of explicit methods without damping follows the stiffest direction: along the spring
    // always k; so hang it with two springs, whose directions meet as the mass swings.
    let triangle = scene(
        vec![
            particle([-1.0, 0.0, 0.0], 1.0, true),
            particle([1.0, 0.0, 0.0], 1.0, true),
            particle([0.0, 0.0, -1.0], 1.0, false),
        ],
        vec![spring(0, 2, 50.0, 0.0, 0.7), spring(1, 2, 50.0, 0.0, 0.7)],
        DampingModel::Axial,
    );
    let (system, state) = built(&triangle);
    let at = |z: f64| {
        let mut x = state.x.clone();
        x[8] = z;
        x
    };
    let states: Vec<(f64, Vec<f64>)> = (0..21)
        .map(|i| (0.1 * f64::from(i), at(-1.0 + 0.1 * f64::from(i))))
        .collect();
    let rest = vec![0.0; 9];
    let verlet = method("velocity_verlet");
    let given: Vec<State> = states
        .iter()
        .map(|(t, x)| State {
            t: *t,
            ..State::new(x.clone(), rest.clone())
        })
        .collect();
    let found = LinearisedTrajectory::new(&system, &given)
        .tightest(verlet)
        .unwrap();
    // At z = 0 both pull along x: ω² = 2 k, at t = 1.
    assert!(
        (found.limit_s / (2.0 / 10.0) - 1.0).abs() < 1e-13,
        "{found:?}"
    );
    assert!((found.t_s - 1.0).abs() < 1e-12);
    let others = states.iter().filter(|(t, _)| (t - 1.0).abs() > 0.05);
    for (_, x) in others {
        let Limit::At(limit) = about(&system, x).predict(verlet, 0.01).limit else {
            panic!();
        };
        assert!(limit > found.limit_s);
    }
    let unbound = LinearisedTrajectory::new(&system, &given).tightest(method("implicit_euler"));
    assert!(unbound.is_none());
}
