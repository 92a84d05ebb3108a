//! The facts a file must fit: the scene's particles and the step its times are counted in.

use crate::scene::{Drive, Scene};

/// The scene as a trajectory file sees it. What a file may leave out is filled in from here.
#[derive(Debug, Clone, PartialEq)]
pub struct Expected {
    /// Length of a step, s.
    pub(super) timestep: f64,
    /// Positions at the start, 3 a particle, m: what a file does not say of fixed ones.
    pub(super) start: Vec<f64>,
    /// The motions of driven particles: what a file does not say of those.
    pub(super) drives: Vec<Drive>,
    /// Whether each particle is fixed.
    pub(super) fixed: Vec<bool>,
    pub(super) free_axis: Option<FreeAxis>,
    /// The plane of two-dimensional data; None where all three coordinates are given.
    pub(super) plane: Option<Plane>,
    /// The axes on which anything can move.
    moves: [bool; 3],
}

/// The plane that two-dimensional data lies in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Plane {
    Xy,
    Xz,
    Yz,
}

/// The names of the axes, by their index.
pub(super) const AXES: [&str; 3] = ["x", "y", "z"];

impl Plane {
    pub const ALL: [Self; 3] = [Self::Xy, Self::Xz, Self::Yz];

    /// The names of both axes.
    pub fn name(self) -> &'static str {
        match self {
            Self::Xy => "xy",
            Self::Xz => "xz",
            Self::Yz => "yz",
        }
    }

    /// The two axes, ascending.
    pub fn axes(self) -> [usize; 2] {
        match self {
            Self::Xy => [0, 1],
            Self::Xz => [0, 2],
            Self::Yz => [1, 2],
        }
    }
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
            start: scene.starts().concat(),
            drives: scene.drives(),
            fixed: scene.particles.iter().map(|p| p.fixed).collect(),
            free_axis: free_axis(scene),
            plane: None,
            moves: moves(scene),
        }
    }

    /// Expects data of a plane: two coordinates a particle. The third stays where the scene has it.
    ///
    /// # Errors
    /// The third axis's name, if something in the scene moves particles along it.
    pub fn in_plane(self, plane: Plane) -> Result<Self, &'static str> {
        let axes = plane.axes();
        match (0..3).find(|axis| !axes.contains(axis) && self.moves[*axis]) {
            Some(axis) => Err(AXES[axis]),
            None => Ok(Self {
                plane: Some(plane),
                ..self
            }),
        }
    }

    /// The axes a file gives of each particle.
    pub(super) fn axes(&self) -> Vec<usize> {
        self.plane
            .map_or(vec![0, 1, 2], |plane| plane.axes().to_vec())
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

    /// The driven particles of which `given` is not true, as indices in `drives`.
    pub(super) fn left_out(&self, given: impl Fn(usize) -> bool) -> Vec<usize> {
        let drives = self.drives.iter().enumerate();
        let left_out = drives.filter(|(_, drive)| !given(drive.particle));
        left_out.map(|(at, _)| at).collect()
    }

    /// The particle that rows without an id are about: the scene's only one, or its only free one.
    pub(super) fn only(&self) -> Option<usize> {
        match self.free()[..] {
            [id] => Some(id),
            _ => None,
        }
    }
}

/// The one coordinate that can move: exactly one particle is free, and it moves on one axis. None
/// where nothing moves it at all, since no axis is then better than another.
pub fn free_axis(scene: &Scene) -> Option<FreeAxis> {
    let mut free = (0..).zip(&scene.particles).filter(|(_, p)| !p.fixed);
    let ((particle, _), None) = (free.next()?, free.next()) else {
        return None;
    };
    let moves = moves(scene);
    let axis = moves.iter().position(|&moves| moves)?;
    let others = moves.iter().filter(|&&moves| moves).count() - 1;
    (others == 0).then_some(FreeAxis { particle, axis })
}

/// The axes on which free particles can move: where their velocities, gravity, wind, moving air, motions of driven
/// ones, or their springs, rods, hinges and attractions have a component, and where a magnetic field turns such motion; on all
/// where the air drags at triangles, which turn.
fn moves(scene: &Scene) -> [bool; 3] {
    let starts = scene.starts();
    // Effects of strength 0 pull nowhere.
    let springs = scene
        .springs
        .iter()
        .filter(|s| s.stiffness != 0.0 || s.cubic != 0.0 || s.damping != 0.0)
        .map(|s| s.ends);
    let pairs = scene.gravitational.iter().filter(|pair| pair.g != 0.0);
    let hinges = scene.bending.iter();
    let hinges = hinges.filter(|h| h.stiffness != 0.0 || h.damping != 0.0);
    let hinges = hinges.flat_map(|h| {
        [
            [h.particles[0], h.particles[1]],
            [h.particles[1], h.particles[2]],
        ]
    });
    let lines = springs
        .chain(scene.rods.iter().map(|rod| rod.ends))
        .chain(pairs.map(|pair| pair.ends))
        .chain(hinges)
        .filter(|ends| ends.iter().any(|&end| !scene.particles[end].fixed))
        .map(|[a, b]| [0, 1, 2].map(|axis| starts[b][axis] - starts[a][axis]));
    let wind = scene.wind.iter().filter(|wind| wind.strength != 0.0);
    let free = || scene.particles.iter().filter(|p| !p.fixed);
    let velocities = free();
    let dragged = free().any(|p| p.drag != 0.0 || p.quadratic_drag != 0.0);
    let air = dragged.then(|| scene.air().velocity);
    let mut moves = [scene.triangles.iter().any(|t| t.air_drag != 0.0); 3];
    for direction in lines
        .chain(wind.map(|wind| wind.direction))
        .chain(velocities.map(|p| p.velocity))
        .chain(scene.drives().iter().map(Drive::reach))
        .chain([scene.gravity()])
        .chain(air)
    {
        for axis in 0..3 {
            moves[axis] |= direction[axis] != 0.0;
        }
    }
    let charged = scene.particles.iter().any(|p| !p.fixed && p.charge != 0.0);
    if let Some(magnetic) = scene.magnetic.as_ref().filter(|_| charged) {
        // v x B moves across both; what it moves it turns again.
        for axis in [0, 1, 2, 0, 1, 2] {
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            let turned = |of: usize, by: usize| moves[of] && magnetic.field[by] != 0.0;
            moves[axis] |= turned(next, last) || turned(last, next);
        }
    }
    moves
}
