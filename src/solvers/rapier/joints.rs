//! rapier with the scene expressed by its own spring joints, motors and gravity.

use super::mirrors;
use super::settings::RapierSettings;
use super::world::World;
use crate::integrators::StepError;
use crate::physics::{ParticleSystem, Power, State, System};
use crate::scene::Scene;
use crate::solvers::{Counts, Engine, Unsupported};

/// A rapier world that mirrors a scene.
///
/// Its method, at h = timestep / iterations: gravity and wind kick the velocities, springs and dampers act by
/// *linearly implicit Euler without geometric stiffness* (k n nᵀ), solved by `pgs` Gauss-Seidel sweeps, then
/// positions drift. It loses energy by design, and one sweep does not solve its equations. Not to be confused
/// with the truth.
///
/// Work integrals follow from the states before and after each step by the trapezoidal rule, of second order
/// in the timestep, since rapier does not report the work of its joints.
pub struct RapierEngine {
    world: World,
    system: ParticleSystem,
    state: State,
    timestep: f64,
    steps: u64,
    power: Power,
    /// Scratch: forces, N, which are computed for their powers alone.
    scratch: Vec<f64>,
}

impl RapierEngine {
    /// `timestep` in seconds, positive; rapier divides it into `settings.iterations` substeps.
    ///
    /// # Errors
    /// [`Unsupported`] where the scene has something that rapier lacks or would silently get wrong.
    pub fn new(
        scene: &Scene,
        system: ParticleSystem,
        timestep: f64,
        settings: &RapierSettings,
    ) -> Result<Self, Unsupported> {
        let mut world = World::new(scene, timestep, settings)?;
        mirrors::add_all(scene, &system, settings.substep(timestep), &mut world)?;
        let state = ParticleSystem::initial_state(scene);
        let mut engine = Self {
            world,
            scratch: vec![0.0; state.x.len()],
            system,
            state,
            timestep,
            steps: 0,
            power: Power::default(),
        };
        engine.power = engine.power_now();
        Ok(engine)
    }

    /// The powers at the present state. They are 0, at no cost, where no force does such work.
    fn power_now(&mut self) -> Power {
        if self.system.kinds().does_work() {
            let State { t, x, v, .. } = &self.state;
            self.system.forces(*t, x, v, &mut self.scratch)
        } else {
            Power::default()
        }
    }
}

impl Engine for RapierEngine {
    fn step(&mut self) -> Result<(), StepError> {
        self.world.step(&mut self.state);
        self.steps += 1;
        self.state.t = self.steps as f64 * self.timestep;
        let before = std::mem::take(&mut self.power);
        self.power = self.power_now();
        self.state.work.advance(before, 0.5 * self.timestep);
        self.state.work.advance(self.power, 0.5 * self.timestep);
        Ok(())
    }

    fn state(&self) -> &State {
        &self.state
    }

    /// rapier reports neither force evaluations nor solves.
    fn counts(&self) -> Counts {
        Counts {
            world: Some(self.world.built()),
            ..Counts::default()
        }
    }
}
