//! Networks of particles and springs, as scenes built in code.

use crate::scene::{DampingModel, Particle, Scene, Solver, Spring};

/// Three masses on a triangle of springs, hung from a fixed fourth, turning and swinging in
/// 3D: non-linear, smooth, far from collisions, of unequal masses. `damping` goes on every spring,
/// N s/m.
pub fn swinging_triangle(damping: f64, model: DampingModel) -> Scene {
    let particle = |position: [f64; 3], velocity: [f64; 3], mass: f64, fixed: bool| Particle {
        position,
        velocity,
        fixed,
        mass,
        ..Particle::default()
    };
    let spring = |a: usize, b: usize, stiffness: f64, rest_length: f64| Spring {
        ends: [a, b],
        stiffness,
        damping,
        rest_length,
        ..Spring::default()
    };
    Scene {
        name: "swinging triangle".into(),
        solver: Solver {
            method: "rk4".into(),
            timestep: 0.01,
            ..Solver::default()
        },
        duration: 1.0,
        damping_model: model,
        particles: vec![
            particle([0.0, 0.0, 2.0], [0.0; 3], 1.0, true),
            particle([0.1, 0.0, 1.0], [0.3, 0.5, 0.0], 1.0, false),
            particle([0.9, 0.2, 0.4], [0.0, -0.6, 0.4], 0.5, false),
            particle([-0.3, 0.8, 0.3], [-0.4, 0.0, 0.2], 0.8, false),
        ],
        springs: vec![
            spring(0, 1, 40.0, 0.9),
            spring(1, 2, 25.0, 0.8),
            spring(2, 3, 30.0, 1.1),
            spring(3, 1, 20.0, 1.0),
        ],
        ..Scene::default()
    }
}

/// The same without gravity and with nothing fixed: momentum and angular momentum are kept.
pub fn free_triangle(damping: f64, model: DampingModel) -> Scene {
    let mut scene = swinging_triangle(damping, model);
    scene.particles.remove(0);
    scene.springs.remove(0);
    for spring in &mut scene.springs {
        spring.ends = spring.ends.map(|end| end - 1);
    }
    scene.solver.gravity = 0.0;
    scene
}
