//! What a closed form is asked for, and the independent groups it falls into.

use crate::physics::{ParticleSystem, State};
use crate::scene::{DampingModel, Scene, Spring};
use nalgebra::Vector3;

/// A scene from t = 0 to `until`.
pub(super) struct Problem<'a> {
    pub scene: &'a Scene,
    pub start: State,
    pub until: f64,
    /// The scene's size, m.
    pub size: f64,
    /// Acceleration of gravity, m/s².
    gravity: Vector3<f64>,
    /// Wind on each free particle, N.
    wind: Vector3<f64>,
}

impl<'a> Problem<'a> {
    pub fn new(scene: &'a Scene, until: f64) -> Self {
        let mut gravity = Vector3::zeros();
        gravity[scene.up.index()] = scene.solver.gravity;
        let wind = scene.wind.as_ref();
        Self {
            scene,
            start: ParticleSystem::initial_state(scene),
            until,
            size: scene.size(),
            gravity,
            wind: wind.map_or(Vector3::zeros(), |w| {
                w.strength * Vector3::from(w.direction)
            }),
        }
    }

    pub fn position(&self, particle: usize) -> Vector3<f64> {
        self.scene.particles[particle].position.into()
    }

    pub fn velocity(&self, particle: usize) -> Vector3<f64> {
        Vector3::from_fn(|axis, _| self.start.v[3 * particle + axis])
    }

    /// Acceleration of a particle under constant forces alone: the same bits for equal masses, and
    /// without wind for all.
    pub fn constant(&self, particle: usize) -> Vector3<f64> {
        self.gravity + self.wind / self.scene.particles[particle].mass
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
            let group = &mut groups[group_of[root]];
            group.links.push(Link {
                spring,
                ends: spring.ends.map(|end| group.free.binary_search(&end).ok()),
                between: self.position(b) - self.position(a),
            });
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
    pub links: Vec<Link<'a>>,
}

/// A spring and damper of a group.
#[derive(Debug, Clone, Copy)]
pub(super) struct Link<'a> {
    pub spring: &'a Spring,
    /// Where in `free` its ends stand; None is a fixed end.
    pub ends: [Option<usize>; 2],
    /// From its first end to its second at the start, m.
    pub between: Vector3<f64>,
}

impl Group<'_> {
    /// Whether a spring ties it to something fixed.
    pub fn is_anchored(&self) -> bool {
        self.links.iter().any(|l| l.ends.contains(&None))
    }

    /// Whether every force is linear wherever the particles are: no spring has a rest length, and no
    /// damper a direction.
    pub fn is_linear(&self, model: DampingModel) -> bool {
        let damped = self.links.iter().any(|l| l.spring.damping > 0.0);
        (model == DampingModel::Isotropic || !damped)
            && !self.links.iter().any(Link::has_rest_length)
    }
}

impl Link<'_> {
    /// Whether the spring pulls towards a length other than 0.
    pub fn has_rest_length(&self) -> bool {
        self.spring.stiffness > 0.0 && self.spring.rest_length > 0.0
    }
}
