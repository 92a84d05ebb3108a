//! What a closed form is asked for, and the independent groups it falls into.

use crate::scene::{Scene, Spring};
use crate::system::{ParticleSystem, State};

/// A scene from t = 0 to `until`.
pub(super) struct Problem<'a> {
    pub scene: &'a Scene,
    pub start: State,
    pub until: f64,
    /// The scene's size, m.
    pub size: f64,
    /// Acceleration of gravity, m/s².
    gravity: [f64; 3],
    /// Wind on each free particle, N.
    wind: [f64; 3],
}

impl<'a> Problem<'a> {
    pub fn new(scene: &'a Scene, until: f64) -> Self {
        let mut gravity = [0.0; 3];
        gravity[scene.up.index()] = scene.solver.gravity;
        let wind = scene.wind.as_ref();
        Self {
            scene,
            start: ParticleSystem::initial_state(scene),
            until,
            size: scene.size(),
            gravity,
            wind: wind.map_or([0.0; 3], |w| w.direction.map(|d| w.strength * d)),
        }
    }

    pub fn position(&self, particle: usize) -> [f64; 3] {
        self.scene.particles[particle].position
    }

    pub fn velocity(&self, particle: usize) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.start.v[3 * particle + axis])
    }

    /// Acceleration of a particle under constant forces alone: the same bits for equal masses, and
    /// without wind for all.
    pub fn constant(&self, particle: usize) -> [f64; 3] {
        let mass = self.scene.particles[particle].mass;
        [0, 1, 2].map(|axis| self.gravity[axis] + self.wind[axis] / mass)
    }

    /// Whether this spring or damper can move anything.
    fn acts(&self, spring: &Spring) -> bool {
        let fixed = |end: &usize| self.scene.particles[*end].fixed;
        (spring.stiffness > 0.0 || spring.damping > 0.0) && !spring.ends.iter().all(fixed)
    }

    /// Free particles that springs join, directly or through one another; fixed ones join nothing.
    /// In order of their first particle.
    pub fn groups(&self) -> Vec<Group<'a>> {
        let scene = self.scene;
        let free = |i: usize| !scene.particles[i].fixed;
        let mut parent: Vec<usize> = (0..scene.particles.len()).collect();
        let springs: Vec<&Spring> = scene.springs.iter().filter(|s| self.acts(s)).collect();
        for spring in &springs {
            let [a, b] = spring.ends;
            if free(a) && free(b) {
                let (a, b) = (root(&mut parent, a), root(&mut parent, b));
                parent[a.max(b)] = a.min(b);
            }
        }
        let mut groups: Vec<Group> = Vec::new();
        let mut group_of = vec![usize::MAX; parent.len()];
        for i in (0..parent.len()).filter(|&i| free(i)) {
            let root = root(&mut parent, i);
            if group_of[root] == usize::MAX {
                group_of[root] = groups.len();
                groups.push(Group::default());
            }
            groups[group_of[root]].free.push(i);
        }
        for spring in springs {
            let [a, b] = spring.ends;
            let root = root(&mut parent, if free(a) { a } else { b });
            groups[group_of[root]].springs.push(spring);
        }
        groups
    }
}

/// The representative of a particle's group, halving the path to it.
fn root(parent: &mut [usize], mut i: usize) -> usize {
    while parent[i] != i {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    i
}

/// Particles that move independently of all others, and the springs that act on them.
#[derive(Debug, Clone, Default)]
pub(super) struct Group<'a> {
    /// Ascending.
    pub free: Vec<usize>,
    pub springs: Vec<&'a Spring>,
}

impl Group<'_> {
    /// Where in `free` a particle stands; None for a fixed one.
    pub fn place(&self, particle: usize) -> Option<usize> {
        self.free.binary_search(&particle).ok()
    }

    /// Whether a spring ties it to something fixed.
    pub fn is_anchored(&self) -> bool {
        let fixed = |end: &usize| self.place(*end).is_none();
        self.springs.iter().any(|s| s.ends.iter().any(fixed))
    }

    pub fn is_damped(&self) -> bool {
        self.springs.iter().any(|s| s.damping > 0.0)
    }
}
