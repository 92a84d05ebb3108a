//! rapier with the scene in its own terms: spring joints, motors, its own gravity.

use super::mirrors;
use super::settings::RapierSettings;
use super::world::World;
use crate::integrators::StepError;
use crate::physics::{ParticleSystem, Power, State, System};
use crate::scene::Scene;
use crate::solvers::{Counts, Engine, Unsupported};

/// A rapier world that mirrors a scene.
///
/// The method this is, at h = timestep / iterations: gravity and wind kick the velocities, springs
/// and dampers are met by *linearly implicit Euler without geometric stiffness* (k n nᵀ), solved by
/// `pgs` Gauss-Seidel sweeps, then positions drift. It loses energy by design, and at one sweep it
/// has not solved what it set out to. Not to be confused with the truth.
///
/// Work integrals are taken from the states before and after each step by the trapezoidal rule,
/// second order in the timestep: rapier does not tell what its joints did in between.
pub struct RapierEngine {
    world: World,
    system: ParticleSystem,
    state: State,
    timestep: f64,
    steps: u64,
    power: Power,
    /// Forces, N: only to have the powers.
    scratch: Vec<f64>,
}

impl RapierEngine {
    /// `timestep` in seconds, positive; rapier divides it into `settings.iterations` substeps.
    ///
    /// # Errors
    /// [`Unsupported`] for what rapier does not have or would silently get wrong.
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

    /// Zero, and free of cost, where nothing dissipates or drives.
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

    /// rapier tells neither forces nor solves.
    fn counts(&self) -> Counts {
        Counts::default()
    }
}
