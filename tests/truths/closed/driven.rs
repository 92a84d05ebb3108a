//! Driven oscillators: against numbers of 40 digits, and against the converged reference, which shares nothing with the
//! forms but the forces; and the spline of a table against one solved as a whole.

use super::form;
use crate::testkit::scenes::{chain, empty, fixed, free, shipped, spring};
use crate::testkit::{Random, distance};
use springcheck::physics::ParticleSystem;
use springcheck::scene::{DampingModel, Driven, Scene, Sine, Table};
use springcheck::truth::converged;
use springcheck::truth::{Motion, NoStore};

fn sine(particle: usize, amplitude: [f64; 3], omega: f64, phase: f64) -> Driven {
    Driven {
        particle,
        sine: Some(Sine {
            amplitude,
            omega,
            phase,
        }),
        ..Driven::default()
    }
}

fn steady(particle: usize, velocity: [f64; 3]) -> Driven {
    Driven {
        particle,
        velocity: Some(velocity),
        ..Driven::default()
    }
}

/// Golden number 6 and more: k, c, amplitude, W, phase, velocity of the end, t; displacement and velocity of a unit mass
/// on an axial damper and a spring of 5 m that starts at rest. From mpmath at 40 digits, by quadrature of the impulse
/// response: below and above resonance, backwards, undamped at resonance, critical, overdamped, stiffly damped, early.
#[rustfmt::skip]
const GOLDEN: [[f64; 9]; 13] = [
    [50.0, 1.0, 0.1, 5.0, 0.0, 0.0, 5.0, -0.038859512407712724, 1.0240750113833248],
    [50.0, 0.0, 0.1, 7.0, 0.4, 0.0, 3.0, 0.9073199399349567, 3.373193164955861],
    [50.0, 0.0, 0.1, -3.0, 0.4, 0.0, 3.0, -0.08896780626198324, 0.050688000164832554],
    [49.0, 0.0, 0.1, 7.0, 0.0, 0.0, 4.0, 1.3611935022543868, 2.6548767254171164],
    [49.0, 14.0, 0.1, 7.0, 0.0, 0.0, 2.0, 0.09222333416542794, 0.4424321196593084],
    [50.0, 20.0, 0.1, 5.0, 1.2, 0.0, 2.0, -0.20170855220929243, -0.007576549690308449],
    [50.0, 20.0, 0.0, 0.0, 0.0, 0.3, 2.0, 0.5999393866785943, 0.30017753230809463],
    [50.0, 1.0, 0.0, 0.0, 0.0, 0.3, 2.0, 0.5843602750340587, 0.30446190327633044],
    [49.0, 14.0, 0.0, 0.0, 0.0, -0.2, 1.5, -0.2999917390651951, -0.20005231925376454],
    [4.0, 100.0, 0.2, 3.0, 0.3, 0.0, 2.0, -0.06176321559715755, 0.5999187855685492],
    [4.0, 100.0, 0.0, 0.0, 0.0, 0.3, 2.0, 0.5972285215792356, 0.30011090351599573],
    [50.0, 1.0, 0.1, 5.0, 0.3, 0.0, 0.01, 2.76201364032095e-05, 0.005893457179304762],
    [50.0, 1.0, 0.0, 0.0, 0.0, 0.3, 0.01, 1.743704035734995e-05, 0.0037297579959004435],
];

/// The motion's distance from the golden numbers, in units of the bar (of the velocity: times the fastest rate).
fn off([k, c, a, w, phase, u, t, x, v]: [f64; 9], change: f64) -> f64 {
    let drive = if a == 0.0 {
        steady(0, [u, 0.0, 0.0])
    } else {
        sine(0, [a, 0.0, 0.0], w * change, phase)
    };
    let mut scene = Scene {
        particles: vec![fixed([0.0; 3]), free([5.0, 0.0, 0.0], 1.0)],
        springs: vec![spring([0, 1], k * change, 5.0)],
        driven: vec![drive],
        ..empty()
    };
    scene.springs[0].damping = c;
    // The particle starts where the spring is at rest, whatever the phase.
    let from = scene.starts()[0][0];
    scene.particles[1].position[0] = 5.0 + from;
    let found = form(&scene, t).expect("a closed form");
    let motion = found.motion().expect("a motion");
    let state = motion.states(&[t]);
    let bar = motion.error_bar(t);
    let rate = k.sqrt() + c + w.abs();
    let moved = [state.x(0)[3] - (5.0 + from) - x, (state.v(0)[3] - v) / rate];
    moved
        .into_iter()
        .fold(0.0, |most: f64, d| most.max(d.abs()))
        / bar
}

#[test]
fn golden_numbers() {
    for golden in GOLDEN {
        let right = off(golden, 1.0);
        assert!(right <= 1.0, "{golden:?}: {right}");
        // A stiffness and a frequency that are off by a billionth, where there has been time to see it.
        let wrong = off(golden, 1.0 + 1e-9);
        assert!(wrong > 1.0 || golden[6] < 0.1, "{golden:?}: {wrong}");
    }
}

/// The shipped scene is golden number 6, and swings in the end as theory says.
#[test]
fn the_shipped_scenes() {
    // Golden number 6 for the first two, then 0.1 sqrt(k² + (c W)²) / sqrt((k - m W²)² + (c W)²).
    for (name, steady) in [
        ("below", 0.197_094_276_543_368_57),
        ("at_resonance", 0.714_142_842_854_285),
        ("above", 0.1 * (2900.0_f64 / 122_900.0).sqrt()),
    ] {
        let mut scene = shipped(&format!("effects/driven_{name}.yml"));
        scene.duration = 80.0;
        let found = form(&scene, 80.0).expect("a closed form");
        let times: Vec<f64> = (0..4000).map(|k| 78.0 + 5e-4 * f64::from(k)).collect();
        let states = found.motion().expect("a motion").states(&times);
        let far = |k: usize| (states.x(k)[3] - 1.0).abs();
        let most = (0..times.len()).map(far).fold(0.0, f64::max);
        // e^(-39) of the transient is left, and samples miss the peak by (W 2.5e-4 s)² / 2 = 1.3e-5 parts at most.
        assert!((most / steady - 1.0).abs() < 4e-5, "{name}: {most}");
    }
}

/// Networks with several driven ends: in line with rest lengths, and in space without.
fn networks() -> Vec<Scene> {
    let mut random = Random(6);
    let mut line = chain(4, 0.5, 0.3, 200.0);
    line.particles[4].fixed = true;
    for spring in &mut line.springs {
        spring.damping = 0.004 * spring.stiffness;
    }
    line.driven = vec![
        sine(0, [0.05, 0.0, 0.0], 11.0, 0.7),
        sine(4, [0.04, 0.0, 0.0], -6.0, 0.2),
    ];
    let mut pulled = line.clone();
    pulled.driven[1] = steady(4, [0.06, 0.0, 0.0]);
    let mut space = Scene {
        damping_model: DampingModel::Isotropic,
        ..empty()
    };
    let mut at = || [random.next(), random.next(), random.next()];
    space.particles = vec![fixed(at()), free(at(), 0.4), free(at(), 0.7), fixed(at())];
    space.springs = [[0, 1], [1, 2], [2, 3], [0, 2]]
        .map(|ends| spring(ends, 40.0, 0.0))
        .to_vec();
    for spring in &mut space.springs {
        spring.damping = 0.01 * spring.stiffness;
    }
    space.solver.gravity = -9.81;
    space.driven = vec![
        sine(0, [0.2, -0.1, 0.3], 8.0, 1.0),
        steady(3, [0.1, 0.2, -0.3]),
    ];
    vec![line, pulled, space]
}

#[test]
fn networks_move_as_the_converged_reference_does() {
    for (at, scene) in networks().into_iter().enumerate() {
        let until = 2.0;
        let closed = form(&scene, until).unwrap_or_else(|| panic!("{at}: no closed form"));
        let system = ParticleSystem::new(&scene);
        let reference = converged::find(&scene, &system, until, &NoStore).expect("it converges");
        let times: Vec<f64> = (0..=20).map(|k| 0.1 * f64::from(k)).collect();
        let motion = closed.motion().expect("a motion");
        let (ours, theirs) = (motion.states(&times), reference.motion.states(&times));
        for (k, t) in times.iter().enumerate() {
            let apart = distance(ours.x(k), theirs.x(k));
            let bar = motion.error_bar(*t) + reference.motion.error_bar(*t);
            assert!(apart <= bar, "{at}, {t} s: {apart:e} of {bar:e}");
        }
        // Bars that say something.
        assert!(motion.error_bar(until) < 1e-11, "{at}");
    }
}

#[test]
fn no_form_of_what_leaves_its_line_or_is_a_table() {
    let scene = shipped("effects/driven_below.yml");
    assert!(form(&scene, 1.0).is_some());
    let mut aside = scene.clone();
    aside.driven = vec![sine(0, [0.1, 1e-9, 0.0], 5.0, 0.0)];
    assert!(form(&aside, 1.0).is_none());
    let mut table = scene.clone();
    table.driven = vec![Driven {
        table: Some(Table(vec![[0.0; 4], [1.0, 0.1, 0.0, 0.0]])),
        ..Driven::default()
    }];
    assert!(form(&table, 1.0).is_none());
    // A swing that takes the end beyond the particle.
    let mut through = scene;
    through.driven = vec![sine(0, [1.5, 0.0, 0.0], 5.0, 0.0)];
    assert!(form(&through, 1.0).is_none());
}

/// t, position and velocity on the natural spline through (0, 0), (0.3, 0.2), (0.5, -0.1), (1.1, 0.4), (2, 0.3), from
/// mpmath: one linear system for all coefficients.
const SPLINE: [[f64; 3]; 7] = [
    [-0.5, -0.7199074074074074, 1.4398148148148149],
    [0.1, 0.13539094650205763, 1.1820987654320987],
    [0.4, 0.05787037037037033, -1.7314814814814816],
    [0.8, -0.029166666666666678, 1.25],
    [1.5, 0.5812071330589849, -0.1594650205761316],
    [2.0, 0.3, -0.7638888888888888],
    [3.0, -0.4638888888888889, -0.7638888888888888],
];

#[test]
fn a_table_is_passed_on_a_natural_spline() {
    let rows = [[0.0, 0.0], [0.3, 0.2], [0.5, -0.1], [1.1, 0.4], [2.0, 0.3]];
    let scene = Scene {
        particles: vec![fixed([0.0; 3]), free([1.0, 0.0, 0.0], 1.0)],
        driven: vec![Driven {
            table: Some(Table(rows.map(|[t, x]| [t, x, -x, 0.0]).to_vec())),
            ..Driven::default()
        }],
        ..empty()
    };
    let drive = &scene.drives()[0];
    for [t, x, v] in SPLINE {
        let [position, velocity, _] = drive.at(t);
        // A dozen roundings of numbers up to 2.
        for (found, golden) in [(position[0], x), (-position[1], x), (velocity[0], v)] {
            assert!((found - golden).abs() < 24.0 * f64::EPSILON, "{t}: {found}");
        }
    }
    for [t, x] in rows {
        assert_eq!(drive.at(t)[0], [x, -x, 0.0], "{t}");
    }
}
