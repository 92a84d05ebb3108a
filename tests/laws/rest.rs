//! Where scenes come to rest, held to the statics of strings, nets, catenaries and beams.

use crate::testkit::method;
use crate::testkit::scenes::{all_shipped, parsed as parse};
use springcheck::integrators::Settings;
use springcheck::measure::Statics;
use springcheck::measure::rest::{self, Modes, Rest, RestError};
use springcheck::physics::{ParticleSystem, State, System};
use springcheck::scene::Scene;
use std::f64::consts::PI;

fn with(gravity: f64, members: &str) -> Scene {
    parse(&format!(
        "solver: {{type: rk4, timestep: 0.001, gravity: {gravity}}}\n{members}\n"
    ))
}

fn found(scene: &Scene) -> Rest {
    rest::find(scene).unwrap_or_else(|error| panic!("{error}"))
}

fn modes(scene: &Scene, rest: &Rest) -> Modes {
    rest::modes(&ParticleSystem::new(scene), &rest.x).expect("modes")
}

fn near(found: f64, wanted: f64, within: f64) {
    assert!(
        (found / wanted - 1.0).abs() < within,
        "{found} for {wanted}: off by {:e}",
        found / wanted - 1.0
    );
}

/// N equal masses on springs: spring j from the bottom carries j weights, so that the lowest sags by
/// m g N (N + 1)/(2 k); elastic energy sum (j m g)²/(2 k).
#[test]
fn a_hanging_string_sags_by_its_closed_form() {
    for (n, mass, k, sag, energy) in [
        (10, 0.1, 100.0, 0.53955, 1.852544925),
        (20, 0.05, 1000.0, 0.103005, 0.34524700875),
    ] {
        let scene = with(
            -9.81,
            &format!(
                "objects: [string: {{from: [0, 0, 2], to: [0, 0, 1], particles: {}, particle_mass: {mass}, \
                 stiffness: {k}, pins: [start]}}]",
                n + 1
            ),
        );
        let rest = found(&scene);
        // Positions of 2 m to a rounding, over the sag.
        near(1.0 - rest.x[3 * n + 2], sag, 1e-14);
        let state = State::new(rest.x.clone(), vec![0.0; rest.x.len()]);
        let tensions = Statics::new(&scene).tensions(&state);
        for (from_top, tension) in tensions.iter().enumerate() {
            // A rounding of positions of 2 m moves it by k eps 2.
            near(*tension, (n - from_top) as f64 * mass * 9.81, 1e-12);
        }
        let elastic: f64 = tensions.iter().map(|t| t * t / (2.0 * k)).sum();
        near(elastic, energy, 1e-12);
    }
}

/// Without rest length each spring is linear, and a net in a fixed rim sags as the discrete Poisson equation has it.
#[test]
fn a_net_sags_as_its_sine_series() {
    for (n, sag) in [
        (3, 0.001103625),
        (9, 0.007170956525901209),
        (19, 0.028851880703182344),
    ] {
        let scene = with(
            -9.81,
            &format!(
                "objects: [net: {{origin: [0, 0, 0], plane: xy, size: [1, 1], particles: [{0}, {0}], \
                 particle_mass: 0.01, structural: {{stiffness: 100}}, rest_ratio: 0, pins: [rim]}}]",
                n + 2
            ),
        );
        let rest = found(&scene);
        let middle = (n + 2) * (n + 2) / 2;
        // Sums of 20² knots' forces, each to a rounding of 1 m times k.
        near(-rest.x[3 * middle + 2], sag, 2e-12);
    }
}

/// What links without stretch would give: by two stiffnesses, since the error is proportional to the compliance. Links of
/// 2e7 N/m keep forces of 1 N to 2e7 roundings of 1 m, 4e-9, and the square of their stretch is 1e-14.
fn unstretched(of: impl Fn(f64) -> f64) -> f64 {
    2.0 * of(2e7) - of(1e7)
}
const UNSTRETCHED: f64 = 1e-8;

/// A chain of n links between two points: the polygon of equal weights.
#[test]
fn a_chain_of_links_hangs_as_its_polygon() {
    for (n, sag, pull) in [
        (2, 0.5590169943749474, 0.4472135954999579),
        (4, 0.5243196132422464, 0.8198164804651956),
        (10, 0.5059459315710845, 2.0510510143091193),
        (20, 0.5034466343401927, 4.107878988926029),
    ] {
        let hung = |stiffness: f64| {
            let scene = with(
                -1.0,
                &format!(
                    "objects: [chain: {{from: [0, 0, 0], to: [1, 0, 0], particles: {}, particle_mass: 1, \
                     stiffness: {stiffness}, rest_ratio: 1.5, pins: [start, end]}}]",
                    n + 1
                ),
            );
            let rest = found(&scene);
            assert_eq!(modes(&scene, &rest).unstable(), 0);
            let deepest = rest
                .x
                .iter()
                .skip(2)
                .step_by(3)
                .fold(0.0, |low: f64, z| low.min(*z));
            let state = State::new(rest.x.clone(), vec![0.0; rest.x.len()]);
            let held = Statics::new(&scene).reactions(&state);
            // Each end holds half the weight, to roundings of lengths of 1 m times 2e7 N/m.
            near(held[2], 0.5 * f64::from(n - 1), 1e-7);
            [-deepest, -held[0]]
        };
        near(unstretched(|k| hung(k)[0]), sag, UNSTRETCHED);
        // Roundings of the pull are those of k times a length, as above.
        near(unstretched(|k| hung(k)[1]), pull, 1e-7);
    }
}

/// What refining by 2 tends to, of values with an error of order 2.
fn tends_to([coarse, fine]: [f64; 2]) -> f64 {
    fine + (fine - coarse) / 3.0
}

/// The elastic catenary of span 1, length 1.5, EA = 10 weights, that a refined string nears at order 2.
#[test]
fn a_refined_string_hangs_as_the_elastic_catenary() {
    let at = |refine: u32| {
        let scene = with(
            -1.0,
            &format!(
                "objects: [string: {{from: [0, 0, 0], to: [1, 0, 0], particles: 5, mass: 1.5, \
                 stiffness: 40, rest_ratio: 1.5, pins: [start, end], refine: {refine}}}]"
            ),
        );
        let rest = found(&scene);
        let state = State::new(rest.x.clone(), vec![0.0; rest.x.len()]);
        let middle = scene.particles.len() / 2;
        [
            -rest.x[3 * middle + 2],
            -Statics::new(&scene).reactions(&state)[0],
        ]
    };
    let rows: Vec<[f64; 2]> = [4, 8, 16].into_iter().map(at).collect();
    // What is left of order 4 is a 420th of the finest's error of the sag, and a 1700th of that of the pull.
    for (quantity, wanted, left) in [
        (0, 0.5339439863934189, 1.0 / 200.0),
        (1, 0.2883138819842526, 1.0 / 800.0),
    ] {
        let error = |row: usize| rows[row][quantity] - wanted;
        let order = (error(1) / error(2)).log2();
        assert!((order - 2.0).abs() < 0.005, "order {order}");
        let limit = tends_to([rows[1][quantity], rows[2][quantity]]);
        assert!((limit - wanted).abs() < left * error(2).abs(), "{limit}");
    }
}

/// Where the tip of a hair of this many links is that leaves its root level along x, m: x, or how far it has dropped; 1 m
/// long, EI = 1. `hung` is the weight that hangs at its tip by a long thread, N, and `own` that of the hair.
fn tip(which: Tip, links: u32, hung: f64, own: f64) -> f64 {
    unstretched(|stiffness| tip_at(stiffness, links, hung, own)[which as usize])
}

#[derive(Clone, Copy)]
enum Tip {
    Along,
    Drop,
}

fn tip_at(stiffness: f64, links: u32, hung: f64, own: f64) -> [f64; 2] {
    let scene = parse(&format!(
        "solver: {{type: rk4, timestep: 0.001, gravity: -1}}\n\
         particles: [{{pos: [1, 0, -10], mass: {hung}}}]\n\
         objects: [hair: {{from: [0, 0, 0], to: [1, 0, 0], particles: {}, mass: {own}, \
         structural: {{stiffness: {stiffness}}}, bending: {{stiffness: {links}}}, clamp: [1, 0, 0]}}]\n\
         springs: [{{particle_ids: [0, \"hair[{links}]\"], stiffness: 1e3}}]\n",
        links + 1
    ));
    let rest = found(&scene);
    let tip = 3 * (links as usize + 1);
    [rest.x[tip], -rest.x[tip + 2]]
}

/// A clamped hair of n links with hinges EI/l and twice that at its root, under a load of 1 at its tip, and the elastica
/// that it nears: 0.142/n² off.
#[test]
fn a_hair_under_a_load_is_the_discrete_elastica() {
    for (links, wanted) in [
        (8, 0.303931679124),
        (16, 0.302273620254),
        (32, 0.301858992697),
        (64, 0.301755328976),
    ] {
        // Roundings of 2e7 N/m are 4e-9 N, beside a load of 1 N that bends as much across.
        near(tip(Tip::Drop, links, 1.0, 1e-12), wanted, 3e-10);
    }
}

/// Refined, the hair nears the elastica of a load at its tip, and that of its own weight, at order 2: what is left of
/// order 4 at 64 links is some 1e-9, ten times that where it hangs almost straight down.
#[test]
fn a_refined_hair_is_the_elastica() {
    for (hung, own, wanted, left) in [
        (1.0, 1e-12, [0.9435667637166231, 0.3017207737981335], 6e-9),
        (2.0, 1e-12, [0.8393582791748328, 0.4934574803967118], 3e-8),
        (10.0, 1e-12, [0.4450044022462487, 0.810609028802465], 9e-7),
        (1e-12, 1.0, [0.9912463953466352, 0.12347140198335106], 6e-8),
        (1e-12, 8.0, [0.7244247341381395, 0.6406307174218925], 4e-7),
    ] {
        for (which, wanted) in [Tip::Along, Tip::Drop].into_iter().zip(wanted) {
            let tips = [16, 32, 64].map(|links| tip(which, links, hung, own));
            let order = ((tips[0] - wanted) / (tips[1] - wanted)).log2();
            assert!(
                (order - 2.0).abs() < 0.02,
                "order {order} at {hung} and {own}"
            );
            near(tends_to([tips[1], tips[2]]), wanted, left);
        }
    }
}

/// What stands upright on a spring falls as an inverted pendulum: its spring pushes with m g, so that a nudge aside grows
/// with sqrt(g/l), l its length then. Both directions aside are alike.
#[test]
fn what_stands_upright_is_found_unstable() {
    let scene = with(
        -9.81,
        "particles: [{pos: [0, 0, 0], fixed: true}, {pos: [0, 0, 1], mass: 0.5}]\n\
         springs: [{particle_ids: [0, 1], stiffness: 100}]",
    );
    let rest = found(&scene);
    let length = 1.0 - 0.5 * 9.81 / 100.0;
    near(rest.x[5], length, 1e-15);
    let modes = modes(&scene, &rest);
    assert_eq!((modes.unstable(), modes.free(), modes.all), (2, 0, true));
    let found: Vec<f64> = modes.lowest.iter().map(|mode| mode.stiffness).collect();
    for (found, wanted) in found.iter().zip([-9.81 / length, -9.81 / length, 200.0]) {
        near(*found, wanted, 1e-13);
    }
}

/// Without gravity a particle on a spring costs nothing aside; a thread between two walls at its own length neither.
#[test]
fn a_mechanism_is_found() {
    let scene = with(
        0.0,
        "objects: [string: {from: [0, 0, 0], to: [1, 0, 0], particles: 12, mass: 1, stiffness: 10, pins: [start, end]}]",
    );
    let rest = found(&scene);
    assert_eq!(rest.iterations, 0);
    let modes = modes(&scene, &rest);
    assert_eq!((modes.unstable(), modes.free()), (0, 20));
}

/// Nothing holds what falls, in a wind or under gravity, beside something that is held.
#[test]
fn what_nothing_holds_has_no_rest() {
    for more in ["", "\nwind: {direction: [1, 0, 0], strength: 1}"] {
        let scene = with(
            if more.is_empty() { -9.81 } else { 0.0 },
            &format!(
                "particles: [{{pos: [0, 0, 0], fixed: true}}, {{pos: [0, 0, 1], mass: 1}}, {{pos: [2, 0, 0], mass: 1}}]\n\
                 springs: [{{particle_ids: [0, 1], stiffness: 100}}]{more}"
            ),
        );
        assert_eq!(rest::find(&scene), Err(RestError::NotHeld { particle: 2 }));
    }
}

/// A string that hangs by one end and does not stretch swings as the continuum does, at the first zero of J_0 over two
/// times sqrt(g/L): half masses at the ends make it of order 2.
#[test]
fn a_hanging_string_swings_as_the_continuum() {
    let square = |refine: u32| {
        let scene = with(
            -9.81,
            &format!(
                "objects: [string: {{from: [0, 0, 2], to: [0, 0, 0], particles: 5, mass: 3, stiffness: 1e9, \
                 pins: [start], refine: {refine}}}]"
            ),
        );
        let rest = found(&scene);
        modes(&scene, &rest).lowest[0].stiffness
    };
    let squares = [2, 4, 8].map(square);
    let wanted = (2.404825557695773_f64 / 2.0).powi(2) * 9.81 / 2.0;
    let order = ((squares[0] - wanted) / (squares[1] - wanted)).log2();
    assert!((order - 2.0).abs() < 0.02, "order {order}");
    // What is left of order 4 at 32 links.
    near(tends_to([squares[1], squares[2]]), wanted, 1.5e-6);
}

/// Small and large scenes are solved by different means: both find the frequencies of a string between walls,
/// 2 sqrt(k/m) sin(j pi/(2 (N + 1))), along it.
#[test]
fn frequencies_are_those_of_the_string() {
    // A frequency's square to this many roundings of the largest, and a few of its own.
    for (n, roundings) in [(12, 2.0), (60, 0.3)] {
        let scene = with(
            0.0,
            &format!(
                "objects: [string: {{from: [0, 0, 0], to: [1, 0, 0], particles: {}, particle_mass: 0.05, \
                 stiffness: 1000, rest_ratio: 0, pins: [start, end]}}]",
                n + 2
            ),
        );
        let rest = found(&scene);
        let modes = modes(&scene, &rest);
        // Without rest length a spring is as stiff across: each frequency three times.
        for (at, mode) in modes.lowest.iter().enumerate() {
            let angle = (at / 3 + 1) as f64 * std::f64::consts::PI / (2 * (n + 1)) as f64;
            let part = angle.sin().powi(2);
            let within = f64::EPSILON * (16.0 + roundings / part);
            near(mode.stiffness, 80_000.0 * part, within);
        }
    }
}

/// A string that hangs at rest and is let go: each of its modes 2 sqrt(k/m) sin(j pi/(2 N)) of N free masses starts at its
/// largest, and the middle of its mass falls as a stone. Its foot stays where it is until the wave of the release comes,
/// after N sqrt(m/k).
#[test]
fn the_foot_of_a_slinky_waits() {
    let (n, m, k, g) = (21, 0.05, 1000.0_f64, 9.81);
    let mut scene = with(
        -g,
        "objects: [string: {from: [0, 0, 1], to: [0, 0, 0], particles: 21, particle_mass: 0.05, stiffness: 1000, pins: [start]}]",
    );
    let start = found(&scene).x;
    scene.particles[0].fixed = false;
    let system = ParticleSystem::new(&scene);
    let mut state = State::new(start.clone(), vec![0.0; start.len()]);
    let height = |x: &[f64], id: usize| x[3 * id + 2];
    let wave = (n - 1) as f64 * (m / k).sqrt();
    near(wave, 0.1414213562373095, 1e-15);
    let mut stepper = method("rk4").build(&Settings::default());
    let h = wave / 1000.0;
    for step in 1..=1500 {
        stepper.step(&system, h, &mut state).expect("a step");
        if ![700, 1000, 1500].contains(&step) {
            continue;
        }
        let fallen = 0.5 * g * state.t * state.t;
        let middle = |x: &[f64]| (0..n).map(|id| height(x, id)).sum::<f64>() / n as f64;
        near(middle(&start) - middle(&state.x), fallen, 1e-12);
        // The foot by the closed form: the stretches are modes about the middle, each from rest.
        let own = |id: usize| -0.05 * id as f64;
        let shape = |j: usize, id: usize| (j as f64 * PI * (id as f64 + 0.5) / n as f64).cos();
        let stretched: f64 = (1..n)
            .map(|j| {
                let q: f64 = (0..n)
                    .map(|id| shape(j, id) * (height(&start, id) - own(id)))
                    .sum();
                let omega = 2.0 * (k / m).sqrt() * (j as f64 * PI / (2 * n) as f64).sin();
                2.0 / n as f64 * q * shape(j, n - 1) * (omega * state.t).cos()
            })
            .sum();
        let foot = middle(&start) - fallen + own(n - 1) + 0.5 + stretched;
        // RK4 with z = 0.04 over 1500 steps: z⁴/120 of each radian, of motions of 0.1 m.
        assert!((height(&state.x, n - 1) - foot).abs() < 3e-8);
        let waited = height(&start, n - 1) - height(&state.x, n - 1);
        assert_eq!(
            waited < 0.001 * fallen,
            step == 700,
            "{step} {waited} {fallen}"
        );
    }
}

/// A blow on one mass of a long chain at rest, k = m = 1: mass n then moves with J_2n(2 t), and at ten links a wavelength a
/// wave has the speed sin(pi/10)/(pi/10) of a long one.
#[test]
fn a_blow_on_a_chain_travels_as_bessel_functions() {
    let mut scene = with(
        0.0,
        "objects: [chain: {from: [0, 0, 0], to: [60, 0, 0], particles: 61, particle_mass: 1, stiffness: 1, pins: [start, end]}]",
    );
    scene.particles[30].velocity = [1.0, 0.0, 0.0];
    let system = ParticleSystem::new(&scene);
    // J_20(24), and the first peak of J_20(2 t).
    for (t, wanted) in [
        (12.0, 0.16191265166449529),
        (11.10957324145065, 0.24330206572456014),
    ] {
        let mut state = ParticleSystem::initial_state(&scene);
        let mut stepper = method("rk4").build(&Settings::default());
        for _ in 0..1200 {
            stepper
                .step(&system, t / 1200.0, &mut state)
                .expect("a step");
        }
        // z = 0.02: z⁴/120 of 24 radians.
        near(state.v[3 * 40], wanted, 1e-7);
    }
    let rest = found(&with(
        0.0,
        "objects: [chain: {from: [0, 0, 0], to: [20, 0, 0], particles: 21, particle_mass: 1, stiffness: 1, pins: [start, end]}]",
    ));
    let scene = with(
        0.0,
        "objects: [chain: {from: [0, 0, 0], to: [20, 0, 0], particles: 21, particle_mass: 1, stiffness: 1, pins: [start, end]}]",
    );
    let along = modes(&scene, &rest)
        .lowest
        .into_iter()
        .filter(|mode| mode.stiffness > 0.0);
    // The fourth of 19 masses has ten links a wavelength.
    let omega = along
        .map(|mode| mode.stiffness.sqrt())
        .nth(3)
        .expect("a mode");
    near(omega / (PI / 5.0), 0.983631643083466, 1e-14);
}

/// A weight on a spring in a wind, in moving air with linear or quadratic drag, or under two gravities: the spring points
/// along the sum of the forces, and is longer by its size over k.
#[test]
fn a_weight_hangs_along_what_pulls_at_it() {
    for (more, drag, pull) in [
        (
            "wind: {direction: [3, 0, 4], strength: 2}",
            "",
            [1.2, 0.0, 1.6],
        ),
        ("air: {velocity: [0, 3, 0]}", "drag: 0.5", [0.0, 1.5, 0.0]),
        (
            "air: {velocity: [0, -2, 0]}",
            "quadratic_drag: 0.3",
            [0.0, -1.2, 0.0],
        ),
    ] {
        let scene = with(
            -9.81,
            &format!(
                "particles: [{{pos: [0, 0, 0], fixed: true}}, {{pos: [0.3, 0, -0.9], mass: 0.2, {drag}}}]\n\
                 springs: [{{particle_ids: [0, 1], stiffness: 40, rest_length: 0.5}}]\n{more}"
            ),
        );
        let force = [pull[0], pull[1], pull[2] - 0.2 * 9.81];
        let size = force.iter().map(|f| f * f).sum::<f64>().sqrt();
        let x = found(&scene).x;
        for (x, f) in x[3..].iter().zip(force) {
            // A rounding of the length times k, over the force across: 40 eps / 2.
            assert!((x - (0.5 + size / 40.0) * f / size).abs() < 4e-15, "{x}");
        }
    }
}

/// Of every shipped scene of objects and effects that comes to rest: no force of the whole system is left on what is free,
/// and without moving air nothing lies higher than at the start.
#[test]
fn no_force_is_left_at_rest() {
    let mut rests = 0;
    for scene in all_shipped(&["string", "hair", "cloth", "effects"]) {
        let Ok(rest) = rest::find(&scene) else {
            continue;
        };
        rests += 1;
        let held = rest::held(&scene);
        let system = ParticleSystem::new(&held);
        let still = vec![0.0; rest.x.len()];
        let mut forces = still.clone();
        system.forces(0.0, &rest.x, &still, &mut forces);
        let free = forces
            .iter()
            .zip(system.inverse_mass())
            .filter(|(_, w)| **w > 0.0);
        let left = free.fold(0.0, |most: f64, (f, _)| most.max(f.abs()));
        // What holds the scene there or pulls at it at the start, N; what is left is rounding of it, or 0.
        let start = ParticleSystem::initial_state(&held).x;
        let mut before = still.clone();
        system.forces(0.0, &start, &still, &mut before);
        let all = forces.iter().chain(&before);
        let size = all.fold(0.0, |most: f64, f| most.max(f.abs()));
        assert!(left <= 1e-9 * size, "{}: {left} of {size}", scene.name);
        let fell = system.potential(0.0, &start) - system.potential(0.0, &rest.x);
        let blown = scene.wind.is_some() || scene.air.is_some();
        assert!(blown || fell >= -1e-12 * size, "{}: {fell}", scene.name);
    }
    assert!(rests > 10, "{rests}");
}

/// However fine, a hair bends under its own weight: what hinges of other programs may be off by is no rest. The drop of
/// w L³/EI = 1 at 256 links is the elastica's to 0.1 %.
#[test]
fn a_fine_hair_is_not_at_rest_where_it_starts() {
    let found = tip(Tip::Drop, 256, 1e-12, 1.0);
    near(found, 0.12347140198335106, 1e-3);
}

/// A free block moves and turns as a whole at no cost, six ways, of any size; nothing else of it does.
#[test]
fn a_free_block_has_six_motions_that_cost_nothing() {
    for n in [2, 4] {
        let scene = with(
            0.0,
            &format!(
                "objects: [lattice: {{origin: [0, 0, 0], u: [1, 0, 0], v: [0, 1, 0], w: [0, 0, 1], \
                 particles: [{n}, {n}, {n}], mass: 1, structural: {{stiffness: 100}}, shear: {{stiffness: 50}}, \
                 diagonal: {{stiffness: 20}}}}]"
            ),
        );
        let modes = modes(&scene, &found(&scene));
        assert_eq!(
            (modes.free(), modes.unstable(), modes.counted()),
            (6, 0, true)
        );
        assert!(modes.lowest.len() >= 14, "others are found beside them");
    }
}
