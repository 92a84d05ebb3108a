//! A scene's particles as rapier bodies, and back.

use super::settings::RapierSettings;
use crate::physics::State;
use crate::scene::{Axis, Scene};
use crate::solvers::Unsupported;
use rapier3d::dynamics::{GenericJoint, RigidBodyBuilder, RigidBodyHandle};
use rapier3d::math::Vector;
use rapier3d::pipeline::PhysicsWorld;

/// rapier takes 1/m for 0 where m or 1/m is not above this (its `INV_EPSILON`): such a body would
/// not move.
pub(super) const NEGLIGIBLE: f64 = 1e-20;

/// One body per particle, in the same order; no colliders, so rapier has no collisions to look for.
pub(super) struct World {
    inner: PhysicsWorld,
    bodies: Vec<RigidBodyHandle>,
    /// Indices of the free particles.
    free: Vec<usize>,
    /// The fixed body dampers hold on to; made on first use.
    air: Option<RigidBodyHandle>,
    /// rapier disabled a body that was no longer finite.
    lost: bool,
}

/// One end of a joint.
#[derive(Debug, Clone, Copy)]
pub(super) enum End {
    Particle(usize),
    /// Air at rest.
    Air,
}

impl World {
    /// Bodies only; no gravity, no forces, no joints.
    pub(super) fn new(
        scene: &Scene,
        timestep: f64,
        settings: &RapierSettings,
    ) -> Result<Self, Unsupported> {
        let mut inner = PhysicsWorld::new();
        inner.gravity = Vector::ZERO;
        let parameters = &mut inner.integration_parameters;
        parameters.dt = timestep;
        parameters.num_solver_iterations = settings.iterations.max(1) as usize;
        parameters.num_internal_pgs_iterations = settings.pgs.max(1) as usize;
        parameters.num_internal_stabilization_iterations = settings.stabilization as usize;
        // The default cap of 400 m/s keeps an exploding run finite and wrong.
        parameters.normalized_max_linear_velocity = settings.speed.unwrap_or(f64::MAX);
        parameters.max_ccd_substeps = 0;

        let mut bodies = Vec::with_capacity(scene.particles.len());
        let mut free = Vec::new();
        for (i, particle) in scene.particles.iter().enumerate() {
            let builder = if particle.fixed {
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
                .translation(vector(particle.position))
                .lock_rotations()
                .linear_damping(0.0)
                // A small oscillation would fall asleep.
                .can_sleep(false);
            bodies.push(inner.insert_body(body));
        }
        Ok(Self {
            inner,
            bodies,
            free,
            air: None,
            lost: false,
        })
    }

    /// Uniform gravity, m/s², signed along the axis.
    pub(super) fn set_gravity(&mut self, up: Axis, gravity: f64) {
        let mut g = [0.0; 3];
        g[up.index()] = gravity;
        self.inner.gravity = vector(g);
    }

    /// A force, N, that stays on every free particle until it is replaced.
    pub(super) fn push_all(&mut self, force: [f64; 3]) {
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

    /// Joints are solved in the order they are added.
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

    /// One step of rapier, and the result into `state`'s positions and velocities.
    pub(super) fn step(&mut self, state: &mut State) {
        if self.lost {
            return;
        }
        self.inner.step();
        // rapier disables a body that left the finite numbers and puts it back where it was: a run
        // that blew up would look like one at rest.
        self.lost = !self.inner.quarantine().is_empty();
        for &i in &self.free {
            let body = &self.inner.bodies[self.bodies[i]];
            let (x, v) = if self.lost {
                ([f64::NAN; 3], [f64::NAN; 3])
            } else {
                (body.translation().to_array(), body.linvel().to_array())
            };
            state.x[3 * i..3 * i + 3].copy_from_slice(&x);
            state.v[3 * i..3 * i + 3].copy_from_slice(&v);
        }
    }
}

/// Into rapier's vectors.
fn vector(v: [f64; 3]) -> Vector {
    Vector::from_array(v)
}

pub(super) fn unsupported(reason: String) -> Unsupported {
    Unsupported { reason }
}
