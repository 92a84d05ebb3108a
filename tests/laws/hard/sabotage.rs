//! Each scene has been seen to fail: a broken integrator runs in the place of a sound one, under its
//! name, and must not do what is expected of it.

mod a;
mod b;
mod c;
mod contact;
mod rods;

use super::{each_scene, scenes, truths::remembering};
use crate::testkit::mutants::{self, Step, mutant};
use springcheck::measure::CheckStatus;
use springcheck::scene::Scene;
use springcheck::solvers::Solver;
use springcheck::verbs::run::{Choice, Plan, expect};

/// Scene (a file's stem), whom it replaces, and what runs instead.
type Row = (&'static str, &'static str, Step);

const SABOTAGES: &[Row] = &[
    (
        "mass_ratio",
        "velocity_verlet",
        mutants::verlet_with_a_stale_force,
    ),
    (
        "mass_ratio",
        "symplectic_euler",
        mutants::euler_drifting_with_the_old_velocity,
    ),
    ("mass_ratio", "rk4", mutants::rk4_with_a_wrong_weight),
    (
        "mass_ratio",
        "explicit_euler",
        mutants::euler_drifting_with_the_new_velocity,
    ),
];

fn rows() -> impl Iterator<Item = &'static Row> {
    let scenes = SABOTAGES.iter();
    scenes
        .chain(a::SABOTAGES)
        .chain(b::SABOTAGES)
        .chain(c::SABOTAGES)
        .chain(rods::SABOTAGES)
        .chain(contact::SABOTAGES)
}

/// The expectations of this engine that `step` does not meet when it runs as it.
fn unmet(scene: &Scene, engine: &str, step: Step) -> usize {
    let nobody = Choice {
        solvers: vec![Solver::own(engine, mutant(step))],
        ..Choice::expected(scene)
    };
    let plan = Plan::new(scene, &nobody);
    let report = plan.execute(remembering()).expect("no files");
    let checks = expect::check(scene, &report);
    let failed = |status| status == CheckStatus::Fail;
    checks.iter().filter(|check| failed(check.status)).count()
}

/// And it is the fault that is seen: a step of the same making without one passes for the method it is.
#[test]
fn sabotage_is_seen() {
    each_scene(|stem, scene| {
        let rows: Vec<_> = rows().filter(|row| row.0 == stem).collect();
        if rows.is_empty() {
            return vec!["no sabotage of it is listed".to_owned()];
        }
        let unseen = rows
            .iter()
            .filter(|(_, engine, step)| unmet(scene, engine, *step) == 0);
        let sound = unmet(
            scene,
            "symplectic_euler",
            mutants::physics::symplectic_euler,
        );
        let missed = format!("a sound symplectic Euler misses {sound} expectations");
        unseen
            .map(|(_, engine, _)| format!("the broken integrator in place of {engine} passes"))
            .chain((sound > 0).then_some(missed))
            .collect()
    });
}

#[test]
fn every_sabotage_has_its_scene() {
    let known = scenes();
    for (stem, engine, _) in rows() {
        let scene = known.iter().find(|(known, _)| known == stem);
        let (_, scene) = scene.unwrap_or_else(|| panic!("no scene {stem}"));
        assert!(
            !scene.expected_of(engine, true).is_empty(),
            "{stem} {engine}"
        );
    }
}
