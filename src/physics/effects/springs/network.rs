//! Springs laid out for the kernel: one array a quantity, cut at particles so that threads share
//! nothing.

use crate::scene::Spring;
use std::ops::Range;

/// A network this large is cut, if its numbering allows. Smaller ones are faster on one thread.
const CUT_FROM: usize = 1 << 14;

/// How many parts are tried, most first: several a thread even out their loads.
const PARTS: [usize; 4] = [32, 16, 8, 4];

/// A cut that more than one spring in so many crosses is not worth its copies.
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

/// What one task computes: the forces on some neighbouring particles.
#[derive(Debug)]
pub(super) struct Part {
    /// Whose forces these are.
    pub particles: Range<usize>,
    /// All springs with an end there, in the order of the scene. One that leads to another part is
    /// in both, and each adds to its own end.
    pub table: Table,
}

/// All springs, part by part. However many parts there are, every particle sums its forces in the
/// order of the scene's springs.
#[derive(Debug)]
pub(super) struct Network {
    /// Ordered; they cover all particles.
    pub parts: Vec<Part>,
    /// Springs, each counted once.
    pub members: usize,
}

impl Table {
    /// With room for so many springs and no more.
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
    /// Of these springs between so many particles; `damped` when any has a damper.
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

    /// Each spring once, its linear part alone, in an order that depends on the network alone: that of the scene, unless
    /// the network is cut.
    pub fn springs(&self) -> impl Iterator<Item = Spring> {
        self.parts.iter().flat_map(|part| {
            let own = |spring: &Spring| part.particles.contains(&spring.ends[0]);
            part.table.iter().filter(own)
        })
    }
}

/// Hands every spring to the one or two parts of its ends.
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

/// Where each part begins, 0 first: about as many spring ends in each. Depends on the network
/// alone, never on the number of threads.
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
        let share = (2 * springs.len()).div_ceil(parts);
        let mut cuts = whole.clone();
        let mut before = 0;
        for (particle, &ends) in ends_at.iter().enumerate() {
            if before >= share * cuts.len() {
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
