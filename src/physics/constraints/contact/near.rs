//! The broad phase: which particles may touch what, by boxes around their paths (parry's BVH).
//!
//! Boxes are larger than paths, so that they serve for many steps. What is found is a superset of what touches, in an order
//! that does not depend on the boxes.

use super::{Against, Obstacle, Obstacles};
use parry3d::bounding_volume::{Aabb, BoundingVolume};
use parry3d::math::Vector;
use parry3d::partitioning::{Bvh, BvhBuildStrategy};
use std::sync::Arc;

/// Boxes are larger than a path by so many of it.
const AHEAD: f64 = 32.0;
/// And by this part of the radius.
const WIDER: f64 = 1e-2;

/// What may touch while particles stay within their boxes.
#[derive(Debug, Default)]
pub struct Near {
    /// Of each particle's centre; empty before the first search.
    boxes: Vec<Aabb>,
    /// From when until when it holds, s.
    times: [f64; 2],
    /// Of each particle, ascending.
    against: Vec<Vec<Against>>,
}

impl Near {
    /// A particle and what it may touch, ascending; of two particles the smaller is the first.
    pub fn pairs(&self) -> impl Iterator<Item = (usize, Against)> + '_ {
        let each = self.against.iter().enumerate();
        let pairs = each.flat_map(|(particle, all)| all.iter().map(move |one| (particle, *one)));
        pairs.filter(|(particle, against)| match against {
            Against::Particle(other) => particle < other,
            Against::Obstacle(_) => true,
        })
    }

    /// Whether a cube that a particle keeps within, its centre and half a side in metres, is within its box.
    #[inline]
    pub fn holds(&self, particle: usize, (center, half): ([f64; 3], f64)) -> bool {
        let [low, high]: [[f64; 3]; 2] =
            [self.boxes[particle].mins, self.boxes[particle].maxs].map(Into::into);
        (0..3).all(|c| low[c] <= center[c] - half && center[c] + half <= high[c])
    }

    /// What a particle may touch, ascending.
    pub fn of(&self, particle: usize) -> &[Against] {
        &self.against[particle]
    }
}

/// The last search, and the tree of obstacles that do not move.
#[derive(Debug, Default)]
pub(super) struct Broad {
    last: Arc<Near>,
    /// With the obstacle of each leaf: parry wants leaves numbered from 0.
    still: Option<(Bvh, Vec<usize>)>,
}

impl Broad {
    pub fn near(
        &mut self,
        obstacles: &Obstacles,
        times: [f64; 2],
        cube: &impl Fn(usize) -> ([f64; 3], f64),
    ) -> Arc<Near> {
        let last = &self.last;
        let lasting =
            !obstacles.any_moves() || (last.times[0] <= times[0] && times[1] <= last.times[1]);
        let within = |particle: usize| last.holds(particle, cube(particle));
        if lasting && !last.boxes.is_empty() && obstacles.particles().all(within) {
            return Arc::clone(last);
        }
        let [from, until] = times;
        let ahead = [from, until + AHEAD * (until - from)];
        let boxed = |particle: usize| {
            let (center, half) = cube(particle);
            let wider = WIDER * obstacles.radii[particle].max(0.0) + obstacles.close(center);
            around(center, (1.0 + AHEAD) * half + wider)
        };
        let boxes: Vec<Aabb> = (0..obstacles.weights.len()).map(boxed).collect();
        if self.still.is_none() || obstacles.any_moves() {
            let each = obstacles.obstacles.iter().enumerate();
            let leaves = each.filter_map(|(at, one)| Some((at, swept(one, ahead)?)));
            let (numbers, leaves): (Vec<usize>, Vec<Aabb>) = leaves.unzip();
            let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &leaves);
            self.still = Some((tree, numbers));
        }
        self.last = Arc::new(Near {
            against: found(obstacles, &boxes, ahead, self.still.as_ref()),
            boxes,
            times: ahead,
        });
        Arc::clone(&self.last)
    }
}

/// What each particle may touch.
fn found(
    obstacles: &Obstacles,
    boxes: &[Aabb],
    times: [f64; 2],
    tree: Option<&(Bvh, Vec<usize>)>,
) -> Vec<Vec<Against>> {
    let wide = |particle: usize| boxes[particle].loosened(obstacles.radii[particle].max(0.0));
    let mut all: Vec<Vec<Against>> = vec![Vec::new(); boxes.len()];
    let planes = obstacles.obstacles.iter().enumerate();
    let planes: Vec<_> = planes
        .filter(|(_, one)| one.shape.bounds().is_none())
        .collect();
    for particle in obstacles.particles() {
        let (own, about) = (&mut all[particle], wide(particle));
        let half = about.half_extents();
        own.extend(planes.iter().filter_map(|(at, one)| {
            let away = one.distance(times[0], about.center().into());
            let reach = half.length() + one.reach(times[0], times[1]);
            (away <= reach).then_some(Against::Obstacle(*at))
        }));
        if let Some((tree, numbers)) = tree {
            let leaves = tree.intersect_aabb(&about);
            own.extend(leaves.map(|leaf| Against::Obstacle(numbers[leaf as usize])));
        }
    }
    if obstacles.among_particles() {
        let leaves: Vec<Aabb> = (0..boxes.len()).map(wide).collect();
        let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &leaves);
        for particle in obstacles.particles() {
            let others = tree
                .intersect_aabb(&leaves[particle])
                .map(|leaf| leaf as usize);
            all[particle].extend(others.filter_map(|other| {
                let collide = other != particle
                    && obstacles.weights[other] > 0.0
                    && obstacles.joined_to(particle).binary_search(&other).is_err();
                collide.then_some(Against::Particle(other))
            }));
        }
    }
    for own in &mut all {
        own.sort_unstable();
        own.dedup();
    }
    all
}

/// A cube.
fn around(center: [f64; 3], half: f64) -> Aabb {
    Aabb::from_half_extents(center.into(), Vector::splat(half))
}

/// The box around all places of an obstacle between two times; None of a plane.
fn swept(one: &Obstacle, [from, until]: [f64; 2]) -> Option<Aabb> {
    let own = one.shape.bounds()?.translated(one.moved(from)[0].into());
    Some(own.loosened(one.reach(from, until)))
}
