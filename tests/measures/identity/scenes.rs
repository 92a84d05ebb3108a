//! Every method on every shipped scene: named, or said to be the same as others there.

use super::*;
use crate::testkit::scenes::{all_shipped, folders, shipped};
use crate::testkit::{is_its_own, part};
use springcheck::integrators::{Method, fixed};
use springcheck::measure::identify::Undecided;
use std::collections::BTreeSet;

fn course(number: u32) -> Scene {
    shipped(&format!("pa1/scene{number:02}.yml"))
}

/// Implicit Euler, solved or stopped after one iterate.
fn iterate(id: &str) -> bool {
    id == "implicit_euler" || id.starts_with("linearized_implicit")
}

/// The methods, whole, that a method's rows may follow on a scene; an error if that is not settled.
fn class(scene: &Scene, method: &str) -> Result<BTreeSet<String>, String> {
    let large = scene.particles.len() > 50;
    let rows = run(scene, method, 1, if large { 24 } else { 300 });
    let identity = name_of(scene, &rows, large.then_some(12)).expect("something to replay");
    let mut class: BTreeSet<String> = identity.equivalent.iter().cloned().collect();
    class.insert(identity.method.clone());
    class.retain(|id| integrators::find(id).is_some());
    let settled = match identity.undecided {
        None => true,
        Some(Undecided::SameMap) => !identity.equivalent.is_empty(),
        // The first Newton iterate can be within the tolerance of the solution, and Boris' dampers are off from the exact
        // ones by (c h)³/12 of the velocity, which weak ones hide.
        Some(Undecided::DataTooCoarse) => {
            class.iter().all(|id| iterate(id)) || class == set("position_verlet boris")
        }
        Some(Undecided::Near) => false,
    };
    // The simplest of the class is named, and rounds otherwise than its equals: measured up to 1.
    let whole = identity.substeps == 1 && identity.defect <= 3.0;
    if settled && whole && class.contains(method) && !identity.mistake {
        Ok(class)
    } else {
        Err(format!("{}: {method}: {identity:?}", scene.name))
    }
}

/// The classes are the same whichever of their members made the rows.
#[test]
fn every_method_is_named_on_every_shipped_scene() {
    // On the hard ones few methods last long enough to be named.
    let mut folders = folders();
    folders.retain(|folder| folder != "hard");
    // Nor does a motion that is over after a few steps, or none at all, tell one from another.
    let over = [
        "sail.yml",
        "test_equation_smooth.yml",
        "test_equation_beyond.yml",
        "pulled_straight.yml",
    ];
    // Whether a spring is beyond its limit may hang on a rounding, in which methods of one map differ; and so may what
    // touches an obstacle.
    let lasts = |scene: &Scene| {
        let steady = scene.strain_limit.is_none() && scene.colliders.is_empty();
        steady && !over.iter().any(|file| scene.file.ends_with(file))
    };
    let scenes = all_shipped(&folders).into_iter().filter(lasts);
    for (at, scene) in scenes.enumerate() {
        let scene = &scene;
        let mut methods = part(fixed(), 3, at);
        methods.retain(|method| is_its_own(scene, method));
        let classes: Vec<_> = methods
            .iter()
            .map(|method| class(scene, method.id).unwrap())
            .collect();
        for (method, own) in methods.iter().zip(&classes) {
            for (other, theirs) in methods.iter().zip(&classes) {
                let message = format!("{}: {} and {}", scene.name, method.id, other.id);
                let iterates = iterate(method.id) && iterate(other.id);
                assert!(
                    iterates
                        || weak(method.id, other.id)
                        || own.contains(other.id) == (own == theirs),
                    "{message}"
                );
            }
        }
    }
}

/// Boris and what it is like: position Verlet where dampers are weak, and in a field alone the methods of its rotation,
/// which are solved to a tolerance.
fn weak(method: &str, other: &str) -> bool {
    let like = [
        "position_verlet",
        "boris",
        "implicit_midpoint",
        "trapezoidal",
    ];
    let pair = [method, other];
    pair.contains(&"boris") && pair.iter().all(|id| like.contains(id))
}

fn set(ids: &str) -> BTreeSet<String> {
    ids.split_whitespace().map(str::to_owned).collect()
}

#[test]
fn on_constant_forces_methods_fall_into_three_classes() {
    let scene = course(0);
    for members in [
        "explicit_euler symplectic_euler_drift_first",
        "symplectic_euler implicit_euler linearized_implicit_predicted linearized_implicit_at_start linearized_implicit_material",
        "midpoint heun ralston velocity_verlet position_verlet rk3 ssprk3 rk4 yoshida4 pefrl implicit_midpoint trapezoidal tr_bdf2",
    ] {
        for method in members.split_whitespace() {
            assert_eq!(class(&scene, method), Ok(set(members)), "{method}");
        }
    }
}

/// A spring in line is linear: explicit methods of order two are one, implicit ones need no second
/// iteration, and nothing turns.
#[test]
fn on_linear_forces_some_methods_are_one() {
    for number in [1, 2] {
        let scene = course(number);
        for members in [
            "midpoint heun ralston",
            "implicit_midpoint trapezoidal",
            "implicit_euler linearized_implicit_predicted linearized_implicit_at_start linearized_implicit_material",
            "explicit_euler",
            "symplectic_euler",
            "symplectic_euler_drift_first",
            "velocity_verlet",
            "position_verlet",
            "rk3 ssprk3",
            "rk4",
            "yoshida4",
            "pefrl",
            "tr_bdf2",
        ] {
            for method in members.split_whitespace() {
                assert_eq!(class(&scene, method), Ok(set(members)), "{method}");
            }
        }
    }
    // A spring that turns is not linear: all are told apart.
    let own = |method: &&Method| is_its_own(&course(5), method);
    for method in fixed().iter().filter(own) {
        let class = class(&course(5), method.id).unwrap();
        let alone = class == set(method.id);
        assert!(alone || class.iter().all(|id| iterate(id)), "{class:?}");
    }
}
