//! The engine that runs one of our integrators.

use super::{Counts, Engine};
use crate::integrators::{Integrator, Method, Settings, StepError};
use crate::scene::Scene;
use crate::system::{Counting, ParticleSystem, State};

/// An integrator on a scene's particle system at a fixed timestep.
pub struct IntegratorEngine {
    system: Counting<ParticleSystem>,
    integrator: Box<dyn Integrator>,
    state: State,
    timestep: f64,
    steps: u64,
}

impl IntegratorEngine {
    /// From a method's row. `timestep` in seconds, positive.
    pub fn new(
        scene: &Scene,
        system: ParticleSystem,
        method: &Method,
        settings: &Settings,
        timestep: f64,
    ) -> Self {
        Self::with(scene, system, (method.build)(settings), timestep)
    }

    /// With an integrator of the caller's own.
    pub fn with(
        scene: &Scene,
        system: ParticleSystem,
        integrator: Box<dyn Integrator>,
        timestep: f64,
    ) -> Self {
        Self {
            system: Counting::new(system),
            integrator,
            state: ParticleSystem::initial_state(scene),
            timestep,
            steps: 0,
        }
    }
}

impl Engine for IntegratorEngine {
    fn step(&mut self) -> Result<(), StepError> {
        // n h, not a running sum, which would drift.
        self.state.t = self.steps as f64 * self.timestep;
        self.integrator
            .step(&self.system, self.timestep, &mut self.state)?;
        // What acts between steps (contact, rods, strain limits) belongs here, on the new state, and
        // adds what it takes out to `state.work`.
        self.steps += 1;
        self.state.t = self.steps as f64 * self.timestep;
        Ok(())
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn counts(&self) -> Counts {
        let evaluations = self.system.evaluations();
        Counts {
            force_evaluations: Some(evaluations.forces),
            damping_evaluations: Some(evaluations.damping),
            linear_solves: Some(self.integrator.linear_solves()),
            newton_iterations: Some(self.integrator.newton_iterations()),
        }
    }
}
