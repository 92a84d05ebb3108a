//! One way to a scene: a shipped file, a text, or particles and springs put together in code.

use springcheck::scene::{self, DampingModel, Particle, Scene, Solver, Spring};
use springcheck::verbs::names;
use std::path::{Path, PathBuf};

/// A file below `scenes/`: `oscillator/circle.yml`.
pub fn shipped(path: &str) -> Scene {
    read(&folder("").join(path))
}

/// Every scene of these folders below `scenes/`, sorted by path.
pub fn all_shipped(folders: &[impl AsRef<str>]) -> Vec<Scene> {
    files(folders).iter().map(|path| read(path)).collect()
}

/// The files of [`all_shipped`].
pub fn files(folders: &[impl AsRef<str>]) -> Vec<PathBuf> {
    let entries = folders.iter().flat_map(|name| {
        let entries = std::fs::read_dir(folder(name.as_ref())).expect("a folder");
        entries.map(|entry| entry.expect("an entry").path())
    });
    let mut files: Vec<PathBuf> = entries
        .filter(|path| path.extension().is_some_and(|e| e == "yml"))
        .collect();
    files.sort();
    assert!(files.len() >= folders.len());
    files
}

/// The folders below `scenes/`.
pub fn folders() -> Vec<String> {
    let entries = std::fs::read_dir(folder("")).expect("scenes");
    let names = entries.map(|entry| entry.expect("an entry").file_name());
    let mut names: Vec<String> = names.map(|n| n.into_string().expect("UTF-8")).collect();
    names.sort();
    names
}

/// A folder below `scenes/`.
fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("scenes")
        .join(name)
}

fn read(path: &Path) -> Scene {
    scene::read(path, names()).unwrap_or_else(|error| panic!("{error}"))
}

/// A scene from its text.
pub fn parsed(yaml: &str) -> Scene {
    scene::parse(yaml.as_bytes(), "test.yml", names()).unwrap_or_else(|error| panic!("{error}"))
}

/// Nothing in it and no gravity: 5 s in steps of 1 ms.
pub fn empty() -> Scene {
    Scene {
        name: "a test".into(),
        solver: Solver {
            method: "rk4".into(),
            gravity: 0.0,
            ..Solver::default()
        },
        ..Scene::default()
    }
}

/// At rest, with mass in kg.
pub fn free(position: [f64; 3], mass: f64) -> Particle {
    Particle {
        position,
        mass,
        ..Particle::default()
    }
}

pub fn fixed(position: [f64; 3]) -> Particle {
    Particle {
        fixed: true,
        ..free(position, 1.0)
    }
}

/// Undamped; stiffness in N/m, rest length in m.
pub fn spring(ends: [usize; 2], stiffness: f64, rest_length: f64) -> Spring {
    Spring {
        ends,
        stiffness,
        rest_length,
        ..Spring::default()
    }
}

/// `links` equal masses along x, `spacing` m apart, on springs at rest that begin at a fixed particle.
pub fn chain(links: usize, spacing: f64, mass: f64, stiffness: f64) -> Scene {
    let at = |i: usize| [spacing * i as f64, 0.0, 0.0];
    let masses = (1..=links).map(|i| free(at(i), mass));
    let springs = (0..links).map(|i| spring([i, i + 1], stiffness, spacing));
    Scene {
        particles: std::iter::once(fixed(at(0))).chain(masses).collect(),
        springs: springs.collect(),
        ..empty()
    }
}

/// A unit mass on a spring of rest length 0 at the origin, at rest `amplitude` m along x.
pub fn oscillator(stiffness: f64, amplitude: f64) -> Scene {
    Scene {
        damping_model: DampingModel::Isotropic,
        particles: vec![fixed([0.0; 3]), free([amplitude, 0.0, 0.0], 1.0)],
        springs: vec![spring([0, 1], stiffness, 0.0)],
        ..empty()
    }
}
