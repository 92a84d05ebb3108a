//! What of a scene a picture shows: all of it, or where that is too much, near particles as one.

use crate::report::words;
use crate::scene::Scene;
use std::collections::{HashMap, HashSet};

/// The most bytes that the members of a picture take.
const BYTES: usize = 280_000;

/// What a particle is to the eye.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kind {
    Free,
    Fixed,
    Driven,
    /// Fixed, and touched by hinges alone: it holds the direction of a clamp.
    Clamp,
}

/// Members of a scene, by the ids of particles that stand for themselves and those near them.
#[derive(Default)]
pub struct Drawn {
    /// Particles with their kinds.
    pub particles: Vec<(usize, Kind)>,
    pub springs: Vec<[usize; 2]>,
    pub rods: Vec<[usize; 2]>,
    pub attractions: Vec<[usize; 2]>,
    pub triangles: Vec<[usize; 3]>,
    /// The middle particles of hinges.
    pub hinges: Vec<usize>,
}

impl Drawn {
    /// Of a scene with its particles at these places, in these ranges along x and y, drawn `times` times.
    pub fn new(scene: &Scene, places: &[[f64; 2]], ranges: [[f64; 2]; 2], times: usize) -> Self {
        let kinds = kinds(scene);
        let alone: Vec<usize> = (0..kinds.len()).collect();
        let mut drawn = Self::of(scene, &kinds, &alone);
        let mut across = 128.0;
        while drawn.bytes() * times > BYTES && across >= 2.0 {
            let nearest = merged(places, &kinds, ranges, across);
            drawn = Self::of(scene, &kinds, &nearest);
            across *= 0.9;
        }
        drawn
    }

    pub fn of_kind(&self, kind: Kind) -> impl Iterator<Item = usize> {
        let particles = self.particles.iter().filter(move |(_, of)| *of == kind);
        particles.map(|(id, _)| *id)
    }

    /// What the picture says of particles that are not drawn, out of so many; empty where all are.
    pub fn note(&self, count: usize) -> String {
        let drawn = self.particles.len();
        if drawn == count {
            return String::new();
        }
        let [drawn, count] = [drawn, count].map(|count| words::count(count as u64));
        format!(
            "{drawn} of {count} particles are drawn. Each stands for those near it, and the springs between two for one."
        )
    }

    /// The members between the particles that stand for each.
    fn of(scene: &Scene, kinds: &[Kind], stands: &[usize]) -> Self {
        let pairs = |ends: [usize; 2]| {
            let [a, b] = ends.map(|end| stands[end]);
            ([a.min(b), a.max(b)], [a, b])
        };
        let corners = |corners: [usize; 3]| {
            let corners = corners.map(|corner| stands[corner]);
            let mut sorted = corners;
            sorted.sort_unstable();
            (sorted, corners)
        };
        let particles = stands
            .iter()
            .enumerate()
            .filter(|(id, stands)| id == *stands);
        Self {
            particles: particles.map(|(id, _)| (id, kinds[id])).collect(),
            springs: distinct(scene.springs.iter().map(|spring| pairs(spring.ends))),
            rods: distinct(scene.rods.iter().map(|rod| pairs(rod.ends))),
            attractions: distinct(scene.gravitational.iter().map(|pair| pairs(pair.ends))),
            triangles: distinct(scene.triangles.iter().map(|t| corners(t.corners))),
            hinges: distinct(scene.bending.iter().map(|hinge| {
                let middle = stands[hinge.particles[1]];
                ([middle], middle)
            })),
        }
    }

    /// A bound on its text in SVG: coordinates have at most five characters.
    fn bytes(&self) -> usize {
        let particle = |(_, kind): &(usize, Kind)| if *kind == Kind::Free { 15 } else { 90 };
        let particles: usize = self.particles.iter().map(particle).sum();
        let lines = self.springs.len() + self.rods.len() + self.attractions.len();
        particles + 25 * lines + 40 * self.triangles.len() + 15 * self.hinges.len()
    }
}

fn kinds(scene: &Scene) -> Vec<Kind> {
    let kind = |fixed| if fixed { Kind::Clamp } else { Kind::Free };
    let mut kinds: Vec<Kind> = scene.particles.iter().map(|p| kind(p.fixed)).collect();
    let hinged: HashSet<usize> = scene
        .bending
        .iter()
        .flat_map(|hinge| hinge.particles)
        .collect();
    let springs = scene.springs.iter().flat_map(|spring| spring.ends);
    let rods = scene.rods.iter().flat_map(|rod| rod.ends);
    let attractions = scene.gravitational.iter().flat_map(|pair| pair.ends);
    let triangles = scene.triangles.iter().flat_map(|triangle| triangle.corners);
    let others = (0..kinds.len()).filter(|id| !hinged.contains(id));
    for id in springs
        .chain(rods)
        .chain(attractions)
        .chain(triangles)
        .chain(others)
    {
        if kinds[id] == Kind::Clamp {
            kinds[id] = Kind::Fixed;
        }
    }
    for driven in &scene.driven {
        kinds[driven.particle] = Kind::Driven;
    }
    kinds
}

/// For each particle the one of its kind that is nearest to the same node of a grid over the ranges, with so many
/// cells along the longer. Nodes lie on the edges, so that what is drawn reaches as far as all.
fn merged(places: &[[f64; 2]], kinds: &[Kind], ranges: [[f64; 2]; 2], across: f64) -> Vec<usize> {
    let extents = ranges.map(|[low, high]| high - low);
    let size = f64::max(extents[0], extents[1]);
    let cells = extents.map(|extent| (across * extent / size).round().max(1.0));
    // Off the node, in cells.
    let node = |place: &[f64; 2]| {
        let at = [0, 1]
            .map(|i| cells[i] * (place[i] - ranges[i][0]) / extents[i].max(f64::MIN_POSITIVE));
        let node = at.map(f64::round);
        (
            node.map(|along| along as i64),
            f64::hypot(at[0] - node[0], at[1] - node[1]),
        )
    };
    let nodes: Vec<_> = places.iter().map(node).collect();
    let mut nearest: HashMap<([i64; 2], Kind), usize> = HashMap::new();
    for (id, ((node, off), kind)) in nodes.iter().zip(kinds).enumerate() {
        let at = nearest.entry((*node, *kind)).or_insert(id);
        if *off < nodes[*at].1 {
            *at = id;
        }
    }
    let each = nodes.iter().zip(kinds).enumerate();
    each.map(|(id, ((node, _), kind))| *nearest.get(&(*node, *kind)).unwrap_or(&id))
        .collect()
}

/// Each once, in the order they first come, without those whose key has equal parts.
fn distinct<const N: usize, T>(members: impl Iterator<Item = ([usize; N], T)>) -> Vec<T> {
    let mut seen = HashSet::new();
    let new = members.filter(|(key, _)| key.windows(2).all(|w| w[0] != w[1]) && seen.insert(*key));
    new.map(|(_, member)| member).collect()
}
