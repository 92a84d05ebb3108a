//! What a scene's motion depends on, as one number.

use super::{BUDGET, VERSION};
use crate::scene::{Axis, DampingModel, GravitationalPair, Particle, Scene, Solver, Spring, Wind};
use sha2::{Digest, Sha256};

/// The SHA-256 of everything that decides the motion and its reference up to `until`, s, as lower-case
/// hexadecimal digits: equal for equal motions whatever they are called and however they are stepped.
///
/// Numbers count by their bits, so -0 is not 0: a motion computed twice, never a wrong one.
pub fn key(scene: &Scene, until: f64) -> String {
    // Every field is named, here and below, so that none can be forgotten.
    let Scene {
        name: _,
        description: _,
        file: _,
        solver,
        duration: _,
        up,
        damping_model,
        plot: _,
        particles,
        springs,
        gravitational,
        wind,
        expect: _,
    } = scene;
    let Solver {
        method: _,
        timestep: _,
        gravity,
        tolerance: _,
    } = solver;
    let mut content = Content(Sha256::new());
    content.integers([u64::from(VERSION), BUDGET]);
    content.numbers([until, *gravity]);
    content.integers([match up {
        Axis::X => 0,
        Axis::Y => 1,
        Axis::Z => 2,
    }]);
    content.integers([match damping_model {
        DampingModel::Axial => 0,
        DampingModel::Isotropic => 1,
    }]);
    content.length(particles.len());
    for particle in particles {
        let Particle {
            position,
            velocity,
            fixed,
            mass,
            radius: _,
            drag,
        } = particle;
        content.numbers(*position);
        content.numbers(*velocity);
        content.integers([u64::from(*fixed)]);
        content.numbers([*mass, *drag]);
    }
    content.length(springs.len());
    for spring in springs {
        let Spring {
            ends,
            stiffness,
            cubic,
            damping,
            rest_length,
        } = spring;
        content.integers(ends.map(|end| end as u64));
        content.numbers([*stiffness, *cubic, *damping, *rest_length]);
    }
    content.length(gravitational.len());
    for pair in gravitational {
        let GravitationalPair { ends, g } = pair;
        content.integers(ends.map(|end| end as u64));
        content.numbers([*g]);
    }
    content.length(wind.iter().len());
    if let Some(Wind {
        direction,
        strength,
    }) = wind
    {
        content.numbers(*direction);
        content.numbers([*strength]);
    }
    hexadecimal(&content.0.finalize())
}

/// Digits of bytes, high half first.
fn hexadecimal(bytes: &[u8]) -> String {
    let digit = |half: u8| char::from_digit(u32::from(half), 16).unwrap_or('0');
    let digits = bytes.iter().flat_map(|byte| [byte >> 4, byte & 15]);
    digits.map(digit).collect()
}

/// A hash fed with numbers of eight bytes each; lists are preceded by their length.
struct Content(Sha256);

impl Content {
    fn integers<const N: usize>(&mut self, values: [u64; N]) {
        for value in values {
            self.0.update(value.to_le_bytes());
        }
    }

    fn numbers<const N: usize>(&mut self, values: [f64; N]) {
        self.integers(values.map(f64::to_bits));
    }

    fn length(&mut self, items: usize) {
        self.integers([items as u64]);
    }
}
