//! Forces, powers and damping against the plain loop, bit by bit.

use super::plain::{self, FAULTS, Fault};
use crate::testkit::cloth::{cloth, shuffled};
use rayon::ThreadPoolBuilder;
use springcheck::physics::ParticleSystem;
use springcheck::physics::effects::{Effect, Springs};
use springcheck::scene::{DampingModel, Scene};

const MODELS: [(f64, DampingModel); 3] = [
    (0.0, DampingModel::Axial),
    (0.3, DampingModel::Axial),
    (0.3, DampingModel::Isotropic),
];

/// A kernel: adds forces to its last argument and returns the dissipated power. Its first asks
/// whether for all of them or for the dampers alone, whose power nobody asks for.
type Kernel<'a> = dyn Fn(bool, &[f64], &[f64], &mut [f64]) -> f64 + 'a;

/// Smaller networks are not cut.
const CUT_FROM: f64 = 16_384.0;

/// The same bits as the plain loop, on top of a force that was there before; the same power but for
/// the order of its sum.
fn as_plain(scene: &Scene, x: &[f64], v: &[f64], kernel: &Kernel) -> Result<(), String> {
    let before: Vec<f64> = x.iter().map(|x| 0.3 * x - 0.1).collect();
    for elastic in [true, false] {
        let (mut wanted, mut found) = (before.clone(), before.clone());
        let power = plain::add(scene, x, v, &mut wanted, elastic, Fault::None);
        let own = kernel(elastic, x, v, &mut found);
        if let Some(at) = differs(&wanted, &found) {
            let (wanted, found) = (wanted[at], found[at]);
            return Err(format!("coordinate {at}: {found} instead of {wanted}"));
        }
        // In parts, m positive terms of about the same size are summed in another order: random
        // roundings would add up to sqrt(m) eps / 2, but the cloth repeats itself and so do they.
        // Measured 6.8e-14 at m = 2e4, where this is 1.2e-13.
        let m = scene.springs.len() as f64;
        let tolerance = if m < CUT_FROM {
            0.0
        } else {
            4.0 * m.sqrt() * f64::EPSILON
        };
        if elastic && power.is_finite() && (own - power).abs() > tolerance * power {
            return Err(format!("{own} W instead of {power} W"));
        }
    }
    Ok(())
}

/// Where two vectors differ in their bits; one NaN is like another.
pub fn differs(a: &[f64], b: &[f64]) -> Option<usize> {
    let same = |(a, b): (&f64, &f64)| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
    a.iter().zip(b).position(|pair| !same(pair))
}

/// The crate's own kernel.
fn own(springs: &Springs) -> impl Fn(bool, &[f64], &[f64], &mut [f64]) -> f64 {
    move |elastic, x, v, f| {
        if !elastic {
            springs.add_damping(x, v, f);
            return 0.0;
        }
        springs.add_force(0.0, x, v, f).dissipated
    }
}

fn start(scene: &Scene) -> (Vec<f64>, Vec<f64>) {
    let state = ParticleSystem::initial_state(scene);
    (state.x, state.v)
}

/// The first springs of a cloth large enough.
fn some_springs(n: usize, springs: usize, damping: f64, model: DampingModel) -> Scene {
    let mut scene = cloth(n, damping, model);
    // Fixed particles would take springs out of the kernel that the plain loop has.
    for particle in &mut scene.particles {
        particle.fixed = false;
    }
    scene.springs.truncate(springs);
    assert_eq!(scene.springs.len(), springs);
    scene
}

#[test]
fn every_size_has_the_bits_of_a_plain_loop() {
    for (damping, model) in MODELS {
        // Around blocks of 16, and around the size from which networks are cut.
        let small = (1..=20).chain(31..=33).chain(47..=49).map(|m| (8, m));
        let large = [16_383, 16_384, 16_385, 16_400].map(|m| (60, m));
        for (n, springs) in small.chain(large) {
            let scene = some_springs(n, springs, damping, model);
            let (x, v) = start(&scene);
            let effect = Springs::new(&scene).expect("springs");
            as_plain(&scene, &x, &v, &own(&effect))
                .unwrap_or_else(|e| panic!("{springs} springs, c = {damping}, {model:?}: {e}"));
        }
        let none = some_springs(8, 0, damping, model);
        assert!(Springs::new(&none).is_none());
    }
}

#[test]
fn every_number_of_threads_has_the_same_bits() {
    for (damping, model) in MODELS {
        let ordered = cloth(58, damping, model);
        let parts = Springs::new(&ordered).expect("springs").parts();
        assert!(parts > 1, "nothing to share");
        for scene in [shuffled(ordered.clone(), 3), ordered] {
            let (x, v) = start(&scene);
            let effect = Springs::new(&scene).expect("springs");
            as_plain(&scene, &x, &v, &own(&effect)).unwrap_or_else(|e| panic!("{model:?}: {e}"));
            let on = |threads: usize| {
                let pool = ThreadPoolBuilder::new().num_threads(threads).build();
                pool.expect("threads").install(|| {
                    let mut f = vec![0.0; x.len()];
                    let power = effect.add_force(0.0, &x, &v, &mut f).dissipated;
                    effect.add_damping(&x, &v, &mut f);
                    (f, power.to_bits())
                })
            };
            let (one, power) = on(1);
            for threads in 2..=4 {
                let (several, theirs) = on(threads);
                assert_eq!(
                    differs(&one, &several),
                    None,
                    "{threads} threads, {model:?}"
                );
                assert_eq!(power, theirs, "{threads} threads, {model:?}");
            }
        }
    }
}

#[test]
fn coincident_ends_and_what_is_not_a_number_stay_where_they_are() {
    for (damping, model) in MODELS {
        let scene = some_springs(8, 100, damping, model);
        let (mut x, v) = start(&scene);
        // Particles 9 and 10 in one place, 20 nowhere, 30 too near for a square to hold it.
        x.copy_within(27..30, 30);
        x[60] = f64::NAN;
        x[61] = f64::INFINITY;
        x.copy_within(93..96, 90);
        x[90] += 1e-170;
        let effect = Springs::new(&scene).expect("springs");
        as_plain(&scene, &x, &v, &own(&effect))
            .unwrap_or_else(|e| panic!("c = {damping}, {model:?}: {e}"));
        let mut f = vec![0.0; x.len()];
        effect.add_force(0.0, &x, &v, &mut f);
        let linked = |p: usize| {
            let mut pairs = scene.springs.iter().map(|s| s.ends);
            pairs.any(|ends| ends.contains(&20) && ends.contains(&p))
        };
        for (p, f) in f.chunks(3).enumerate() {
            assert_eq!(f.iter().any(|f| f.is_nan()), linked(p), "particle {p}");
        }
    }
}

#[test]
fn a_kernel_with_a_fault_is_caught() {
    for (damping, model) in MODELS {
        let scene = some_springs(60, 16_385, damping, model);
        let (x, v) = start(&scene);
        for fault in FAULTS {
            let wrong = |elastic: bool, x: &[f64], v: &[f64], f: &mut [f64]| {
                plain::add(&scene, x, v, f, elastic, fault)
            };
            let law = as_plain(&scene, &x, &v, &wrong);
            assert!(law.is_err(), "{fault:?} passes, c = {damping}, {model:?}");
        }
    }
}
