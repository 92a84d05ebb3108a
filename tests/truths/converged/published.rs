//! The converged reference of shipped scenes against numbers that were computed elsewhere, at 36 digits.

use crate::testkit::distance;
use crate::testkit::scenes::shipped;
use springcheck::physics::ParticleSystem;
use springcheck::scene::Scene;
use springcheck::truth::converged::find;
use springcheck::truth::{Motion, NoStore};

/// A scene, and the coordinates of its last particles at a time.
type Row = (&'static str, f64, &'static [f64]);

const ROWS: [Row; 10] = [
    (
        "elastic_pendulum",
        1.0,
        &[-0.677_369_453_948_816_7, 0.0, -0.955_493_276_394_951_7],
    ),
    (
        "elastic_pendulum",
        2.0,
        &[-0.464_148_688_186_332_6, 0.0, -1.361_908_463_638_877_4],
    ),
    (
        "elastic_pendulum",
        10.0,
        &[-1.048_027_168_891_99, 0.0, -0.111_684_552_376_709_13],
    ),
    ("duffing", 1.0, &[0.233_691_791_143_141_27, 0.0, 0.0]),
    ("duffing", 5.0, &[0.947_129_542_080_219_4, 0.0, 0.0]),
    ("duffing", 10.0, &[0.798_874_768_997_414_3, 0.0, 0.0]),
    (
        "figure_eight",
        2.0,
        &[
            0.101_981_780_073_515_95,
            0.093_056_418_586_129_52,
            0.0,
            0.911_862_036_365_986_2,
            -0.287_763_794_323_004_9,
            0.0,
            -1.013_843_816_439_502_2,
            0.194_707_375_736_875_38,
            0.0,
        ],
    ),
    (
        "kepler",
        1.0,
        &[-0.427_967_245_561_113_55, 0.863_775_701_045_103_7, 0.0],
    ),
    // A whole round, and a whole period of the spring: 4 K(1/4) / sqrt(2).
    ("kepler", std::f64::consts::TAU, &[0.5, 0.0, 0.0]),
    ("duffing", 4.768_022_029_102_461, &[1.0, 0.0, 0.0]),
];

/// How far the reference is off, and its error bar with the rounding of the numbers published, m.
fn off(scene: &Scene, t: f64, published: &[f64]) -> [f64; 2] {
    let system = ParticleSystem::new(scene);
    let found = find(scene, &system, t, &NoStore).expect("it converges");
    let x = found.motion.states(&[t]).x;
    let error = distance(&x[x.len() - published.len()..], published);
    [error, found.motion.error_bar(t) + 4.0 * f64::EPSILON]
}

#[test]
fn references_are_where_others_found_them() {
    for (name, t, published) in ROWS {
        let scene = shipped(&format!("effects/{name}.yml"));
        let [error, bar] = off(&scene, t, published);
        assert!(error <= bar, "{name} at {t} s: {error:e} of {bar:e}");
    }
    // The bar tells a number that is wrong in the eleventh digit.
    let mut wrong = shipped("effects/duffing.yml");
    wrong.springs[0].cubic *= 1.0 + 1e-10;
    let (_, t, published) = ROWS[4];
    let [error, bar] = off(&wrong, t, published);
    assert!(error > bar, "{error:e} of {bar:e}");
}

/// Simó's start is of eight digits, and misses itself by as much as was found elsewhere: 3.89639e-8 in a velocity.
#[test]
fn the_figure_eight_misses_its_start_by_its_digits() {
    let scene = shipped("effects/figure_eight.yml");
    let start = ParticleSystem::initial_state(&scene);
    let system = ParticleSystem::new(&scene);
    let found = find(&scene, &system, scene.duration, &NoStore).expect("it converges");
    let states = found.motion.states(&[scene.duration]);
    let miss = distance(&states.x, &start.x).max(distance(&states.v, &start.v));
    // Half a unit of its last digit, and the reference's own error, of some 1e-13 m and m/s.
    let bar = 10.0 * found.motion.error_bar(scene.duration);
    assert!(
        (miss - 3.896_39e-8).abs() <= 0.5e-13 + bar,
        "{miss:e}, {bar:e}"
    );
}
