//! A scene's particles as rapier bodies.

use super::obstacles;
use super::settings::RapierSettings;
use crate::physics::State;
use crate::physics::constraints::StrainLimiter;
use crate::scene::{Drive, Scene};
use crate::solvers::{Built, Unsupported};
use rapier3d::dynamics::{GenericJoint, RigidBodyBuilder, RigidBodyHandle};
use rapier3d::math::Vector;
use rapier3d::pipeline::PhysicsWorld;

/// rapier treats 1/m as 0 where m or 1/m is not above this (its `INV_EPSILON`), so such a body would not
/// move.
pub(super) const NEGLIGIBLE: f64 = 1e-20;

/// A rapier world with one body for each particle, in the same order. Only where the scene has obstacles it has
/// colliders, and rapier detects collisions.
pub(super) struct World {
    inner: PhysicsWorld,
    bodies: Vec<RigidBodyHandle>,
    /// The indices of the free particles.
    free: Vec<usize>,
    /// The motions of driven particles, which are kinematic bodies.
    drives: Vec<Drive>,
    /// Obstacles that move.
    moved: Vec<(RigidBodyHandle, Drive)>,
    /// The fixed body that stands for the air in drag joints; made on first use.
    air: Option<RigidBodyHandle>,
    /// Whether rapier disabled a body that was no longer finite.
    quarantined: bool,
}

/// One end of a joint.
#[derive(Debug, Clone, Copy)]
pub(super) enum End {
    Particle(usize),
    /// A body at rest, against which motors of drag push.
    Air,
}

impl World {
    /// A world of bodies, without gravity, forces or joints.
    pub(super) fn new(
        scene: &Scene,
        timestep: f64,
        settings: &RapierSettings,
    ) -> Result<Self, Unsupported> {
        if StrainLimiter::new(scene).is_some() {
            return Err(unsupported("rapier has no strain limit".to_owned()));
        }
        let mut inner = PhysicsWorld::new();
        inner.gravity = Vector::ZERO;
        let parameters = &mut inner.integration_parameters;
        parameters.dt = timestep;
        parameters.num_solver_iterations = settings.iterations.max(1) as usize;
        parameters.num_internal_pgs_iterations = settings.pgs.max(1) as usize;
        parameters.num_internal_stabilization_iterations = settings.stabilization as usize;
        // rapier's default limit of 400 m/s keeps a diverging run finite and wrong.
        parameters.normalized_max_linear_velocity = settings.speed.unwrap_or(f64::MAX);
        parameters.max_ccd_substeps = 0;

        let drives = scene.drives();
        let starts = scene.starts();
        let mut bodies = Vec::with_capacity(scene.particles.len());
        let mut free = Vec::new();
        for (i, particle) in scene.particles.iter().enumerate() {
            let builder = if drives.iter().any(|drive| drive.particle == i) {
                RigidBodyBuilder::kinematic_position_based()
            } else if particle.fixed {
                RigidBodyBuilder::fixed()
            } else {
                if particle.mass <= NEGLIGIBLE || 1.0 / particle.mass <= NEGLIGIBLE {
                    return Err(unsupported(format!(
                        "particle {i} weighs {:e} kg; rapier moves only masses of more than 1e-20 \
                         and less than 1e20 kg",
                        particle.mass
                    )));
                }
                free.push(i);
                RigidBodyBuilder::dynamic()
                    .additional_mass(particle.mass)
                    .linvel(vector(particle.velocity))
            };
            let body = builder
                .translation(vector(starts[i]))
                .lock_rotations()
                .linear_damping(0.0)
                // rapier would put a body with a small oscillation to sleep.
                .can_sleep(false);
            bodies.push(inner.insert_body(body));
        }
        let moved = obstacles::add(scene, &bodies, &mut inner)?;
        Ok(Self {
            inner,
            bodies,
            free,
            drives,
            moved,
            air: None,
            quarantined: false,
        })
    }

    /// Sets uniform gravity, m/s².
    pub(super) fn set_gravity(&mut self, gravity: [f64; 3]) {
        self.inner.gravity = vector(gravity);
    }

    /// Adds a force, N, to every free particle. It acts until it is replaced.
    pub(super) fn add_force_to_all(&mut self, force: [f64; 3]) {
        for &i in &self.free {
            if let Some(body) = self.inner.bodies.get_mut(self.bodies[i]) {
                body.add_force(vector(force), true);
            }
        }
    }

    /// Replaces the forces on all free particles: `f` holds 3n coordinates, N.
    pub(super) fn set_forces(&mut self, f: &[f64]) {
        for &i in &self.free {
            if let Some(body) = self.inner.bodies.get_mut(self.bodies[i]) {
                // rapier keeps forces from step to step; without the reset they accumulate.
                body.reset_forces(true);
                body.add_force(Vector::new(f[3 * i], f[3 * i + 1], f[3 * i + 2]), true);
            }
        }
    }

    /// Adds a joint. rapier solves joints in the order they are added.
    pub(super) fn join(&mut self, ends: [End; 2], joint: impl Into<GenericJoint>) {
        let [first, second] = ends.map(|end| match end {
            End::Particle(i) => self.bodies[i],
            End::Air => self.air(),
        });
        self.inner.insert_impulse_joint(first, second, joint);
    }

    fn air(&mut self) -> RigidBodyHandle {
        let inner = &mut self.inner;
        *self
            .air
            .get_or_insert_with(|| inner.insert_body(RigidBodyBuilder::fixed()))
    }

    /// What it consists of.
    pub(super) fn built(&self) -> Built {
        Built {
            bodies: self.inner.bodies.len() as u64,
            joints: self.inner.impulse_joints.len() as u64,
        }
    }

    /// Takes one step of rapier, which ends at this time, s, and copies positions and velocities to `state`.
    ///
    /// Within a step a driven body moves at the constant velocity that takes it to where its motion has it at the end.
    pub(super) fn step(&mut self, end: f64, state: &mut State) {
        state.t = end;
        for drive in &self.drives {
            let [position, velocity, _] = drive.at(end);
            if let Some(body) = self.inner.bodies.get_mut(self.bodies[drive.particle]) {
                body.set_next_kinematic_translation(vector(position));
            }
            let own = 3 * drive.particle..3 * drive.particle + 3;
            state.x[own.clone()].copy_from_slice(&position);
            state.v[own].copy_from_slice(&velocity);
        }
        if self.quarantined {
            return;
        }
        for (body, drive) in &self.moved {
            if let Some(body) = self.inner.bodies.get_mut(*body) {
                body.set_next_kinematic_translation(vector(drive.at(end)[0]));
            }
        }
        self.inner.step();
        // rapier disables a body that is no longer finite and puts it back where it was, so a run that
        // diverged would look like one at rest.
        self.quarantined = !self.inner.quarantine().is_empty();
        for &i in &self.free {
            let body = &self.inner.bodies[self.bodies[i]];
            let (x, v) = if self.quarantined {
                ([f64::NAN; 3], [f64::NAN; 3])
            } else {
                (body.translation().to_array(), body.linvel().to_array())
            };
            state.x[3 * i..3 * i + 3].copy_from_slice(&x);
            state.v[3 * i..3 * i + 3].copy_from_slice(&v);
        }
    }
}

/// Converts to rapier's vectors.
fn vector(v: [f64; 3]) -> Vector {
    Vector::from_array(v)
}

pub(super) fn unsupported(reason: String) -> Unsupported {
    Unsupported { reason }
}
