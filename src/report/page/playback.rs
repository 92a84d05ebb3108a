//! The motion of several engines on one clock, packed for the page's player.
//!
//! Positions are origin + unit q with whole q, ordered by frame, then coordinate, then particle. Stored are differences, in
//! time and then along particles, as zigzag LEB128 numbers, deflated (raw), in base64. `script/src/types.d.ts` states the
//! same for the reader.

use base64::{Engine as _, engine::general_purpose::STANDARD};
use flate2::{Compression, write::DeflateEncoder};
use serde::{Deserialize, Serialize};
use std::io::Write;

/// The version of this layout.
const VERSION: u32 = 1;
/// The largest q: what leaves the picture further stays there.
const FARTHEST: f64 = (1 << 28) as f64;

/// What is played: `M` is the motion of an engine.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Playback<M = Motion> {
    version: u32,
    pub particles: Bodies,
    pub springs: Springs,
    pub rods: Pairs,
    pub obstacles: Vec<Obstacle>,
    /// The time of each frame, s, growing.
    pub t: Vec<f64>,
    pub engines: Vec<M>,
    /// Engines that ran and are not here, since they would make the file too large.
    pub left_out: usize,
}

/// The particles.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Bodies {
    pub count: usize,
    /// Those that never move by themselves.
    pub fixed: Vec<usize>,
    pub radius: Radius,
}

/// One radius of all particles, or each its own, m.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Radius {
    All(f64),
    Each(Vec<f64>),
}

/// Springs, with their rest lengths, m, as packed 32-bit floats.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Springs {
    #[serde(flatten)]
    pub pairs: Pairs,
    rest: String,
}

/// Pairs of particles, packed.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Pairs {
    pub count: usize,
    ends: String,
}

/// The motion of one engine.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Motion {
    /// Index into the report's outcomes; None for the truth.
    pub outcome: Option<usize>,
    /// How many frames it has.
    pub last: usize,
    origin: [f64; 3],
    /// Metres that positions are rounded to.
    pub unit: f64,
    positions: String,
}

/// An engine's motion as a page plays it.
#[derive(Debug, Clone, Serialize)]
pub struct Shown {
    /// What links it with rows and lines.
    pub id: String,
    pub name: String,
    /// `#rrggbb`.
    pub colour: &'static str,
    /// An SVG dash array; empty for a solid line.
    pub dash: &'static str,
    /// Whether it is the scene's own integrator.
    pub own: bool,
    /// Whether it is the truth.
    pub truth: bool,
    /// When it diverged or failed, s.
    pub diverged: Option<f64>,
    /// When it first left its scheme, s.
    pub fault: Option<f64>,
    #[serde(flatten)]
    pub motion: Motion,
}

/// An obstacle at its stated place.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Obstacle {
    #[serde(flatten)]
    pub shape: Shape,
    /// Its shift from that place at each frame, m; None where it stays.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub path: Option<Vec<[f64; 3]>>,
}

/// Lengths in metres.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(tag = "shape", rename_all = "snake_case")]
pub enum Shape {
    /// All with normal · x < offset is solid.
    Plane {
        normal: [f64; 3],
        offset: f64,
    },
    Ball {
        center: [f64; 3],
        radius: f64,
    },
    Box {
        center: [f64; 3],
        half: [f64; 3],
        /// Unit vectors along its sides.
        axes: [[f64; 3]; 3],
    },
    Capsule {
        ends: [[f64; 3]; 2],
        radius: f64,
    },
    Mesh {
        vertices: Vec<[f64; 3]>,
        triangles: Vec<[f64; 3]>,
    },
}

/// A grid that positions are rounded to.
#[derive(Debug, Clone, Copy)]
pub struct Grid {
    pub origin: [f64; 3],
    /// Metres.
    pub unit: f64,
}

impl<M> Playback<M> {
    /// Of these frames, without engines yet.
    pub fn new(particles: Bodies, springs: Springs, rods: Pairs, t: Vec<f64>) -> Self {
        Self {
            version: VERSION,
            particles,
            springs,
            rods,
            obstacles: Vec::new(),
            t,
            engines: Vec::new(),
            left_out: 0,
        }
    }

    /// The same with what `shown` makes of each engine's motion.
    pub fn map<N>(&self, shown: impl FnMut(&M) -> N) -> Playback<N> {
        Playback {
            version: self.version,
            particles: self.particles.clone(),
            springs: self.springs.clone(),
            rods: self.rods.clone(),
            obstacles: self.obstacles.clone(),
            t: self.t.clone(),
            engines: self.engines.iter().map(shown).collect(),
            left_out: self.left_out,
        }
    }
}

impl Playback<Shown> {
    /// How exact it is, and what is left out.
    pub fn said(&self) -> String {
        let unit = self.engines.iter().map(|engine| engine.motion.unit);
        let unit = unit.fold(0.0, f64::max);
        let mut said = format!(
            "{} instants of the run, with positions rounded to {} m; straight in between.",
            self.t.len(),
            crate::report::words::short(unit)
        );
        if self.left_out > 0 {
            said += &format!(
                " {} more engines ran: with them this file would be too large.",
                self.left_out
            );
        }
        said
    }
}

impl Springs {
    pub fn new(ends: impl ExactSizeIterator<Item = [usize; 2]>, rest: &[f64]) -> Self {
        let bytes = rest.iter().flat_map(|rest| (*rest as f32).to_le_bytes());
        Self {
            pairs: Pairs::new(ends),
            rest: STANDARD.encode(bytes.collect::<Vec<u8>>()),
        }
    }
}

impl Pairs {
    pub fn new(ends: impl ExactSizeIterator<Item = [usize; 2]>) -> Self {
        let count = ends.len();
        let mut before = 0;
        let steps = ends.flatten().map(|end| {
            let end = end as i64;
            end - std::mem::replace(&mut before, end)
        });
        Self {
            count,
            ends: packed(steps),
        }
    }
}

impl Motion {
    /// Of frames that each have 3n coordinates in m, x, y and z of one particle after the other.
    pub fn new(outcome: Option<usize>, frames: &[Vec<f64>], grid: Grid) -> Self {
        let mut before = vec![0; frames.first().map_or(0, Vec::len)];
        let mut steps = Vec::with_capacity(frames.len() * before.len());
        for x in frames {
            let count = x.len() / 3;
            for (axis, of_axis) in before.chunks_mut(count.max(1)).enumerate() {
                let mut along = 0;
                for (particle, before) in of_axis.iter_mut().enumerate() {
                    let q = grid.q(axis, x[3 * particle + axis]);
                    let step = q - std::mem::replace(before, q);
                    steps.push(step - std::mem::replace(&mut along, step));
                }
            }
        }
        Self {
            outcome,
            last: frames.len(),
            origin: grid.origin,
            unit: grid.unit,
            positions: packed(steps.into_iter()),
        }
    }
}

impl Grid {
    fn q(&self, axis: usize, x: f64) -> i64 {
        let q = ((x - self.origin[axis]) / self.unit).round();
        q.clamp(-FARTHEST, FARTHEST) as i64
    }
}

/// Whole numbers as zigzag LEB128, deflated, in base64.
fn packed(numbers: impl Iterator<Item = i64>) -> String {
    let mut bytes = Vec::new();
    for number in numbers {
        let mut rest = (number << 1 ^ number >> 63) as u64;
        while rest > 127 {
            bytes.push(rest as u8 | 128);
            rest >>= 7;
        }
        bytes.push(rest as u8);
    }
    let mut deflated = DeflateEncoder::new(Vec::new(), Compression::default());
    // Writing to memory cannot fail.
    let _ = deflated.write_all(&bytes);
    STANDARD.encode(deflated.finish().unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::bufread::DeflateDecoder;
    use std::io::Read;

    /// The numbers that were packed.
    fn unpacked(text: &str) -> Vec<i64> {
        let bytes = STANDARD.decode(text).unwrap();
        let mut raw = Vec::new();
        DeflateDecoder::new(&bytes[..])
            .read_to_end(&mut raw)
            .unwrap();
        let (mut numbers, mut rest, mut place) = (Vec::new(), 0_u64, 0);
        for byte in raw {
            rest |= u64::from(byte & 127) << place;
            place += 7;
            if byte < 128 {
                numbers.push((rest >> 1) as i64 ^ -((rest & 1) as i64));
                (rest, place) = (0, 0);
            }
        }
        numbers
    }

    #[test]
    fn numbers_of_any_size_come_back() {
        let numbers = [0, 1, -1, 63, 64, -64, -65, 1 << 40, -(1 << 40)];
        assert_eq!(unpacked(&packed(numbers.into_iter())), numbers);
    }

    #[test]
    fn positions_are_off_by_half_a_unit_at_most() {
        let unit = 1e-3;
        let frames: Vec<Vec<f64>> = (0..7)
            .map(|k| {
                (0..12)
                    .map(|c| (0.7 * f64::from(k) + f64::from(c)).sin())
                    .collect()
            })
            .collect();
        let origin = [-1.0, -1.0, -1.0];
        let motion = Motion::new(None, &frames, Grid { origin, unit });
        let steps = unpacked(&motion.positions);
        let mut q = [0; 12];
        for (frame, steps) in frames.iter().zip(steps.chunks(12)) {
            for (axis, steps) in steps.chunks(4).enumerate() {
                let mut along = 0;
                for (particle, step) in steps.iter().enumerate() {
                    along += step;
                    q[4 * axis + particle] += along;
                    let back = origin[axis] + unit * q[4 * axis + particle] as f64;
                    let off = (back - frame[3 * particle + axis]).abs();
                    assert!(off <= 0.5 * unit + 1e-15, "{off}");
                }
            }
        }
    }

    #[test]
    fn what_flies_away_or_is_no_number_is_packed_too() {
        let frames = [vec![f64::MAX, 0.0, -f64::MAX]];
        let origin = [0.0; 3];
        let motion = Motion::new(None, &frames, Grid { origin, unit: 1e-6 });
        let far = FARTHEST as i64;
        assert_eq!(unpacked(&motion.positions), [far, 0, -far]);
    }
}
