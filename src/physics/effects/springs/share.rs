//! The parts of a network, shared among threads.

use super::kernel::{self, Motion, Vectors};
use super::network::Part;
use pulp::Arch;

/// Adds all forces, N, to `f` of length 3n; returns the dissipated power, W. Without `ELASTIC` those
/// of the dampers alone.
///
/// Parts go to whatever threads are free. Each adds to its own particles, and the powers are summed
/// along the same tree whatever the number of threads, one included.
#[inline(always)]
pub(super) fn add<const MODEL: u8, const ELASTIC: bool>(
    arch: Arch,
    parts: &[Part],
    at: Motion,
    f: &mut [f64],
) -> f64 {
    let f = f.as_chunks_mut().0;
    if let [part] = parts {
        return kernel::add::<MODEL, ELASTIC>(arch, &part.table, at, f, 0);
    }
    add_parts::<MODEL, ELASTIC>(arch, parts, at, f, rayon::current_num_threads() > 1)
}

/// `f` begins with the first part's first particle.
fn add_parts<const MODEL: u8, const ELASTIC: bool>(
    arch: Arch,
    parts: &[Part],
    at: Motion,
    f: &mut Vectors,
    parallel: bool,
) -> f64 {
    let start = |parts: &[Part]| parts.first().map_or(0, |part| part.particles.start);
    let (left, right) = match parts {
        [] => return 0.0,
        [part] => return kernel::add::<MODEL, ELASTIC>(arch, &part.table, at, f, start(parts)),
        parts => parts.split_at(parts.len() / 2),
    };
    let (own, others) = f.split_at_mut(start(right) - start(left));
    let mut left = || add_parts::<MODEL, ELASTIC>(arch, left, at, own, parallel);
    let mut right = || add_parts::<MODEL, ELASTIC>(arch, right, at, others, parallel);
    let (left, right) = if parallel {
        rayon::join(left, right)
    } else {
        (left(), right())
    };
    left + right
}
