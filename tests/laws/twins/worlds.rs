//! What rapier computes: closed forms of the schemes it runs, and what its worlds depend on. Numbers
//! published elsewhere are in `tests/golden.rs`.

use super::{apart, build, mutated, ours, scenes, theirs};
use springcheck::scene::Scene;
use springcheck::solvers::SolverKind;
use springcheck::solvers::rapier::{IDS, RapierSettings};
use springcheck::solvers::{Solver, catalogue, find};

/// Symplectic Euler at h = dt / n falls g h² N (N + 1) / 2 in N substeps from rest.
#[test]
fn free_fall_travels_what_symplectic_euler_does() {
    let (dt, steps) = (0.01, 100);
    for n in [1, 3, 4, 8] {
        let scene = scenes::course(0);
        let settings = RapierSettings {
            iterations: n,
            ..RapierSettings::DEFAULT
        };
        let mut engine = build(&Solver::rapier(settings), &scene, dt);
        let h = dt / f64::from(n);
        let mut twin = ours(&scene, "symplectic_euler", h);
        let many = f64::from(steps * n);
        // Bit for bit at this mass: m g / m happens to round back to g, and the rest is the same
        // operations.
        assert_eq!(apart(&mut *engine, &mut *twin, n, steps), 0.0, "n = {n}");

        let fallen = 3.0 - engine.state().x[2];
        let law = |many: f64| 9.81 * h * h * many * (many + 1.0) / 2.0;
        // Every substep rounds v and x: eps N at worst.
        assert!((fallen / law(many) - 1.0).abs() < f64::EPSILON * many);
        // Explicit Euler falls one substep's worth less, and one step of dt is not n of dt / n.
        assert!((fallen / law(many - 1.0) - 1.0).abs() > 1.0 / many);
        let mut coarse = ours(&scene, "symplectic_euler", dt);
        let mut engine = build(&Solver::rapier(settings), &scene, dt);
        assert!(n == 1 || apart(&mut *engine, &mut *coarse, 1, steps) > 1e-3);
    }
}

/// Along the scene's own axis, and signed.
#[test]
fn gravity_acts_along_up() {
    use springcheck::scene::Axis;
    for up in [Axis::X, Axis::Y, Axis::Z] {
        let scene = mutated(&scenes::course(0), |s| s.up = up);
        let mut engine = theirs(&scene, "rapier", 0.01);
        engine.step().expect("a step");
        let v = &engine.state().v;
        assert!((v[up.index()] + 0.0981).abs() < 1e-15);
        assert_eq!(v.iter().filter(|v| **v == 0.0).count(), 2);
    }
}

/// The same scene and step, the same bits: nothing in a world depends on another run.
#[test]
fn reruns_are_bitwise_equal() {
    for scene in [scenes::course(4), scenes::course(6), scenes::isotropic()] {
        for id in ["rapier", "rapier-forces"] {
            let (mut a, mut b) = (theirs(&scene, id, 5e-4), theirs(&scene, id, 5e-4));
            assert_eq!(apart(&mut *a, &mut *b, 1, 200), 0.0, "{id}, {}", scene.name);
            assert_eq!(a.state(), b.state());
        }
    }
}

/// Unconverged sweeps depend on the order of the springs in the file; converged ones do not, and
/// which end is named first never matters.
#[test]
fn the_order_of_springs_matters_until_the_sweeps_converge() {
    let scene = scenes::course(4);
    let difference = |id, mutate: fn(&mut Scene)| {
        let other = mutated(&scene, mutate);
        let (mut a, mut b) = (theirs(&scene, id, 0.01), theirs(&other, id, 0.01));
        apart(&mut *a, &mut *b, 1, 100)
    };
    // Measured 6.7e-6 and 2.8e-15: 400 substeps at eps and a little growth.
    assert!(difference("rapier", |s| s.springs.reverse()) > 1e-6);
    assert!(difference("rapier-converged", |s| s.springs.reverse()) < 7e-15);
    let swap: fn(&mut Scene) = |s| s.springs.iter_mut().for_each(|s| s.ends.reverse());
    assert_eq!(difference("rapier", swap), 0.0);
}

/// Rows are named once, and what they say of themselves is what they do.
#[test]
fn the_registry_is_consistent() {
    let rapier = catalogue().filter(|solver| solver.kind == SolverKind::Rapier);
    let ids: Vec<_> = rapier.map(|solver| solver.id).collect();
    assert_eq!(
        ids,
        [
            "rapier",
            "rapier-forces",
            "rapier-converged",
            "rapier-user-forces",
            "rapier_contact"
        ]
    );
    assert_eq!(ids, IDS);
    assert_eq!(find("rapier").map(|row| row.substeps), Some(4));
    assert_eq!(find("rapier-forces").map(|row| row.substeps), Some(1));
    let custom = Solver::rapier(RapierSettings::CONVERGED);
    assert_eq!(custom.id, "rapier(pgs=64,stabilization=0)");
    assert_eq!(
        Solver::rapier(RapierSettings::DEFAULT).id,
        "rapier(defaults)"
    );
}
