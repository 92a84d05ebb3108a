//! The memory that an engine takes for a scene, estimated before any of it is taken.

use super::Unsupported;
use crate::scene::Scene;
use faer::Side;
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::cholesky::{SymmetricOrdering, factorize_symbolic_cholesky};

/// The most bytes that an engine may take; two run at once on two cores.
const MOST: u64 = 2 << 30;
/// Bytes of a body or joint in a rapier world that is being stepped: measured with rapier 0.36, 2,100 to 2,200.
const JOINT: u64 = 2_200;
/// Bytes of a block of 3 x 3 in a factor.
const BLOCK: u64 = 72;
/// Below this many particles no factor is larger than `MOST`: a full one has n (n + 1) / 2 blocks.
const SMALL: usize = 7_000;

/// # Errors
/// [`Unsupported`] where a rapier world with a body for each particle and `joints` joints would take more memory
/// than an engine may.
pub(super) fn fits_rapier(scene: &Scene, joints: usize) -> Result<(), Unsupported> {
    let items = (scene.particles.len() + joints) as u64;
    fits(
        "its world of bodies and joints",
        items.saturating_mul(JOINT),
    )
}

/// # Errors
/// [`Unsupported`] where the sparse factor of an implicit step's matrix would.
pub(super) fn fits_factor(scene: &Scene) -> Result<(), Unsupported> {
    if scene.particles.len() <= SMALL {
        return Ok(());
    }
    let blocks = factor_blocks(scene).unwrap_or(u64::MAX);
    fits(
        "the factors of its linear solves",
        blocks.saturating_mul(BLOCK),
    )
}

fn fits(what: &str, bytes: u64) -> Result<(), Unsupported> {
    if bytes <= MOST {
        return Ok(());
    }
    let gigabytes = |bytes: u64| bytes as f64 / f64::from(1 << 30);
    Err(Unsupported {
        reason: format!(
            "{what} would take {:.1} GB of memory, more than the {} GB that an engine may take",
            gigabytes(bytes),
            gigabytes(MOST)
        ),
    })
}

/// The blocks of the sparse Cholesky factor of a matrix that couples the ends of springs and attractions, from its
/// pattern alone. None where not even that can be laid out.
fn factor_blocks(scene: &Scene) -> Option<u64> {
    let n = scene.particles.len();
    let free = |p: usize| !scene.particles[p].fixed;
    let springs = scene.springs.iter().map(|spring| spring.ends);
    let hinges = scene.bending.iter().flat_map(|hinge| {
        let [a, b, c] = hinge.particles;
        [[a, b], [b, c], [a, c]]
    });
    let pairs = springs.chain(scene.gravitational.iter().map(|pair| pair.ends));
    let pairs = pairs.chain(hinges);
    let coupled = pairs.filter(|[a, b]| a != b && free(*a) && free(*b));
    let mut places: Vec<(usize, usize)> = coupled
        .map(|[a, b]| (a.min(b), a.max(b)))
        .chain((0..n).map(|p| (p, p)))
        .collect();
    places.sort_unstable();
    places.dedup();
    let starts: Vec<usize> = (0..=n)
        .map(|column| places.partition_point(|(c, _)| *c < column))
        .collect();
    let rows: Vec<usize> = places.into_iter().map(|(_, row)| row).collect();
    let pattern = SymbolicSparseColMatRef::new_checked(n, n, &starts, None, &rows);
    let ordering = SymmetricOrdering::Amd;
    let symbolic = factorize_symbolic_cholesky(pattern, Side::Lower, ordering, Default::default());
    Some(symbolic.ok()?.len_val() as u64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Particle, Spring};

    fn scene(particles: usize, ends: impl Iterator<Item = [usize; 2]>) -> Scene {
        let particle = |k: usize| Particle {
            position: [k as f64, 0.0, 0.0],
            ..Particle::default()
        };
        let spring = |ends| Spring {
            ends,
            ..Spring::default()
        };
        Scene {
            particles: (0..particles).map(particle).collect(),
            springs: ends.map(spring).collect(),
            ..Scene::default()
        }
    }

    /// A full network of n has n (n + 1) / 2 blocks and a chain 2 n - 1, as George and Liu count them; what columns
    /// are joined to panels adds zeros, on a chain less than as many again.
    #[test]
    fn factors_have_the_known_numbers_of_blocks() {
        let full = (0..40).flat_map(|i| (0..i).map(move |j| [i, j]));
        assert_eq!(factor_blocks(&scene(40, full)), Some(820));
        let chain = scene(50_000, (1..50_000).map(|k| [k - 1, k]));
        let blocks = factor_blocks(&chain).unwrap_or(0);
        assert!((99_999..200_000).contains(&blocks), "{blocks}");
        assert!(fits_factor(&chain).is_ok());
    }

    #[test]
    fn what_does_not_fit_is_named_with_its_size() {
        let few = scene(2, [[0, 1]].into_iter());
        assert!(fits_rapier(&few, 900_000).is_ok());
        let refused = fits_rapier(&few, 2_000_000).map_err(|why| why.reason);
        assert!(refused.is_err_and(|why| why.contains("4.1 GB")));
    }
}
