//! G W Gᵀ for distances between particles: row k of G is the direction of rod k, W holds 1/m. Its places and their
//! order of elimination are found once, its Cholesky factor at every position.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::prelude::{MatMut, Par};
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, Side};

/// Pivots below this part of their diagonal entry count as 0. A pivot is the squared sine of the angle between a row
/// and the rows before it, so that 1e-12 is an angle of 1e-6, where multipliers keep four digits.
pub(crate) const DEPENDENT: f64 = 1e-12;

/// The part of the largest component of a null vector from which on a rod belongs to it.
const BELONGS: f64 = 1e-3;

/// The places of the matrix for these rods.
pub(crate) struct Gram {
    /// The two particles of each rod.
    pub ends: Vec<[usize; 2]>,
    symbolic: SymbolicCholesky<usize>,
    starts: Vec<usize>,
    rows: Vec<usize>,
    couplings: Vec<Coupling>,
}

/// A free particle that two rods share.
struct Coupling {
    place: usize,
    rods: [usize; 2],
    particle: usize,
    /// 1 where both rods begin or both end there, else -1.
    sign: f64,
}

/// Directions, lengths and the factor at one position.
pub(crate) struct Factor {
    /// Unit vectors from each rod's first end to its second.
    pub directions: Vec<[f64; 3]>,
    /// Distances of the ends, m.
    pub lengths: Vec<f64>,
    values: Vec<f64>,
    factor: Vec<f64>,
    memory: MemBuffer,
}

/// Why there is no factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum NoFactor {
    /// The ends of this rod are in one place.
    NoDirection(usize),
    /// The row of this rod depends on other rows.
    Dependent(usize),
}

impl Gram {
    /// `free` tells which particles can move; a rod has at least one that can.
    pub fn new(ends: Vec<[usize; 2]>, particles: usize, free: impl Fn(usize) -> bool) -> Self {
        let mut at: Vec<Vec<usize>> = vec![Vec::new(); particles];
        for (rod, ends) in ends.iter().enumerate() {
            for end in ends {
                at[*end].push(rod);
            }
        }
        let shared = (0..particles).filter(|p| free(*p)).flat_map(|particle| {
            let rods = &at[particle];
            let pairs = rods.iter().enumerate();
            pairs.flat_map(move |(k, low)| {
                rods[k + 1..]
                    .iter()
                    .map(move |high| (*low, *high, particle))
            })
        });
        let mut shared: Vec<(usize, usize, usize)> = shared.collect();
        shared.sort_unstable();
        let (mut starts, mut rows) = (vec![0], Vec::new());
        let mut couplings = Vec::with_capacity(shared.len());
        let mut next = shared.into_iter().peekable();
        for column in 0..ends.len() {
            rows.push(column);
            while let Some((low, high, particle)) = next.next_if(|(low, ..)| *low == column) {
                if rows.last() != Some(&high) {
                    rows.push(high);
                }
                let first = |rod: usize| ends[rod][0] == particle;
                couplings.push(Coupling {
                    place: rows.len() - 1,
                    rods: [low, high],
                    particle,
                    sign: if first(low) == first(high) { 1.0 } else { -1.0 },
                });
            }
            starts.push(rows.len());
        }
        let size = ends.len();
        let places = SymbolicSparseColMatRef::new_checked(size, size, &starts, None, &rows);
        // Single columns: their diagonals are the pivots, which tell which rod depends on others.
        let columns = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SIMPLICIAL,
            ..Default::default()
        };
        let symbolic =
            factorize_symbolic_cholesky(places, Side::Lower, SymmetricOrdering::Amd, columns);
        Self {
            // It fails only where memory or indices run out, as a vector does.
            symbolic: symbolic.expect("memory for the places of a sparse matrix"),
            ends,
            starts,
            rows,
            couplings,
        }
    }

    /// Memory for a factor.
    pub fn room(&self) -> Factor {
        let rods = self.ends.len();
        let scratch = self
            .symbolic
            .factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default())
            .or(self.symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        Factor {
            directions: vec![[0.0; 3]; rods],
            lengths: vec![0.0; rods],
            values: vec![0.0; self.rows.len()],
            factor: vec![0.0; self.symbolic.len_val()],
            memory: MemBuffer::new(scratch),
        }
    }

    /// Overwrites directions and lengths.
    pub fn look(&self, x: &[f64], found: &mut Factor) {
        let each = found.directions.iter_mut().zip(&mut found.lengths);
        for ([i, j], (direction, length)) in self.ends.iter().zip(each) {
            let d = [0, 1, 2].map(|axis| x[3 * j + axis] - x[3 * i + axis]);
            // hypot neither overflows nor loses tiny distances.
            *length = d[0].hypot(d[1]).hypot(d[2]);
            *direction = d.map(|d| d / *length);
        }
    }

    /// Overwrites directions, lengths and the factor with those at `x`; `weight` is 1/m of a particle, 0 where it is
    /// fixed. Pivots at or below `least` of their diagonal entry count as 0.
    pub fn factorise(
        &self,
        x: &[f64],
        weight: impl Fn(usize) -> f64,
        least: f64,
        found: &mut Factor,
    ) -> Result<(), NoFactor> {
        self.look(x, found);
        let short = |length: &f64| !(*length > 0.0 && length.is_finite());
        if let Some(rod) = found.lengths.iter().position(short) {
            return Err(NoFactor::NoDirection(rod));
        }
        self.fill(&found.directions, &weight, &mut found.values);
        let original = |at: usize| match self.symbolic.perm() {
            Some(perm) => perm.arrays().0[at],
            None => at,
        };
        self.eliminate(found)
            .map_err(|at| NoFactor::Dependent(original(at)))?;
        let SymbolicCholeskyRaw::Simplicial(layout) = self.symbolic.raw() else {
            return Ok(());
        };
        for (at, start) in layout.col_ptr()[..self.ends.len()].iter().enumerate() {
            let rod = original(at);
            let pivot = found.factor[*start].powi(2);
            if pivot <= least * found.values[self.starts[rod]] {
                return Err(NoFactor::Dependent(rod));
            }
        }
        Ok(())
    }

    fn fill(&self, directions: &[[f64; 3]], weight: &impl Fn(usize) -> f64, values: &mut [f64]) {
        values.fill(0.0);
        for ([i, j], start) in self.ends.iter().zip(&self.starts) {
            values[*start] = weight(*i) + weight(*j);
        }
        for coupling in &self.couplings {
            let [k, l] = coupling.rods.map(|rod| directions[rod]);
            let cosine = k[0] * l[0] + k[1] * l[1] + k[2] * l[2];
            values[coupling.place] += coupling.sign * weight(coupling.particle) * cosine;
        }
    }

    /// The Cholesky factor of the values; else the column, in the order of elimination, whose pivot is not positive.
    fn eliminate(&self, found: &mut Factor) -> Result<(), usize> {
        let size = self.ends.len();
        let places =
            SymbolicSparseColMatRef::new_checked(size, size, &self.starts, None, &self.rows);
        let factor = self.symbolic.factorize_numeric_llt(
            &mut found.factor,
            SparseColMatRef::new(places, &found.values),
            Side::Lower,
            Default::default(),
            Par::Seq,
            MemStack::new(&mut found.memory),
            Default::default(),
        );
        factor.map(|_| ()).map_err(|error| match error {
            LltError::NonPositivePivot { index } => index - 1,
        })
    }

    /// Overwrites `y` with the solution of (G W Gᵀ) z = y.
    pub fn solve(&self, found: &mut Factor, y: &mut [f64]) {
        let size = y.len();
        LltRef::new(&self.symbolic, &found.factor).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(y, size, 1),
            Par::Seq,
            MemStack::new(&mut found.memory),
        );
    }

    /// The rods that depend on each other at `x`, one of which [`factorise`](Self::factorise) found: a vector of
    /// multipliers that pull on nothing, by inverse iteration.
    pub fn dependent(&self, x: &[f64], weight: impl Fn(usize) -> f64) -> Vec<usize> {
        let mut found = self.room();
        self.look(x, &mut found);
        self.fill(&found.directions, &weight, &mut found.values);
        // With this shift the matrix is definite, and its null vectors still outgrow all others.
        for start in &self.starts[..self.ends.len()] {
            found.values[*start] *= 1.0 + 1e-9;
        }
        if self.eliminate(&mut found).is_err() {
            return Vec::new();
        }
        // Ascending numbers are in no symmetry of a scene.
        let mut null: Vec<f64> = (0..self.ends.len()).map(|rod| 1.0 + rod as f64).collect();
        for _ in 0..3 {
            self.solve(&mut found, &mut null);
            let largest = null.iter().fold(0.0, |most: f64, c| most.max(c.abs()));
            null.iter_mut().for_each(|c| *c /= largest);
        }
        let belongs = |(rod, c): (usize, &f64)| (c.abs() > BELONGS).then_some(rod);
        null.iter().enumerate().filter_map(belongs).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_factor_of_a_chain_has_no_more_entries_than_its_matrix() {
        // Numbered along the chain or at random: elimination from the ends fills nothing in.
        for step in [1, 3] {
            let at = |i: usize| i * step % 1001;
            let ends = (0..1000).map(|i| [at(i), at(i + 1)]).collect();
            let gram = Gram::new(ends, 1001, |particle| particle != 0);
            assert_eq!(gram.rows.len(), 1999);
            assert_eq!(gram.symbolic.len_val(), 1999);
        }
    }
}
