//! The scenes the twins are proved on, built in code: the course's seven, and one per effect.

use crate::testkit::scenes::{self, all_shipped, shipped, spring};
pub use crate::testkit::scenes::{fixed, free};
use springcheck::scene::{
    DampingModel, GravitationalPair, Scene, SolverSpec, Spring, Vectors, Wind,
};

/// Nothing in it: gravity along z, a step of 5e-4 s, one second.
pub fn empty(name: &str) -> Scene {
    Scene {
        name: name.to_owned(),
        solver: SolverSpec {
            method: "symplectic_euler".to_owned(),
            timestep: 5e-4,
            ..SolverSpec::default()
        },
        duration: 1.0,
        ..scenes::empty()
    }
}

/// The course's scene of this number, 0 to 6.
pub fn course(number: usize) -> Scene {
    shipped(&format!("pa1/scene{number:02}.yml"))
}

/// One mass on one spring along x, without gravity; displaced by `amplitude`.
pub fn oscillator(k: f64, m: f64, amplitude: f64, rest_length: f64, timestep: f64) -> Scene {
    let mut scene = empty("oscillator");
    scene.solver.gravity = 0.0;
    scene.solver.timestep = timestep;
    scene.particles = vec![fixed([0.; 3]), free([rest_length + amplitude, 0., 0.], m)];
    scene.springs = vec![spring([0, 1], k, rest_length)];
    scene
}

/// A hanging net whose particles all move, so that every effect has something to act on.
pub fn lively(name: &str) -> Scene {
    let mut scene = course(4);
    scene.name = name.to_owned();
    for (i, particle) in scene.particles.iter_mut().enumerate().skip(2) {
        let i = i as f64;
        particle.mass = 0.07 * i;
        particle.velocity = [i.sin(), (2. * i).cos(), (3. * i).sin()];
    }
    scene
}

pub fn drag() -> Scene {
    let mut scene = lively("drag");
    scene.particles.iter_mut().for_each(|p| p.drag = 0.3);
    scene
}

pub fn wind() -> Scene {
    let mut scene = lively("wind");
    scene.wind = Some(Wind {
        direction: [0.6, 0.0, 0.8],
        strength: 2.0,
    });
    scene
}

/// Gravity of two vectors, along no axis.
pub fn gravities() -> Scene {
    let mut scene = lively("gravities");
    scene.solver.gravity = 0.0;
    scene.solver.gravities = Vectors(vec![[0.0, 0.0, -9.81], [3.0, -2.0, 1.0]]);
    scene
}

pub fn drag_and_wind() -> Scene {
    Scene {
        name: "drag and wind".to_owned(),
        wind: wind().wind,
        ..drag()
    }
}

pub fn isotropic() -> Scene {
    Scene {
        name: "isotropic damping".to_owned(),
        damping_model: DampingModel::Isotropic,
        springs: lively("")
            .springs
            .into_iter()
            .map(|s| Spring { damping: 0.4, ..s })
            .collect(),
        ..lively("")
    }
}

pub fn gravitational() -> Scene {
    let mut scene = lively("gravitational");
    scene.gravitational = vec![GravitationalPair {
        ends: [2, 3],
        g: 10.0,
    }];
    scene
}

/// Springs that stiffen, one of them without a linear part.
pub fn cubic() -> Scene {
    let mut scene = lively("cubic");
    scene.springs.iter_mut().for_each(|s| s.cubic = 40.0);
    scene.springs[1].stiffness = 0.0;
    scene.springs[1].damping = 0.0;
    scene
}

/// Every shipped scene, and everything rapier has counterparts of, one scene each.
pub fn mirrored() -> Vec<Scene> {
    let stiff = Scene {
        name: "unstable".to_owned(),
        // h w = 2.12: symplectic Euler grows.
        ..oscillator(50., 1., 0.5, 0.5, 0.3)
    };
    let mut scenes = all_shipped(&["pa1", "oscillator"]);
    assert!(scenes.len() >= 14);
    scenes.extend([
        stiff,
        isotropic(),
        gravities(),
        drag(),
        wind(),
        drag_and_wind(),
    ]);
    scenes
}
