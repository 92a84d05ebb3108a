//! Time cut into pieces of unequal length, each a power of two shorter than the longest.

use serde::{Deserialize, Serialize};

/// Most halvings of an interval; beyond that a piece is as short as a rounding of the whole.
const DEEPEST: u8 = 40;

/// A stretch of time from 0 in equal intervals, each halved into pieces as often as it needs.
///
/// All lengths are `until` over a power of two, so that no sum of them rounds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Mesh {
    until: f64,
    /// How often each piece's interval was halved, in order of time.
    depths: Vec<u8>,
    /// The number of pieces up to the end of each interval.
    ends: Vec<usize>,
}

/// A step through a part of an interval, in units of the interval's length: exact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct MeshStep {
    pub offset: f64,
    pub length: f64,
}

impl MeshStep {
    pub fn end(self) -> f64 {
        self.offset + self.length
    }
}

/// Length of a piece, in units of its interval.
fn length(depth: u8) -> f64 {
    0.5_f64.powi(i32::from(depth))
}

impl Mesh {
    /// Equal pieces in at most `most` intervals; both powers of two.
    pub fn uniform(until: f64, pieces: u64, most: u64) -> Self {
        let intervals = pieces.min(most).max(1);
        let each = pieces.max(1) / intervals;
        let depth = each.ilog2() as u8;
        Self {
            until,
            depths: vec![depth; (intervals * each) as usize],
            ends: (1..=intervals).map(|k| (k * each) as usize).collect(),
        }
    }

    /// Whether it covers this time and its pieces fill each interval exactly: a mesh from a store may not.
    pub fn fills(&self, until: f64) -> bool {
        let mut start = 0;
        let filled = |&end: &usize| {
            let pieces = self.depths.get(start..end);
            start = end;
            let lengths = |pieces: &[u8]| pieces.iter().map(|d| length(*d)).sum::<f64>();
            pieces.is_some_and(|p| lengths(p) == 1.0 && p.iter().all(|d| *d <= DEEPEST))
        };
        self.until.to_bits() == until.to_bits()
            && self.ends.iter().all(filled)
            && self.ends.last() == Some(&self.depths.len())
    }

    /// The end of the mesh, s.
    pub fn until(&self) -> f64 {
        self.until
    }

    /// Length of each interval, s.
    pub fn interval(&self) -> f64 {
        self.until / self.ends.len() as f64
    }

    pub fn intervals(&self) -> usize {
        self.ends.len()
    }

    /// The start of interval k, s, rounded once.
    pub fn time(&self, k: usize) -> f64 {
        k as f64 * self.interval()
    }

    pub fn pieces(&self) -> usize {
        self.depths.len()
    }

    /// The pieces of interval k.
    pub fn range(&self, k: usize) -> std::ops::Range<usize> {
        let start = k.checked_sub(1).map_or(0, |before| self.ends[before]);
        start..self.ends[k]
    }

    /// The steps through interval k, `each` equal ones, a power of two, through every piece.
    pub fn steps(&self, k: usize, each: u32) -> impl Iterator<Item = MeshStep> {
        let pieces = self.depths[self.range(k)].iter();
        let lengths = pieces.flat_map(move |depth| {
            let length = length(*depth) / f64::from(each);
            std::iter::repeat_n(length, each as usize)
        });
        lengths.scan(0.0, |offset, length| {
            let part = MeshStep {
                offset: *offset,
                length,
            };
            *offset += length;
            Some(part)
        })
    }

    /// Every piece halved `more(piece)` times, where it can be; the intervals halved too as long as
    /// all pieces allow and there are at most `most`.
    pub fn refined(&self, more: impl Fn(usize) -> u8, most: u64) -> Self {
        let mut refined = Self {
            until: self.until,
            depths: Vec::with_capacity(self.pieces()),
            ends: Vec::with_capacity(self.intervals()),
        };
        for k in 0..self.intervals() {
            for piece in self.range(k) {
                let depth = self.depths[piece];
                let halvings = more(piece).min(DEEPEST.saturating_sub(depth));
                let parts = std::iter::repeat_n(depth + halvings, 1 << halvings);
                refined.depths.extend(parts);
            }
            refined.ends.push(refined.depths.len());
        }
        while refined.intervals() as u64 * 2 <= most && refined.depths.iter().all(|d| *d > 0) {
            refined.halve_intervals();
        }
        refined
    }

    fn halve_intervals(&mut self) {
        let mut ends = Vec::with_capacity(2 * self.intervals());
        for k in 0..self.intervals() {
            let range = self.range(k);
            let first_half = self
                .steps(k, 1)
                .take_while(|part| part.offset < 0.5)
                .count();
            ends.extend([range.start + first_half, range.end]);
        }
        self.ends = ends;
        for depth in &mut self.depths {
            *depth -= 1;
        }
    }
}
