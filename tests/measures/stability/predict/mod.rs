//! Predicted limits against formulas, against the integrators themselves, and against each other.

use crate::testkit::mutants::mutant;
use crate::testkit::scenes as kit;
use crate::testkit::{Build, Oscillator, Random, built, method, own};
use springcheck::conformance::measured_limit;
use springcheck::conformance::systems::Across;
use springcheck::integrators::{Amplification, Method, Rational, Stable, fixed};
use springcheck::measure::stability::{Effort, Limit, Linearised, LinearisedTrajectory, is_linear};
use springcheck::physics::{Jacobian, Linearization, Power, State, System};
use springcheck::scene::{Air, DampingModel, Particle, Scene, Spring, Triangle};

mod large;
mod linearised;
mod networks;
mod scenes;
mod table;

fn about(system: &dyn System, x: &[f64]) -> Linearised {
    let state = State::new(x.to_vec(), vec![0.0; x.len()]);
    Linearised::new(system, &state, Effort::FULL)
}

fn of_oscillator(method: &Method, w: f64, zeta: f64) -> Limit {
    about(&Oscillator { w, zeta }, &[0.0])
        .predict(method, 0.01)
        .limit
}

fn start(scene: &Scene) -> Linearised {
    let (system, state) = built(scene);
    Linearised::new(&system, &state, Effort::FULL)
}

fn particle(position: [f64; 3], mass: f64, fixed: bool) -> Particle {
    Particle {
        fixed,
        ..kit::free(position, mass)
    }
}

fn spring(a: usize, b: usize, stiffness: f64, damping: f64, rest_length: f64) -> Spring {
    Spring {
        damping,
        ..kit::spring([a, b], stiffness, rest_length)
    }
}

fn scene(particles: Vec<Particle>, springs: Vec<Spring>, model: DampingModel) -> Scene {
    let mut scene = Scene {
        damping_model: model,
        particles,
        springs,
        ..kit::empty()
    };
    scene.solver.timestep = 0.01;
    scene
}
