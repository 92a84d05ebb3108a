//! Where the pieces of a Jacobian go in the matrix: a system emits them in the same places at every
//! call, so they are looked up once.

use crate::physics::{Jacobian, Slope};

/// Rows, places, and where what is emitted goes.
#[derive(Default)]
pub(super) struct Pattern {
    /// The coordinate each row stands for; `NOWHERE` for one that stands for none.
    pub coordinates: Vec<usize>,
    pub free: Vec<bool>,
    /// Where each column of `lower` begins, one more at the end.
    pub starts: Vec<usize>,
    pub rows: Vec<u32>,
    /// Rows of the identity.
    pub pinned: Vec<usize>,
    /// Of position, then of velocity.
    pub slopes: [Places; 2],
}

/// What was emitted last, and where it goes.
#[derive(Default)]
pub(super) struct Places {
    pub ends: Vec<[u32; 2]>,
    pub pairs: Vec<PairPlace>,
    pub entries: Vec<(usize, usize)>,
    pub triplets: Vec<Place>,
}

#[derive(Clone, Copy)]
pub(super) struct PairPlace {
    /// Places on the diagonal of both ends, and below it; `NOWHERE` where an end is fixed.
    pub ends: [u32; 2],
    pub off: u32,
}

#[derive(Clone, Copy)]
pub(super) enum Place {
    Diagonal(u32, (usize, usize)),
    Lower(u32, (usize, usize)),
    Upper(u32, (usize, usize)),
    Nowhere,
}

const NOWHERE: u32 = u32::MAX;

impl Pattern {
    /// Whether this is the pattern of that Jacobian: the same places in the same order.
    pub(super) fn fits(&self, inverse_mass: &[f64], jacobian: &Jacobian) -> bool {
        let free = inverse_mass.iter().map(|w| *w > 0.0);
        free.eq(self.free.iter().copied())
            && [Slope::Position, Slope::Velocity].iter().all(|&by| {
                let places = &self.slopes[by as usize];
                let ends = jacobian.pairs(by).iter().map(|pair| pair.ends);
                let entries = jacobian.triplets(by).iter().map(|&(r, c, _)| (r, c));
                ends.eq(places.ends.iter().copied()) && entries.eq(places.entries.iter().copied())
            })
    }

    pub(super) fn new(inverse_mass: &[f64], jacobian: &Jacobian) -> Self {
        let free: Vec<bool> = inverse_mass.iter().map(|w| *w > 0.0).collect();
        // From particle to block.
        let mut blocks = 0;
        let place: Vec<u32> = free
            .chunks(3)
            .map(|free| {
                if free.contains(&true) {
                    blocks += 1;
                    blocks - 1
                } else {
                    NOWHERE
                }
            })
            .collect();
        let particles = (0..place.len()).filter(|&p| place[p] != NOWHERE);
        let coordinates: Vec<usize> = particles.flat_map(|p| 3 * p..3 * p + 3).collect();
        let is_free = |at: usize| free.get(at) == Some(&true);
        let pinned = (0..coordinates.len()).filter(|&row| !is_free(coordinates[row]));
        let pinned = pinned.collect();
        // Which blocks below the diagonal there are.
        let at = |particle: usize| place.get(particle).copied().unwrap_or(NOWHERE);
        let both = [Slope::Position, Slope::Velocity];
        let pairs = both.iter().flat_map(|&by| jacobian.pairs(by));
        let pairs = pairs.map(|pair| pair.ends.map(|end| at(end as usize)));
        let entries = both.iter().flat_map(|&by| jacobian.triplets(by));
        let entries = entries.map(|&(r, c, _)| [at(r / 3), at(c / 3)]);
        let mut below: Vec<(u32, u32)> = pairs
            .chain(entries)
            .filter(|[i, j]| i != j && *i != NOWHERE && *j != NOWHERE)
            .map(|[i, j]| (i.min(j), i.max(j)))
            .collect();
        below.sort_unstable();
        below.dedup();
        let starts = (0..=blocks)
            .map(|column| below.partition_point(|&(c, _)| c < column))
            .collect();
        let off = |i: u32, j: u32| -> u32 {
            below
                .binary_search(&(i.min(j), i.max(j)))
                .map_or(NOWHERE, |at| at as u32)
        };
        let places = |by: Slope| Places {
            ends: jacobian.pairs(by).iter().map(|pair| pair.ends).collect(),
            pairs: (jacobian.pairs(by).iter())
                .map(|pair| {
                    let [i, j] = pair.ends.map(|end| at(end as usize));
                    PairPlace {
                        ends: [i, j],
                        off: off(i, j),
                    }
                })
                .collect(),
            entries: jacobian
                .triplets(by)
                .iter()
                .map(|&(r, c, _)| (r, c))
                .collect(),
            triplets: (jacobian.triplets(by).iter())
                .map(|&(r, c, _)| {
                    let (i, j, cell) = (at(r / 3), at(c / 3), (r % 3, c % 3));
                    if i == NOWHERE || j == NOWHERE {
                        Place::Nowhere
                    } else if i == j {
                        Place::Diagonal(i, cell)
                    } else if i > j {
                        Place::Lower(off(i, j), cell)
                    } else {
                        Place::Upper(off(i, j), cell)
                    }
                })
                .collect(),
        };
        Self {
            slopes: both.map(places),
            coordinates,
            starts,
            rows: below.iter().map(|&(_, row)| row).collect(),
            pinned,
            free,
        }
    }
}
