//! What rapier computes, named.

use super::*;
use crate::testkit::swinging_triangle;
use springcheck::measure::identify::Undecided;
use springcheck::scene::DampingModel;
use springcheck::solvers::{Setting, Solver, find, rapier::RapierSettings};

fn of(row: &Solver, scene: &Scene) -> Identity {
    let h = scene.solver.timestep;
    let system = ParticleSystem::new(scene);
    let mut engine = row
        .engine(scene, &system, &Setting::step(h))
        .expect("supported");
    let rows = record(engine.as_mut(), h, 200);
    let found = identify(&Question {
        scene,
        system: &system,
        rows: &rows,
        settings: Settings::default(),
        transitions: None,
        budget: u64::MAX,
        hint: row.law(scene),
    });
    found.identity.expect("a scheme")
}

fn engine_row(id: &str) -> Solver {
    find(id).expect("an engine")
}

/// Particle 1 on its spring below the anchor, let go in line.
fn one_spring(damping: f64, model: DampingModel) -> Scene {
    let mut scene = swinging_triangle(damping, model);
    scene.particles.truncate(2);
    scene.springs.truncate(1);
    scene.particles[1].position = [0.0, 0.0, 1.0];
    scene.particles[1].velocity = [0.0; 3];
    scene
}

#[test]
fn its_free_fall_is_symplectic_euler_in_four_substeps() {
    let mut scene = swinging_triangle(0.0, DampingModel::Axial);
    scene.springs.clear();
    let identity = of(&engine_row("rapier"), &scene);
    assert_eq!(
        (identity.method.as_str(), identity.substeps),
        ("symplectic_euler", 4)
    );
    // rapier keeps masses as inverses: a rounding more at most.
    assert!(identity.defect <= 1.0, "{identity:?}");
}

/// The law holds however many fall.
#[test]
fn forty_bodies_fall_as_one() {
    let text = include_str!("../../program/cases/fall_40.yml");
    let scene = crate::testkit::scenes::parsed(text);
    let identity = of(&engine_row("rapier"), &scene);
    assert_eq!(
        (identity.method.as_str(), identity.substeps),
        ("symplectic_euler", 4)
    );
    assert_eq!(identity.undecided, None, "{identity:?}");
}

/// On one spring in line, which is linear and does not turn, that is implicit Euler.
#[test]
fn its_joint_in_line_is_implicit_euler_in_four_substeps() {
    for damping in [0.0, 0.7] {
        let scene = one_spring(damping, DampingModel::Axial);
        let identity = of(&engine_row("rapier"), &scene);
        assert_eq!(
            (identity.method.as_str(), identity.substeps),
            ("linearized_implicit_material", 4)
        );
        assert!(identity.defect <= 3.0, "{identity:?}");
        let h = scene.solver.timestep;
        let system = ParticleSystem::new(&scene);
        let mut engine = engine_row("rapier")
            .engine(&scene, &system, &Setting::step(h))
            .expect("supported");
        let identity = name(&scene, &record(engine.as_mut(), h, 200));
        assert_eq!(
            (identity.method.as_str(), identity.substeps),
            ("implicit_euler", 4)
        );
    }
}

#[test]
fn its_converged_network_is_linearly_implicit_without_geometric_stiffness() {
    for damping in [0.0, 0.7] {
        for model in [DampingModel::Axial, DampingModel::Isotropic] {
            let scene = swinging_triangle(damping, model);
            let identity = of(&engine_row("rapier-converged"), &scene);
            let name = (identity.method.as_str(), identity.substeps);
            assert_eq!(name, ("linearized_implicit_material", 4));
            assert!(
                identity.decisive && identity.undecided.is_none(),
                "{identity:?}"
            );
            // Another order of operations and other masses; measured 1.0 to 3.4.
            assert!(identity.defect <= 8.0, "{identity:?}");
            assert_eq!(identity.followed, identity.transitions);
            // One sweep is not converged, and is not said to be.
            let identity = of(&engine_row("rapier"), &scene);
            assert_eq!(identity.undecided, Some(Undecided::Near), "{identity:?}");
        }
    }
}

/// Sweeps that stop a little early: beyond rounding, but nothing else is near.
#[test]
fn its_nearly_converged_network_is_named_with_a_remark() {
    let scene = swinging_triangle(0.7, DampingModel::Isotropic);
    let row = Solver::rapier(RapierSettings {
        pgs: 4,
        ..RapierSettings::CONVERGED
    });
    let identity = of(&row, &scene);
    assert_eq!(identity.method, "linearized_implicit_material");
    assert_eq!(
        (identity.substeps, identity.undecided),
        (4, Some(Undecided::Near))
    );
    assert!(identity.relative < Some(1e-3), "{identity:?}");
}

#[test]
fn rapier_forces_is_symplectic_euler() {
    let scene = swinging_triangle(0.7, DampingModel::Axial);
    let identity = of(&engine_row("rapier-forces"), &scene);
    assert_eq!(
        (identity.method.as_str(), identity.substeps),
        ("symplectic_euler", 1)
    );
    assert!(identity.decisive && identity.defect == 0.0, "{identity:?}");
}
