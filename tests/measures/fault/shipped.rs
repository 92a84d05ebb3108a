//! The scenes that are shipped: what follows its scheme has no fault there either, and what does not
//! has one.

use super::record::{fault_of, question, rows, run, thinned};
use springcheck::crosscheck;
use springcheck::integrators::REGISTRY;
use springcheck::measure::identify::{Candidate, first_fault, identify};
use springcheck::scene::{self, Scene};
use springcheck::system::{ParticleSystem, State};
use springcheck::trajectory::{Precision, Rows};
use std::path::{Path, PathBuf};

fn shipped() -> Vec<Scene> {
    let mut files: Vec<PathBuf> = Vec::new();
    for folder in ["scenes/pa1", "scenes/oscillator"] {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
        let entries = std::fs::read_dir(folder).expect("scenes");
        files.extend(entries.map(|entry| entry.expect("a scene").path()));
    }
    files.sort();
    let read = |file: &PathBuf| scene::read(file, crosscheck::names()).expect("a scene");
    files.iter().map(read).collect()
}

/// The forms a run may come in: precisions, with and without velocities, thinned.
fn forms(scene: &Scene, states: &[State]) -> Vec<Rows> {
    let precisions = [
        Precision::Double,
        Precision::Single,
        Precision::Digits(6),
        Precision::Decimals(4),
    ];
    let mut forms = Vec::new();
    for precision in precisions {
        let all = rows(scene, states, precision);
        forms.push(thinned(&all, 33));
        let mut positions = all.clone();
        positions.v = None;
        forms.extend([all, positions]);
    }
    forms
}

#[test]
fn what_follows_its_scheme_has_no_fault_on_shipped_scenes() {
    for scene in shipped() {
        let system = ParticleSystem::new(&scene);
        // Six hundred coordinates take their time.
        let steps = if scene.particles.len() > 30 { 6 } else { 150 };
        for method in REGISTRY {
            let own = Candidate::method(&system, method, 1);
            let states = run(&scene, steps, |_| &own, |_, _| {});
            for rows in forms(&scene, &states) {
                let fault = fault_of(&scene, &rows, method.id);
                assert_eq!(
                    fault, None,
                    "{} {} {:?}",
                    scene.file, method.id, rows.precision
                );
            }
        }
    }
}

/// From the rows alone: the method is named, and then where it is left.
#[test]
fn the_effects_of_shipped_scenes_are_missed_where_they_are_missing() {
    let at = 60;
    for scene in shipped().iter().filter(|s| s.particles.len() <= 30) {
        let system = ParticleSystem::new(scene);
        for id in ["symplectic_euler", "rk4"] {
            let own = Candidate::method(&system, crate::testkit::method(id), 1);
            for (row, _) in system.effects() {
                let left = |other: &springcheck::effects::EffectRow| {
                    if other.id == row.id { 0.0 } else { 1.0 }
                };
                let without = own.under(&ParticleSystem::scaled(scene, &left));
                let by = |step| if step == at { &without } else { &own };
                let states = run(scene, 100, by, |_, _| {});
                let rows = rows(scene, &states, Precision::Double);
                let question = question(scene, &system, &rows);
                let identity = identify(&question).expect("an identity");
                let fault = first_fault(&question, &identity).expect("a fault");
                assert_eq!(fault.step, at, "{}: {fault:?}", scene.file);
                let says = format!("in this step only: the effect `{}` is missing", row.id);
                assert!(
                    fault.explanation.starts_with(&says),
                    "{}: {fault:?}",
                    scene.file
                );
            }
        }
    }
}
