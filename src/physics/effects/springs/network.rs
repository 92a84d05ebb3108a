//! Springs laid out for the kernel: one array for each quantity, partitioned by particles so that threads
//! share nothing.

use crate::scene::Spring;
use std::ops::Range;

/// Networks of at least this many springs are partitioned, if their numbering allows. Smaller ones are
/// faster on one thread.
const CUT_FROM: usize = 1 << 14;

/// The numbers of parts that are tried, the largest first. Several parts a thread balance the load.
const PARTS: [usize; 4] = [32, 16, 8, 4];

/// A partition is rejected if more than one spring in this many lies in two parts, and so is copied.
const CROSSING: usize = 16;

/// Springs as parallel arrays: 24 bytes a spring, 32 with dampers.
#[derive(Debug, Default)]
pub(super) struct Table {
    /// Particle indices.
    pub ends: Vec<[u32; 2]>,
    /// k, N/m.
    pub stiffness: Vec<f64>,
    /// L, m.
    pub rest_length: Vec<f64>,
    /// c, N s/m; empty when no spring has a damper.
    pub damping: Vec<f64>,
}

/// The work of one task: the forces on a range of particles.
#[derive(Debug)]
pub(super) struct Part {
    /// The particles whose forces are computed.
    pub particles: Range<usize>,
    /// All springs with an end there, in the order of the scene. A spring between two parts is in both,
    /// and each part adds the force on its own end.
    pub table: Table,
}

/// All springs, part by part. However many parts there are, every particle sums its forces in the
/// order of the scene's springs.
#[derive(Debug)]
pub(super) struct Network {
    /// The parts in order; together they cover all particles.
    pub parts: Vec<Part>,
    /// The number of springs, each counted once.
    pub members: usize,
}

impl Table {
    /// An empty table with room for exactly this many springs.
    fn with_capacity(springs: usize, damped: bool) -> Self {
        Self {
            ends: Vec::with_capacity(springs),
            stiffness: Vec::with_capacity(springs),
            rest_length: Vec::with_capacity(springs),
            damping: Vec::with_capacity(if damped { springs } else { 0 }),
        }
    }

    fn push(&mut self, spring: &Spring, damped: bool) {
        self.ends.push(spring.ends.map(|end| end as u32));
        self.stiffness.push(spring.stiffness);
        self.rest_length.push(spring.rest_length);
        if damped {
            self.damping.push(spring.damping);
        }
    }

    fn iter(&self) -> impl Iterator<Item = Spring> {
        let quantities = self.ends.iter().zip(&self.stiffness).zip(&self.rest_length);
        let damping = self.damping.iter().copied().chain(std::iter::repeat(0.0));
        quantities
            .zip(damping)
            .map(|(((ends, &stiffness), &rest_length), damping)| Spring {
                ends: ends.map(|end| end as usize),
                stiffness,
                cubic: 0.0,
                damping,
                rest_length,
            })
    }
}

impl Network {
    /// The network of these springs; `particles` is the number of particles, and `damped` says whether any
    /// spring has a damper.
    pub fn new(springs: &[&Spring], particles: usize, damped: bool) -> Self {
        let cuts = cuts(springs, particles);
        let part_of = |end: usize| cuts.partition_point(|&cut| cut <= end) - 1;
        let bounds = cuts.iter().zip(cuts.iter().skip(1).chain([&particles]));
        let mut sizes = vec![0; cuts.len()];
        each_part(springs, part_of, |part, _| sizes[part] += 1);
        let mut parts: Vec<_> = bounds
            .zip(sizes)
            .map(|((&from, &to), size)| Part {
                particles: from..to,
                table: Table::with_capacity(size, damped),
            })
            .collect();
        each_part(springs, part_of, |part, spring| {
            parts[part].table.push(spring, damped);
        });
        Self {
            parts,
            members: springs.len(),
        }
    }

    /// Each spring once, without its cubic part. The order depends on the network alone: it is that of the
    /// scene, unless the network is partitioned.
    pub fn springs(&self) -> impl Iterator<Item = Spring> {
        self.parts.iter().flat_map(|part| {
            let own = |spring: &Spring| part.particles.contains(&spring.ends[0]);
            part.table.iter().filter(own)
        })
    }
}

/// Passes every spring to the one or two parts that its ends belong to.
fn each_part<'a>(
    springs: &[&'a Spring],
    part_of: impl Fn(usize) -> usize,
    mut put: impl FnMut(usize, &'a Spring),
) {
    for spring in springs {
        let [first, second] = spring.ends.map(&part_of);
        put(first, spring);
        if second != first {
            put(second, spring);
        }
    }
}

/// The first particle of each part, beginning with 0. Each part has about as many spring ends. The result
/// depends on the network alone, never on the number of threads.
fn cuts(springs: &[&Spring], particles: usize) -> Vec<usize> {
    let whole = vec![0];
    if springs.len() < CUT_FROM {
        return whole;
    }
    let mut ends_at = vec![0_u32; particles];
    for end in springs.iter().flat_map(|spring| spring.ends) {
        ends_at[end] += 1;
    }
    for parts in PARTS {
        let per_part = (2 * springs.len()).div_ceil(parts);
        let mut cuts = whole.clone();
        let mut before = 0;
        for (particle, &ends) in ends_at.iter().enumerate() {
            if before >= per_part * cuts.len() {
                cuts.push(particle);
            }
            before += ends as usize;
        }
        let part_of = |end: usize| cuts.partition_point(|&cut| cut <= end);
        let crosses = |spring: &&&Spring| {
            let [first, second] = spring.ends.map(part_of);
            first != second
        };
        if springs.iter().filter(crosses).count() * CROSSING <= springs.len() {
            return cuts;
        }
    }
    whole
}
