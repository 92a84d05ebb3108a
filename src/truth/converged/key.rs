//! What a scene's motion depends on, as one number.

use super::{BUDGET, VERSION};
use crate::scene::Scene;
use crate::scene::parameters::{PARTS, Value};
use sha2::{Digest, Sha256};

/// The SHA-256 of everything that decides the motion and its reference up to `until`, s, as lower-case
/// hexadecimal digits: equal for equal motions whatever they are called and however they are stepped.
/// What decides the motion is said by the [`PARTS`] of a scene.
///
/// Numbers count by their bits, so -0 is not 0: a motion computed twice, never a wrong one.
pub fn key(scene: &Scene, until: f64) -> String {
    let mut content = Content(Sha256::new());
    content.integers([u64::from(VERSION), BUDGET, until.to_bits()]);
    for part in PARTS {
        let count = (part.count)(scene);
        for row in part.rows.iter().filter(|row| row.flat.is_some()) {
            content.length(count);
            for at in 0..count {
                content.value((row.get)(scene, at));
            }
        }
    }
    hexadecimal(&content.0.finalize())
}

/// Digits of bytes, high half first.
fn hexadecimal(bytes: &[u8]) -> String {
    let digit = |half: u8| char::from_digit(u32::from(half), 16).unwrap_or('0');
    let digits = bytes.iter().flat_map(|byte| [byte >> 4, byte & 15]);
    digits.map(digit).collect()
}

/// A hash fed with numbers of eight bytes each, and text; whatever may be of any length is preceded by it.
struct Content(Sha256);

impl Content {
    fn integers(&mut self, values: impl IntoIterator<Item = u64>) {
        for value in values {
            self.0.update(value.to_le_bytes());
        }
    }

    fn length(&mut self, items: usize) {
        self.integers([items as u64]);
    }

    fn value(&mut self, value: Option<Value>) {
        match value {
            None => self.length(0),
            Some(Value::Numbers(numbers)) => {
                self.length(numbers.len());
                self.integers(numbers.iter().map(|x| x.to_bits()));
            }
            Some(Value::Ids(ids)) => {
                self.length(ids.len());
                self.integers(ids.iter().map(|id| *id as u64));
            }
            Some(Value::Flag(flag)) => self.integers([u64::from(flag)]),
            Some(Value::Text(text)) => {
                self.length(text.len());
                self.0.update(text);
            }
        }
    }
}
