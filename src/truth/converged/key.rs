//! The key of a scene's motion: all it depends on, as one number.

use super::{VERSION, budget};
use crate::scene::model::PARTS;
use crate::scene::{Scene, Value};
use sha2::{Digest, Sha256};

/// The SHA-256 of everything that decides the motion and its reference up to `until`, s, as lower-case
/// hexadecimal digits: equal for equal motions whatever they are called and however they are stepped.
/// The [rows](crate::scene::model::Row) of the scene say what decides the motion.
///
/// Numbers count by their bits, so -0 is not 0: a motion computed twice, never a wrong one.
pub fn key(scene: &Scene, until: f64) -> String {
    let mut hash = Sha256::new();
    let mut add = |number: u64| hash.update(number.to_le_bytes());
    let budget = budget(3 * scene.particles.len());
    for number in [u64::from(VERSION), budget, until.to_bits()] {
        add(number);
    }
    for part in PARTS {
        let count = (part.count)(scene);
        for row in part.rows.iter().filter(|row| row.flat.is_some()) {
            add(count as u64);
            for at in 0..count {
                // The hash takes a 1 before each component and a 0 after the last, so that an absent value
                // differs from 0.
                for value in row.values(scene, at) {
                    add(1);
                    match value {
                        Value::Number(x) => add(x.to_bits()),
                        Value::Id(id) => add(id as u64),
                        Value::Flag(flag) => add(u64::from(flag)),
                        Value::Text(text) => {
                            add(text.len() as u64);
                            text.bytes().for_each(|byte| add(u64::from(byte)));
                        }
                    }
                }
                add(0);
            }
        }
    }
    // Radii are of balls that collide, and of nothing else.
    if scene.collides() {
        for particle in &scene.particles {
            hash.update(particle.radius.to_bits().to_le_bytes());
        }
    }
    let digest = hash.finalize();
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}
