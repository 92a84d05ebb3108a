//! Every method on every shipped scene: named, or said to be the same as others there.

use super::*;
use springcheck::crosscheck;
use springcheck::integrators::REGISTRY;
use springcheck::measure::identify::Sameness;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

fn shipped() -> Vec<PathBuf> {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut files = Vec::new();
    for folder in std::fs::read_dir(scenes).expect("scenes") {
        let folder = folder.expect("an entry").path();
        // On the hard ones few methods last long enough to be named.
        if folder.is_dir() && !folder.ends_with("hard") {
            let entries = std::fs::read_dir(folder).expect("a folder");
            files.extend(entries.map(|e| e.expect("an entry").path()));
        }
    }
    files.retain(|f| f.extension().is_some_and(|e| e == "yml"));
    files.sort();
    assert!(files.len() >= 14);
    files
}

fn read(path: &Path) -> Scene {
    springcheck::scene::read(path, crosscheck::names()).expect("a valid scene")
}

fn course(number: u32) -> Scene {
    let path = format!("scenes/pa1/scene{number:02}.yml");
    read(&Path::new(env!("CARGO_MANIFEST_DIR")).join(path))
}

/// The methods, whole, that a method's rows may follow on a scene; an error if that is not settled.
fn class(scene: &Scene, method: &str) -> Result<BTreeSet<String>, String> {
    let large = scene.particles.len() > 50;
    let rows = run(scene, method, 1, if large { 24 } else { 300 });
    let identity = name_of(scene, &rows, large.then_some(12)).expect("something to replay");
    let mut class: BTreeSet<String> = identity.equivalent.iter().cloned().collect();
    class.insert(identity.method.clone());
    class.retain(|id| integrators::find(id).is_some());
    let settled = match identity.same {
        Sameness::Alone => identity.decisive,
        Sameness::Mathematically => !identity.decisive && !identity.equivalent.is_empty(),
        Sameness::TooCoarse | Sameness::NothingFits => false,
    };
    let whole = identity.substeps == 1 && identity.defect == 0.0;
    if settled && whole && class.contains(method) && identity.mistake.is_none() {
        Ok(class)
    } else {
        Err(format!("{}: {method}: {identity:?}", scene.name))
    }
}

/// The classes are the same whichever of their members made the rows.
#[test]
fn every_method_is_named_on_every_shipped_scene() {
    for path in shipped() {
        let scene = read(&path);
        let classes: Vec<_> = REGISTRY
            .iter()
            .map(|method| class(&scene, method.id).unwrap())
            .collect();
        for (method, own) in REGISTRY.iter().zip(&classes) {
            for (other, theirs) in REGISTRY.iter().zip(&classes) {
                let message = format!("{}: {} and {}", scene.name, method.id, other.id);
                assert_eq!(own.contains(other.id), own == theirs, "{message}");
            }
        }
    }
}

fn set(ids: &str) -> BTreeSet<String> {
    ids.split_whitespace().map(str::to_owned).collect()
}

#[test]
fn on_constant_forces_methods_fall_into_three_classes() {
    let scene = course(0);
    for members in [
        "explicit_euler symplectic_euler_drift_first",
        "symplectic_euler implicit_euler linearized_implicit linearized_implicit_material",
        "midpoint heun ralston velocity_verlet position_verlet rk4 yoshida4 pefrl implicit_midpoint trapezoidal tr_bdf2",
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
            "implicit_euler linearized_implicit linearized_implicit_material",
            "explicit_euler",
            "symplectic_euler",
            "symplectic_euler_drift_first",
            "velocity_verlet",
            "position_verlet",
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
    for method in REGISTRY {
        assert_eq!(class(&course(5), method.id), Ok(set(method.id)));
    }
}
