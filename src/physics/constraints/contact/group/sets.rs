//! Which particles depend on each other.

use super::super::{Against, Beside, Obstacles};
use super::Group;
use crate::joined::least_joined;
use crate::physics::State;
use crate::physics::constraints::Rods;
use std::collections::BTreeMap;

/// The most particles whose contacts depend on each other: what these take grows as the cube of their number.
pub const MOST: usize = 128;

/// More particles than [`MOST`] touch each other, or are joined by rods while something touches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "{particles} particles touch each other, or are joined by rods while something touches: at most {MOST} can be held at \
     once"
)]
pub struct TooManyTouch {
    pub particles: usize,
}

/// The groups of particles that touch each other, or that rods join: their contacts are taken out of `resting`, but for
/// those of particles that nothing joins in the end.
pub(in super::super) fn grouped(
    obstacles: &Obstacles,
    rods: Option<&Rods>,
    resting: &mut Vec<Beside>,
    state: &State,
    a: &[f64],
) -> Result<Vec<Group>, TooManyTouch> {
    let contacts = resting.iter().filter_map(|beside| match beside.against {
        Against::Particle(other) => Some([beside.particle, other]),
        Against::Obstacle(_) => None,
    });
    let joined = rods.map_or(&[][..], |rods| rods.ends());
    let free = |ends: &[usize; 2]| ends.iter().all(|end| obstacles.weights[*end] > 0.0);
    let pairs: Vec<[usize; 2]> = contacts
        .chain(joined.iter().copied().filter(free))
        .collect();
    // A rod to a fixed particle makes a group of one.
    let alone = joined.iter().filter(|ends| !free(ends)).flatten();
    let alone = alone.filter(|end| obstacles.weights[**end] > 0.0).copied();
    let sets = sets(obstacles.weights.len(), &pairs, alone);
    let mut groups = Vec::new();
    for particles in sets {
        if particles.len() > MOST {
            let particles = particles.len();
            return Err(TooManyTouch { particles });
        }
        let of_it = |beside: &Beside| particles.binary_search(&beside.particle).is_ok();
        let own: Vec<Beside> = resting.iter().filter(|one| of_it(one)).copied().collect();
        let group = Group::new(obstacles, rods, particles.clone(), &own, state, a);
        let pair = |beside: &Beside| matches!(beside.against, Against::Particle(_));
        let joins = group.has_rods() || group.contacts().any(pair);
        resting.retain(|one| !of_it(one) || (!joins && !pair(one)));
        if joins {
            groups.push(group);
        }
    }
    Ok(groups)
}

/// The sets of particles that pairs join, each ascending.
fn sets(count: usize, pairs: &[[usize; 2]], alone: impl Iterator<Item = usize>) -> Vec<Vec<usize>> {
    let mut within = vec![false; count];
    alone.for_each(|at| within[at] = true);
    for [i, j] in pairs {
        (within[*i], within[*j]) = (true, true);
    }
    let least = least_joined(count, pairs.iter().copied());
    let mut sets: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for at in (0..count).filter(|at| within[*at]) {
        sets.entry(least[at]).or_default().push(at);
    }
    sets.into_values().collect()
}
