//! Every method in substeps, on a motion where no two are the same.

use super::*;
use crate::testkit::{is_its_own, part, swinging_triangle};
use springcheck::integrators::fixed;
use springcheck::measure::identify::Undecided;
use springcheck::scene::DampingModel;
use springcheck::solvers::{Limits, Setting, find};
use springcheck::trajectory::Recorder;

/// Named, decisively, and followed throughout.
fn names(scene: &Scene, rows: &Rows, method: &str, substeps: u32) -> Result<Identity, String> {
    let identity = name_of(scene, rows, None).ok_or("no scheme")?;
    let right = identity.method == method
        && identity.substeps == substeps
        && identity.decisive
        && identity.equivalent.is_empty()
        && identity.undecided.is_none()
        && !identity.mistake
        && identity.followed == identity.transitions;
    if right {
        Ok(identity)
    } else {
        Err(format!("{method}/{substeps} is taken for {identity:?}"))
    }
}

#[test]
fn every_method_is_named_in_any_substeps_to_the_last_bit() {
    for (damping, several) in [(0.0, [1, 3, 8]), (0.7, [1, 4, 16])] {
        let scene = swinging_triangle(damping, DampingModel::Axial);
        let own = fixed().iter().filter(|method| is_its_own(&scene, method));
        for (at, method) in own.enumerate() {
            for &substeps in part(&several, 3, at) {
                let rows = run(&scene, method.id, substeps, 60);
                let identity = names(&scene, &rows, method.id, substeps).unwrap();
                // The same operations on the same bits.
                assert_eq!(identity.defect, 0.0, "{identity:?}");
            }
            // A tenth of gravity more is no longer that method.
            let mut heavier = scene.clone();
            heavier.solver.gravity *= 1.1;
            assert!(names(&heavier, &run(&scene, method.id, 1, 60), method.id, 1).is_err());
        }
    }
}

/// Each number one last bit up, down or as it is.
fn other_bits(rows: &Rows) -> Rows {
    let mut rows = rows.clone();
    let mut random = crate::testkit::Random(7);
    let v = rows.v.as_mut().expect("velocities");
    for c in rows.x.iter_mut().chain(v) {
        *c *= 1.0 + f64::EPSILON * (1.5 * random.next()).round();
    }
    rows
}

/// A program that rounds otherwise follows the same method.
#[test]
fn other_last_bits_are_the_same_method() {
    let mut worst = 0.0_f64;
    for damping in [0.0, 0.7] {
        let scene = swinging_triangle(damping, DampingModel::Isotropic);
        for method in fixed().iter().filter(|method| is_its_own(&scene, method)) {
            for substeps in [1, 2] {
                let rows = other_bits(&run(&scene, method.id, substeps, 100));
                let identity = names(&scene, &rows, method.id, substeps).unwrap();
                worst = worst.max(identity.defect);
            }
        }
    }
    // Two last bits at both ends, where the unit holds as many roundings of the step besides; measured 1.6. Beyond
    // 16 it would not be followed.
    assert!((0.8..=4.0).contains(&worst), "{worst}");
}

#[test]
fn rows_may_lie_unevenly_apart() {
    let mut scene = swinging_triangle(0.7, DampingModel::Axial);
    scene.solver.timestep = 5e-4;
    for method in fixed().iter().filter(|method| is_its_own(&scene, method)) {
        let all = run(&scene, method.id, 1, 400);
        // 60 rows a second.
        let steps: Vec<u64> = (0..12).map(|k| (k * 100_u64).div_ceil(3)).collect();
        assert_eq!(&steps[..4], &[0, 34, 67, 100]);
        let pick = |values: &[f64]| -> Vec<f64> {
            let row = |&k: &u64| &values[k as usize * all.dim..][..all.dim];
            steps.iter().flat_map(row).copied().collect()
        };
        let rows = Rows {
            x: pick(&all.x),
            v: all.v.as_deref().map(pick),
            steps,
            ..all.clone()
        };
        names(&scene, &rows, method.id, 1).unwrap();
    }
}

#[test]
fn a_thinned_record_replays_in_pairs() {
    let scene = swinging_triangle(0.0, DampingModel::Axial);
    let steps = 9_000;
    let system = ParticleSystem::new(&scene);
    let (heun, timestep) = (find("heun").expect("a method"), 1e-3);
    let setting = Setting::Steps { timestep, steps };
    let run = heun.start(&scene, &system, &setting);
    let mut recorder = Recorder::new(steps, 12, timestep);
    let limits = Limits::new(system, None);
    run.expect("a run").finish(&limits, &mut recorder, &|_| {});
    let rows = recorder.finish().rows().clone();
    let identity = names(&scene, &rows, "heun", 1).unwrap();
    // One for each instant but the last; none of the long ones between.
    let instants = 9_000 / 5;
    assert_eq!(identity.transitions, instants);
    let some = name_of(&scene, &rows, Some(16)).expect("something");
    assert_eq!((some.transitions, some.method.as_str()), (16, "heun"));
}

#[test]
fn a_bad_step_does_not_change_the_name() {
    let scene = swinging_triangle(0.7, DampingModel::Axial);
    for bad in [0, 50, 98] {
        let mut rows = run(&scene, "velocity_verlet", 1, 100);
        // From here on another motion, of the same method.
        let mut shifted = scene.clone();
        for (i, particle) in shifted.particles.iter_mut().enumerate() {
            let at = (bad + 1) * rows.dim + 3 * i;
            particle.position.copy_from_slice(&rows.x[at..at + 3]);
            if !particle.fixed {
                let v = &rows.v.as_ref().expect("velocities")[at..at + 3];
                particle.velocity.copy_from_slice(v);
                particle.velocity[0] += 0.01;
            }
        }
        let rest = run(&shifted, "velocity_verlet", 1, 99 - bad as u64);
        rows.x.truncate((bad + 1) * rows.dim);
        rows.x.extend(rest.x);
        let v = rows.v.as_mut().expect("velocities");
        v.truncate((bad + 1) * rows.dim);
        v.extend(rest.v.expect("velocities"));
        let identity = name(&scene, &rows);
        assert!(identity.decisive, "{identity:?}");
        assert_eq!(identity.method, "velocity_verlet");
        assert_eq!((identity.followed, identity.transitions), (99, 100));
        assert_eq!(identity.defect, 0.0);
    }
}

#[test]
fn a_hint_names_among_equals_and_never_else() {
    let mut scene = swinging_triangle(0.0, DampingModel::Axial);
    scene.springs.clear();
    let system = ParticleSystem::new(&scene);
    let rows = run(&scene, "rk4", 1, 50);
    let ask = |hint| {
        identify(&Question {
            scene: &scene,
            system: &system,
            rows: &rows,
            settings: Settings::default(),
            budget: u64::MAX,
            transitions: None,
            hint,
        })
        .identity
        .expect("an answer")
    };
    for hint in ["heun", "pefrl", "trapezoidal"] {
        let identity = ask(Some((hint, 1)));
        assert_eq!(identity.method, hint);
        assert!(!identity.equivalent.contains(&hint.to_owned()));
        assert!(!identity.decisive && identity.undecided == Some(Undecided::SameMap));
    }
    assert_ne!(ask(Some(("explicit_euler", 1))).method, "explicit_euler");
}

#[test]
fn the_same_on_any_number_of_threads() {
    let scene = swinging_triangle(0.7, DampingModel::Axial);
    let rows = run(&scene, "trapezoidal", 3, 150);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("a pool")
            .install(|| name(&scene, &other_bits(&rows)))
    };
    assert_eq!(on(1), on(4));
}
