//! rapier-converged is linearly implicit Euler without geometric stiffness, at dt / 4.

use super::{apart, build, mutated, ours, scenes, swept, theirs};
use springcheck::physics::ParticleSystem;
use springcheck::scene::{DampingModel, Scene};
use springcheck::solvers::Setting;
use springcheck::solvers::find;

const METHOD: &str = "linearized_implicit_material";

/// Distance over a quarter of a second at dt = 1/120 (or the scene's own step).
fn law(ours_scene: &Scene, theirs_scene: &Scene, pgs: u32) -> f64 {
    let dt = ours_scene.solver.timestep.max(1.0 / 120.0);
    let mut rapier = build(&swept(4, pgs), theirs_scene, dt);
    apart(
        &mut *rapier,
        &mut *ours(ours_scene, METHOD, dt / 4.0),
        4,
        30,
    )
}

/// 120 substeps round by eps each: 2.7e-14 at worst, a tenth of it as a random walk; measured 0 to
/// 4.7e-15.
const TOLERANCE: f64 = 1.2e-14;
/// The sheet's coordinates are a thousand spacings, so what they round to stretches springs by 1e-13
/// of their length: measured 1.7e-13. (The project asks for 1e-11 throughout.)
const SHEET: f64 = 4e-13;

#[test]
fn on_every_mirrored_scene() {
    for scene in scenes::mirrored() {
        let measured = law(&scene, &scene, 64);
        let sheet = scene.particles.len() == 200;
        let tolerance = if sheet { SHEET } else { TOLERANCE };
        assert!(measured < tolerance, "{}: {measured:e}", scene.name);
    }
}

#[test]
fn mutants_fail() {
    let fails = |name: &str, scene: &Scene, mutate: fn(&mut Scene)| {
        let measured = law(&mutated(scene, mutate), scene, 64);
        assert!(measured > 1e-4, "{name}: {measured:e}");
    };
    let mass: fn(&mut Scene) = |s| s.particles.iter_mut().for_each(|p| p.mass = 1.0);
    fails("mass ignored", &scenes::wind(), mass);
    let sign: fn(&mut Scene) = |s| s.springs.iter_mut().for_each(|s| s.damping *= -1.0);
    fails("damping sign", &scenes::course(2), sign);
    fails("damping sign", &scenes::isotropic(), sign);
    let axial: fn(&mut Scene) = |s| s.damping_model = DampingModel::Axial;
    fails("axial for isotropic", &scenes::isotropic(), axial);
    let still: fn(&mut Scene) = |s| s.particles.iter_mut().for_each(|p| p.drag = 0.0);
    fails("no drag", &scenes::drag_and_wind(), still);
    let calm: fn(&mut Scene) = |s| s.wind = None;
    fails("no wind", &scenes::drag_and_wind(), calm);
    let up: fn(&mut Scene) = |s| s.solver.gravity *= -1.0;
    fails("gravity upward", &scenes::course(0), up);
    let one: fn(&mut Scene) = |s| s.solver.gravities.0.truncate(1);
    fails("one gravity of two", &scenes::gravities(), one);
    let unstretched: fn(&mut Scene) = |s| s.springs[0].rest_length *= 1.01;
    fails("rest length", &scenes::course(5), unstretched);
}

/// At one sweep a network is not solved, and at dt instead of dt / n it is another method.
#[test]
fn substep_and_sweeps_matter() {
    let scene = scenes::course(4);
    assert!(law(&scene, &scene, 1) > 1e-6);
    let dt = 1.0 / 120.0;
    let mut rapier = theirs(&scene, "rapier-converged", dt);
    assert!(apart(&mut *rapier, &mut *ours(&scene, METHOD, dt), 1, 30) > 1e-4);
    // With geometric stiffness it is another method still.
    let mut rapier = theirs(&scene, "rapier-converged", dt);
    let mut exact = ours(&scene, "linearized_implicit_at_start", dt / 4.0);
    assert!(apart(&mut *rapier, &mut *exact, 4, 30) > 1e-6);
}

/// Ends in one place and no rest length: no direction, so no reaction in the first substep.
#[test]
fn a_spring_of_no_length_starts_alike() {
    let mut scene = scenes::oscillator(50.0, 1.0, 0.0, 0.0, 0.01);
    scene.particles[1].velocity = [0.3, 0.2, -0.1];
    let measured = law(&scene, &scene, 64);
    assert!(measured < TOLERANCE, "{measured:e}");
}

/// A 2 mm oscillation falls asleep at step 31 unless sleeping is off.
#[test]
fn small_oscillations_stay_awake() {
    let scene = scenes::oscillator(50.0, 1.0, 0.002, 0.0, 1.0 / 60.0);
    let mut rapier = theirs(&scene, "rapier-converged", 1.0 / 60.0);
    let mut twin = ours(&scene, METHOD, 1.0 / 240.0);
    // 1,200 substeps of half a last bit of a motion of 2 mm around 1 m: measured 1.9e-15.
    assert!(apart(&mut *rapier, &mut *twin, 4, 300) < 5e-15);
}

/// A spring without stiffness and damping is no joint: rapier would make it a rigid one.
#[test]
fn a_spring_of_nothing_is_nothing() {
    for damping_model in [DampingModel::Axial, DampingModel::Isotropic] {
        let nothing = mutated(&scenes::course(1), |s| {
            s.springs[0].stiffness = 0.0;
            s.damping_model = damping_model;
        });
        let none = mutated(&nothing, |s| s.springs.clear());
        let (mut a, mut b) = (
            theirs(&nothing, "rapier", 0.01),
            theirs(&none, "rapier", 0.01),
        );
        assert_eq!(apart(&mut *a, &mut *b, 1, 20), 0.0);
    }
}

/// What has no counterpart is said so, with what to do or why.
#[test]
fn the_rest_is_unsupported() {
    let coincident = mutated(&scenes::oscillator(50.0, 1.0, 0.0, 0.0, 0.01), |s| {
        s.springs[0].rest_length = 1.0;
    });
    let faint = mutated(&scenes::course(1), |s| s.springs[0].stiffness = 1e-15);
    let heavy = mutated(&scenes::course(0), |s| s.particles[0].mass = 1e21);
    let slight = mutated(&scenes::drag(), |s| s.particles[2].drag = 1e-18);
    for (scene, words) in [
        (scenes::gravitational(), "no native `gravitational`"),
        (scenes::cubic(), "no native `cubic_springs`"),
        (coincident, "both ends in one place"),
        (faint, "so soft"),
        (heavy, "weighs"),
        (slight, "so small"),
    ] {
        for id in ["rapier", "rapier-converged"] {
            let solver = find(id).expect(id);
            let system = ParticleSystem::new(&scene);
            match solver.start(&scene, &system, &Setting::step(1e-4)) {
                Ok(_) => panic!("{id} takes {words}"),
                Err(e) => assert!(e.reason.contains(words), "{e}"),
            }
        }
    }
}

#[test]
fn springs_between_fixed_particles_are_skipped() {
    let extra = mutated(&scenes::course(4), |s| {
        let mut spring = s.springs[0].clone();
        spring.ends = [0, 1];
        s.springs.push(spring);
    });
    let scene = scenes::course(4);
    let (mut a, mut b) = (
        theirs(&extra, "rapier", 0.01),
        theirs(&scene, "rapier", 0.01),
    );
    assert_eq!(apart(&mut *a, &mut *b, 1, 50), 0.0);
}
