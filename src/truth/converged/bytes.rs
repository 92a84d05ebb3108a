//! A reference as bytes and back: what a [`Store`](crate::truth::Store) keeps.
//!
//! ```text
//! magic, version, key | found or not | facts | mesh | bars, positions, velocities | SHA-256 of all before
//! ```
//! Little-endian, eight bytes a number, texts after their length. Whatever does not fit together to
//! the last byte is nothing.

use super::mesh::Mesh;
use super::reference::{Record, Reference, SharedSystem};
use super::samples::Samples;
use super::{Converged, NotConverged, VERSION};
use sha2::{Digest, Sha256};
use std::sync::Arc;

const MAGIC: &[u8; 8] = b"sprtruth";

/// Length of the checksum.
const CHECKSUM: usize = 32;

/// What was found under this key, or why nothing was.
pub(super) fn encode(found: &Result<Converged, NotConverged>, key: &str) -> Vec<u8> {
    let mut out = Writer::default();
    out.0.extend_from_slice(MAGIC);
    out.integer(u64::from(VERSION));
    out.text(key);
    match found {
        Err(NotConverged { reason }) => {
            out.integer(0);
            out.text(reason);
        }
        Ok(converged) => {
            let Converged {
                method,
                horizon,
                error_bound,
                growth,
                reason,
                spent,
                motion: Reference { system: _, record },
            } = converged;
            out.integer(1);
            out.text(method);
            out.text(reason);
            out.numbers(&[*horizon, *error_bound]);
            out.integer(u64::from(growth.is_some()));
            out.numbers(&[growth.unwrap_or(0.0)]);
            out.integer(*spent);
            let Record {
                mesh,
                samples: Samples { x, v, dim },
                bars,
            } = record;
            out.numbers(&[mesh.until()]);
            out.integer(*dim as u64);
            out.integer(mesh.intervals() as u64);
            for k in 0..mesh.intervals() {
                out.integer(mesh.range(k).len() as u64);
            }
            out.bytes(mesh.depths());
            out.numbers(bars);
            out.numbers(x);
            out.numbers(v);
        }
    }
    let checksum = Sha256::digest(&out.0);
    out.0.extend_from_slice(&checksum);
    out.0
}

/// None if these are not the bytes of this key, version and system, whole and unchanged.
pub(super) fn decode(
    bytes: &[u8],
    key: &str,
    system: &SharedSystem,
    until: f64,
) -> Option<Result<Converged, NotConverged>> {
    let (content, checksum) = bytes.split_at_checked(bytes.len().checked_sub(CHECKSUM)?)?;
    let mut input = Reader(content);
    let expected = input.take(MAGIC.len())? == MAGIC
        && input.integer()? == u64::from(VERSION)
        && input.text()? == key
        && Sha256::digest(content).as_slice() == checksum;
    if !expected {
        return None;
    }
    let found = match input.integer()? {
        0 => Err(NotConverged {
            reason: input.text()?,
        }),
        1 => Ok(converged(&mut input, system, until)?),
        _ => return None,
    };
    input.0.is_empty().then_some(found)
}

fn converged(input: &mut Reader, system: &SharedSystem, until: f64) -> Option<Converged> {
    let (method, reason) = (input.text()?, input.text()?);
    let (horizon, error_bound) = (input.number()?, input.number()?);
    let grows = input.integer()? == 1;
    let rate = input.number()?;
    let spent = input.integer()?;
    let covered = input.number()?;
    let (dim, intervals) = (input.size()?, input.size()?);
    if dim != system.dim() || covered.to_bits() != until.to_bits() {
        return None;
    }
    let mesh = {
        let bytes = input.take(intervals.checked_mul(8)?)?;
        let (counts, _) = bytes.as_chunks::<8>();
        let counts: Vec<u64> = counts.iter().map(|c| u64::from_le_bytes(*c)).collect();
        let depths = input.bytes()?.to_vec();
        Mesh::from_parts(until, depths, &counts)?
    };
    let instants = intervals.checked_add(1)?;
    let coordinates = instants.checked_mul(dim)?;
    Some(Converged {
        method,
        horizon,
        error_bound,
        growth: grows.then_some(rate),
        reason,
        spent,
        motion: Reference {
            system: Arc::clone(system),
            record: Record {
                mesh,
                bars: input.numbers(instants)?,
                samples: Samples {
                    x: input.numbers(coordinates)?,
                    v: input.numbers(coordinates)?,
                    dim,
                },
            },
        },
    })
}

#[derive(Default)]
struct Writer(Vec<u8>);

impl Writer {
    fn integer(&mut self, value: u64) {
        self.0.extend_from_slice(&value.to_le_bytes());
    }

    fn numbers(&mut self, values: &[f64]) {
        self.0.reserve(8 * values.len());
        for value in values {
            self.0.extend_from_slice(&value.to_le_bytes());
        }
    }

    fn bytes(&mut self, bytes: &[u8]) {
        self.integer(bytes.len() as u64);
        self.0.extend_from_slice(bytes);
    }

    fn text(&mut self, text: &str) {
        self.bytes(text.as_bytes());
    }
}

/// What has not been read yet.
struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    fn take(&mut self, bytes: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(bytes)?;
        self.0 = rest;
        Some(taken)
    }

    fn integer(&mut self) -> Option<u64> {
        self.take(8)?.try_into().ok().map(u64::from_le_bytes)
    }

    fn number(&mut self) -> Option<f64> {
        self.integer().map(f64::from_bits)
    }

    fn numbers(&mut self, count: usize) -> Option<Vec<f64>> {
        let bytes = self.take(count.checked_mul(8)?)?;
        let (numbers, _) = bytes.as_chunks::<8>();
        Some(numbers.iter().map(|n| f64::from_le_bytes(*n)).collect())
    }

    fn size(&mut self) -> Option<usize> {
        usize::try_from(self.integer()?).ok()
    }

    fn bytes(&mut self) -> Option<&'a [u8]> {
        let length = self.size()?;
        self.take(length)
    }

    fn text(&mut self) -> Option<String> {
        String::from_utf8(self.bytes()?.to_vec()).ok()
    }
}
