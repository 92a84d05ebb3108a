//! The Jacobian of a system in the axes of particles that stay in contact.

use super::super::member::Reach;
use super::Held;
use crate::physics::{Derivative, Jacobian, Triplets};
use smallvec::smallvec;
use std::collections::BTreeMap;

impl Held<'_> {
    /// Adds a Jacobian in the axes of space, pairs in blocks, in the particles' own axes.
    pub(super) fn add_turned(&self, own: &Jacobian, exact: bool, out: &mut Jacobian) {
        for by in [Derivative::Position, Derivative::Velocity] {
            let mut entries = own.triplets(by).clone();
            for pair in own.pairs(by) {
                let turned = |end: &u32| {
                    let end = *end as usize;
                    self.member(end).is_some() || self.group(end).is_some()
                };
                if pair.ends.iter().any(turned) {
                    pair.for_each(|row, column, value| entries.push((row, column, value)));
                } else {
                    out.add_pair(by, pair.ends.map(|end| end as usize), pair.block);
                }
            }
            let place = match by {
                Derivative::Position => &mut out.position,
                Derivative::Velocity => &mut out.velocity,
            };
            self.turned(&entries, exact, place);
        }
    }

    /// The entries of a Jacobian in the particles' own axes: those between two particles are summed before they are turned.
    fn turned(&self, entries: &Triplets, exact: bool, out: &mut Triplets) {
        let place = |(row, column, _): &&(usize, usize, f64)| [row / 3, column / 3];
        let mut sorted: Vec<&(usize, usize, f64)> = entries.iter().collect();
        sorted.sort_by_key(place);
        for own in sorted.chunk_by(|one, other| place(one) == place(other)) {
            let mut block = [[0.0; 3]; 3];
            for (row, column, value) in own {
                block[row % 3][column % 3] += value;
            }
            self.turn_block(place(&own[0]), &block, exact, out);
        }
    }

    /// Adds a block of forces of a particle by coordinates of another.
    fn turn_block(&self, ends: [usize; 2], block: &[[f64; 3]; 3], exact: bool, out: &mut Triplets) {
        let [from, to] = ends;
        let own = |particle: usize, each: &dyn Fn(usize) -> Reach| {
            [0, 1, 2].map(|axis| each(3 * particle + axis))
        };
        let rows = own(from, &|row| match (self.member(from), self.group(from)) {
            (Some(member), _) => member.rows(row, exact && self.friction),
            (_, Some(group)) => group.rows(row, exact).into(),
            _ => smallvec![(row, 1.0)],
        });
        let columns = own(to, &|column| match (self.member(to), self.group(to)) {
            (Some(member), _) => member.columns(column),
            (_, Some(group)) => group.columns(column).into(),
            _ => smallvec![(column, 1.0)],
        });
        // A row of its own is reached from all three axes of space.
        let each = |add: &mut dyn FnMut(usize, usize, f64)| {
            for (rows, block) in rows.iter().zip(block) {
                for (columns, value) in columns.iter().zip(block) {
                    for (row, by) in rows {
                        for (column, along) in columns {
                            add(*row, *column, by * along * value);
                        }
                    }
                }
            }
        };
        if ends.iter().all(|one| self.group(*one).is_none()) {
            let mut sums = [[0.0; 3]; 3];
            each(&mut |row, column, value| sums[row % 3][column % 3] += value);
            for (row, sums) in sums.into_iter().enumerate() {
                for (column, sum) in sums.into_iter().enumerate() {
                    out.push((3 * from + row, 3 * to + column, sum));
                }
            }
            return;
        }
        let mut sums: BTreeMap<(usize, usize), f64> = BTreeMap::new();
        each(&mut |row, column, value| *sums.entry((row, column)).or_default() += value);
        let sums = sums.into_iter();
        out.extend(sums.map(|((row, column), value)| (row, column, value)));
    }
}
