//! The proof every run repeats: passes on what is the same scene, fails on what is not.

use super::{mutated, scenes};
use springcheck::measure::twin::{prove, prove_pair, prove_user_forces};
use springcheck::measure::{Check, CheckStatus};
use springcheck::scene::{DampingModel, Scene, Spring};

fn show(scene: &Scene, h: f64, proof: &Check) -> String {
    format!("{} at {h}: {proof:?}", scene.name)
}

/// At the scene's own step, at a frame's, and at one where explicit methods are unstable.
#[test]
fn every_scene_passes() {
    for scene in scenes::mirrored() {
        for h in [scene.solver.timestep, 1.0 / 60.0, 0.3] {
            let proofs = prove(&scene, h);
            assert_eq!(
                proofs[0].status,
                CheckStatus::Pass,
                "{}",
                show(&scene, h, &proofs[0])
            );
            assert_eq!(proofs[0].measured, Some(0.0));
            for proof in &proofs {
                // The sheet at 0.3 s needs more sweeps than a proof may spend.
                let hard = scene.particles.len() == 200 && h == 0.3;
                let expected = if hard && proof.id == "twin-joints" {
                    CheckStatus::Inconclusive
                } else {
                    CheckStatus::Pass
                };
                assert_eq!(proof.status, expected, "{}", show(&scene, h, proof));
            }
            assert_eq!(proofs.len() == 3, scene.springs.is_empty());
        }
    }
}

/// Bit for bit at any step, and not with a spring a millionth stiffer or a mass a millionth larger.
#[test]
fn user_forces_are_proved_on_every_scene() {
    for scene in scenes::mirrored() {
        for h in [scene.solver.timestep, 1.0 / 60.0, 0.3] {
            let proof = prove_user_forces(&scene, &scene, h);
            let passed = proof.status == CheckStatus::Pass && proof.measured == Some(0.0);
            assert!(passed, "{}", show(&scene, h, &proof));
        }
        if !scene.springs.is_empty() {
            let h = scene.solver.timestep;
            let heavier = mutated(&scene, |s| {
                s.particles.iter_mut().for_each(|p| p.mass *= 1.000_001);
                s.springs.iter_mut().for_each(|s| s.stiffness *= 1.000_002);
            });
            let proof = prove_user_forces(&scene, &heavier, h);
            assert_eq!(
                proof.status,
                CheckStatus::Fail,
                "{}",
                show(&scene, h, &proof)
            );
        }
    }
}

#[test]
fn what_rapier_lacks_is_skipped_with_its_reason() {
    for (scene, lacks) in [
        (scenes::gravitational(), "gravitational"),
        (scenes::cubic(), "cubic_springs"),
    ] {
        let proofs = prove(&scene, 1e-3);
        let statuses: Vec<_> = proofs.iter().map(|p| p.status).collect();
        assert_eq!(statuses, [CheckStatus::Pass, CheckStatus::Skip]);
        assert!(proofs[1].message.contains(lacks));
    }
}

/// Both proofs of each scene see each mutant, at the scene's own step.
#[test]
fn mutants_fail() {
    type Mutation = fn(&mut Scene);
    let mutants: [(&str, Scene, Mutation); 10] = [
        ("mass", scenes::course(5), |s| {
            s.particles[1].mass *= 1.000_001
        }),
        ("stiffness", scenes::course(6), |s| {
            s.springs[80].stiffness *= 1.001
        }),
        ("damping ignored", scenes::course(6), |s| {
            s.springs.iter_mut().for_each(|s| s.damping = 0.0);
        }),
        ("damping doubled", scenes::course(2), |s| {
            s.springs[0].damping *= 2.0
        }),
        ("damping model", scenes::isotropic(), |s| {
            s.damping_model = DampingModel::Axial
        }),
        ("rest length", scenes::course(1), |s| {
            s.springs[0].rest_length *= 1.000_001
        }),
        ("gravity", scenes::course(0), |s| s.solver.gravity = -9.8),
        ("drag", scenes::drag(), |s| s.particles[3].drag *= 1.001),
        ("air", scenes::moving_air(), |s| {
            s.air.iter_mut().for_each(|air| air.velocity[1] *= 1.001)
        }),
        ("wind", scenes::wind(), |s| s.wind = None),
    ];
    for (name, scene, mutate) in mutants {
        let other = mutated(&scene, mutate);
        for proof in prove_pair(&scene, &other, scene.solver.timestep) {
            assert_eq!(proof.status, CheckStatus::Fail, "{name}: {proof:?}");
        }
    }
}

/// Nothing that rounding does is called a fault: random nets, soft to stiff, stable to exploding,
/// on the origin and far from it.
#[test]
fn no_false_alarm() {
    let mut seed = 7_u64;
    let mut random = move || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 11) as f64 / 2f64.powi(53)
    };
    let (mut passed, mut closest) = (0, 0.0_f64);
    for round in 0..400 {
        let mut scene = scenes::empty(&format!("net {round}"));
        let away = 10_f64.powf(6.0 * random() - 3.0);
        for i in 0..6 {
            let at = [away + random(), random(), random()];
            let mut particle = scenes::free(at, 10_f64.powf(2.0 * random() - 1.0));
            particle.fixed = i == 0;
            particle.drag = if round % 3 == 0 { random() } else { 0.0 };
            scene.particles.push(particle);
        }
        let stiff = 10_f64.powf(7.0 * random());
        for (a, b) in [(0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 0), (1, 4)] {
            scene.springs.push(Spring {
                ends: [a, b],
                stiffness: stiff * random(),
                cubic: 0.0,
                damping: random(),
                rest_length: random(),
            });
        }
        if round % 2 == 0 {
            scene.damping_model = DampingModel::Isotropic;
        }
        let h = 10_f64.powf(-4.0 * random());
        for proof in prove(&scene, h) {
            assert_ne!(
                proof.status,
                CheckStatus::Fail,
                "{}",
                show(&scene, h, &proof)
            );
            if proof.id == "twin-forces" {
                assert_eq!(
                    proof.status,
                    CheckStatus::Pass,
                    "{}",
                    show(&scene, h, &proof)
                );
            } else if proof.status == CheckStatus::Pass {
                passed += 1;
                closest = closest.max(proof.measured.unwrap_or(1.0) / proof.bound.unwrap_or(1.0));
            }
        }
    }
    println!("{passed} of 400 proved; closest to its bound: {closest:.2}");
    // Mostly decided, not excused: 380 of them. (4,000 rounds came no closer than a third.)
    assert!(passed > 360, "{passed}");
}
