//! The facts a file must fit: the scene's particles and the step its times are counted in.

use crate::scene::Scene;

/// The scene as a trajectory file sees it. What a file may leave out is filled in from here.
#[derive(Debug, Clone, PartialEq)]
pub struct Expected {
    /// Length of a step, s.
    pub(super) timestep: f64,
    /// Positions at the start, 3 a particle, m: what a file does not say of fixed ones.
    pub(super) start: Vec<f64>,
    /// Whether each particle is fixed.
    pub(super) fixed: Vec<bool>,
    pub(super) free_axis: Option<FreeAxis>,
}

/// The only coordinate that moves, in a scene where one particle moves on one axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FreeAxis {
    pub particle: usize,
    /// 0, 1 or 2.
    pub axis: usize,
}

impl FreeAxis {
    /// Its index among all coordinates of a state.
    pub fn coordinate(self) -> usize {
        3 * self.particle + self.axis
    }
}

impl Expected {
    /// `timestep` in seconds: the scene's own, or another one given.
    pub fn new(scene: &Scene, timestep: f64) -> Self {
        Self {
            timestep,
            start: scene.particles.iter().flat_map(|p| p.position).collect(),
            fixed: scene.particles.iter().map(|p| p.fixed).collect(),
            free_axis: free_axis(scene),
        }
    }

    pub(super) fn particles(&self) -> usize {
        self.fixed.len()
    }

    /// Ids of the free particles, ascending.
    pub(super) fn free(&self) -> Vec<usize> {
        (0..self.particles())
            .filter(|&id| !self.fixed[id])
            .collect()
    }

    /// The particle that rows without an id are about: the scene's only one, or its only free one.
    pub(super) fn only(&self) -> Option<usize> {
        match self.free()[..] {
            [id] => Some(id),
            _ => None,
        }
    }
}

/// The one coordinate that can move: exactly one particle is free, and its velocity, gravity, wind,
/// its springs and attractions all lie on one coordinate axis. None where nothing moves it at all,
/// since no axis is then better than another.
pub fn free_axis(scene: &Scene) -> Option<FreeAxis> {
    let mut free = (0..).zip(&scene.particles).filter(|(_, p)| !p.fixed);
    let ((particle, own), None) = (free.next()?, free.next()) else {
        return None;
    };
    // Effects of strength 0 pull nowhere.
    let springs = scene
        .springs
        .iter()
        .filter(|s| s.stiffness != 0.0 || s.cubic != 0.0 || s.damping != 0.0)
        .map(|s| s.ends);
    let pairs = scene.gravitational.iter().filter(|pair| pair.g != 0.0);
    let lines = springs
        .chain(pairs.map(|pair| pair.ends))
        .filter_map(|[a, b]| match particle {
            p if p == a => Some(b),
            p if p == b => Some(a),
            _ => None,
        })
        .map(|other| {
            let other = scene.particles[other].position;
            [0, 1, 2].map(|axis| other[axis] - own.position[axis])
        });
    let mut gravity = [0.0; 3];
    gravity[scene.up.index()] = scene.solver.gravity;
    let wind = scene.wind.iter().filter(|wind| wind.strength != 0.0);
    let mut moved = [false; 3];
    for direction in lines
        .chain(wind.map(|wind| wind.direction))
        .chain([gravity, own.velocity])
    {
        for axis in 0..3 {
            moved[axis] |= direction[axis] != 0.0;
        }
    }
    let axis = moved.iter().position(|&moves| moves)?;
    let others = moved.iter().filter(|&&moves| moves).count() - 1;
    (others == 0).then_some(FreeAxis { particle, axis })
}
