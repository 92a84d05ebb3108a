//! The scenes that are shipped: what follows its scheme has no fault there either, and what does not
//! has one.

use super::record::{fault_of, question, rows, run, thinned};
use crate::testkit::part;
use crate::testkit::scenes::all_shipped;
use springcheck::integrators::fixed;
use springcheck::measure::identify::{Candidate, first_fault, identify};
use springcheck::physics::{ParticleSystem, State};
use springcheck::scene::Scene;
use springcheck::trajectory::{Precision, Rows};

fn shipped() -> Vec<Scene> {
    all_shipped(&["pa1", "oscillator"])
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
    for (number, scene) in shipped().into_iter().enumerate() {
        let system = ParticleSystem::new(&scene);
        // Six hundred coordinates take their time.
        let steps = if scene.particles.len() > 30 { 6 } else { 150 };
        for (at, method) in fixed().iter().enumerate() {
            let own = Candidate::method(&system, method, 1);
            let states = run(&scene, steps, |_| &own, |_, _| {});
            for rows in part(&forms(&scene, &states), 3, at + number) {
                let fault = fault_of(&scene, rows, method.id);
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
                let left = |other: &springcheck::physics::effects::EffectRow| {
                    if other.id == row.id { 0.0 } else { 1.0 }
                };
                let without = own.under(&ParticleSystem::scaled(scene, &left));
                let by = |step| if step == at { &without } else { &own };
                let states = run(scene, 100, by, |_, _| {});
                let rows = rows(scene, &states, Precision::Double);
                let question = question(scene, &system, &rows);
                let identity = identify(&question).identity.expect("an identity");
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
