//! A scene as flat arrays of numbers: what a program in any language reads in a few lines.

use super::Task;
use crate::physics::ParticleSystem;
use crate::scene::DampingModel;
use serde::Serialize;

/// Version of the keys and of what they mean.
const SCHEMA_VERSION: u32 = 1;

/// Everything that moves the particles, all defaults filled in; the JSON behind `{scene_json}`.
///
/// N particles, M springs, P pairs. Numbers read back to the same bits. SI units.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Flat {
    pub schema_version: u32,
    /// N.
    pub particles: usize,
    /// 3N, m: x, y, z of particle 0, then of particle 1, ...
    pub positions: Vec<f64>,
    /// 3N, m/s; 0 for what is fixed.
    pub velocities: Vec<f64>,
    /// N, kg; of what is fixed too, although nothing moves it.
    pub masses: Vec<f64>,
    /// N.
    pub fixed: Vec<bool>,
    pub springs: FlatSprings,
    /// `axial` or `isotropic`: which part of the ends' relative velocity the dampers resist.
    pub damping_model: DampingModel,
    /// m/s², x, y, z.
    pub gravity: [f64; 3],
    /// N, N s/m: each particle's linear drag.
    pub drag: Vec<f64>,
    /// N, x, y, z: on every free particle, whatever its mass.
    pub wind_force: [f64; 3],
    pub gravitational: FlatPairs,
    /// Ids of the effects in force; what is not among them does nothing.
    pub effects: Vec<&'static str>,
    /// s a step.
    pub timestep: f64,
    /// s in all.
    pub duration: f64,
    /// Steps that cover the duration; the last row is at `steps` times `timestep`.
    pub steps: u64,
}

/// All springs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FlatSprings {
    /// 2M: the two particles of spring 0, then of spring 1, ...
    pub ids: Vec<usize>,
    /// M, N/m.
    pub stiffness: Vec<f64>,
    /// M, N/m³: adds cubic (l - L)³ to the pull.
    pub cubic: Vec<f64>,
    /// M, N s/m.
    pub damping: Vec<f64>,
    /// M, m.
    pub rest_lengths: Vec<f64>,
}

/// All pairs that attract each other with g m1 m2 / r².
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FlatPairs {
    /// 2P.
    pub ids: Vec<usize>,
    /// P, N m²/kg².
    pub g: Vec<f64>,
}

impl Flat {
    /// The scene of a task, with the task's timestep and steps.
    pub fn new(task: &Task) -> Self {
        let scene = task.scene;
        let start = ParticleSystem::initial_state(scene);
        let mut gravity = [0.0; 3];
        gravity[scene.up.index()] = scene.solver.gravity;
        Self {
            schema_version: SCHEMA_VERSION,
            particles: scene.particles.len(),
            positions: start.x,
            velocities: start.v,
            masses: scene.particles.iter().map(|p| p.mass).collect(),
            fixed: scene.particles.iter().map(|p| p.fixed).collect(),
            springs: FlatSprings {
                ids: scene.springs.iter().flat_map(|s| s.ends).collect(),
                stiffness: scene.springs.iter().map(|s| s.stiffness).collect(),
                cubic: scene.springs.iter().map(|s| s.cubic).collect(),
                damping: scene.springs.iter().map(|s| s.damping).collect(),
                rest_lengths: scene.springs.iter().map(|s| s.rest_length).collect(),
            },
            damping_model: scene.damping_model,
            gravity,
            drag: scene.particles.iter().map(|p| p.drag).collect(),
            wind_force: scene
                .wind
                .as_ref()
                .map_or([0.0; 3], |wind| wind.direction.map(|d| wind.strength * d)),
            gravitational: FlatPairs {
                ids: scene.gravitational.iter().flat_map(|p| p.ends).collect(),
                g: scene.gravitational.iter().map(|p| p.g).collect(),
            },
            effects: task
                .system
                .effects()
                .iter()
                .map(|(row, _)| row.id)
                .collect(),
            timestep: task.timestep,
            duration: scene.duration,
            steps: task.steps,
        }
    }
}
