//! A reference as bytes and back: what a [`Store`](crate::truth::Store) keeps.
//!
//! The bytes are [`Kept`] in postcard's format, and their SHA-256 behind it. Whatever does not fit
//! together to the last byte is nothing.

use super::reference::{Record, Reference, SharedSystem};
use super::{Converged, NotConverged, VERSION};
use sha2::{Digest, Sha256};
use std::sync::Arc;

/// Length of the checksum.
const CHECKSUM: usize = 32;

/// Version, key, and what was found: method, reason, horizon, error bound, growth, spent, record.
type Kept = (u32, String, Result<Found, NotConverged>);
type Found = (String, String, f64, f64, Option<f64>, u64, Record);

/// What was found under this key, or why nothing was. None if it cannot be written down.
pub(super) fn encode(found: &Result<Converged, NotConverged>, key: &str) -> Option<Vec<u8>> {
    let found = found.as_ref().map(|found| {
        let Converged {
            method,
            horizon,
            error_bound,
            growth,
            reason,
            spent,
            motion: Reference { system: _, record },
        } = found;
        (method, reason, horizon, error_bound, growth, spent, record)
    });
    let mut bytes = postcard::to_allocvec(&(VERSION, key, found)).ok()?;
    let checksum = Sha256::digest(&bytes);
    bytes.extend_from_slice(&checksum);
    Some(bytes)
}

/// None if these are not the bytes of this key, version and system, whole and unchanged.
pub(super) fn decode(
    bytes: &[u8],
    key: &str,
    system: &SharedSystem,
    until: f64,
) -> Option<Result<Converged, NotConverged>> {
    let (content, checksum) = bytes.split_at_checked(bytes.len().checked_sub(CHECKSUM)?)?;
    if Sha256::digest(content).as_slice() != checksum {
        return None;
    }
    let (kept, rest): (Kept, _) = postcard::take_from_bytes(content).ok()?;
    let (version, name, found) = kept;
    if version != VERSION || name != key || !rest.is_empty() {
        return None;
    }
    let (method, reason, horizon, error_bound, growth, spent, record) = match found {
        Ok(found) => found,
        Err(not) => return Some(Err(not)),
    };
    record.fits(system.dim(), until).then(|| {
        Ok(Converged {
            method,
            horizon,
            error_bound,
            growth,
            reason,
            spent,
            motion: Reference {
                system: Arc::clone(system),
                record,
            },
        })
    })
}
