//! rapier's bodies under forces computed here.

use super::settings::Settings;
use super::world::World;
use crate::engines::{Counts, Engine, Unsupported};
use crate::integrators::StepError;
use crate::scene::Scene;
use crate::system::{ParticleSystem, Power, State, System};

/// A rapier world without joints or gravity that is handed all forces of the scene before each
/// step, one substep a step: symplectic Euler (kick, drift), the same operations in the same order.
///
/// It takes every effect that is a force. Not to be confused with what rapier makes of a scene in
/// its own terms, which is [`RapierEngine`](super::RapierEngine).
pub struct RapierForces {
    world: World,
    system: ParticleSystem,
    state: State,
    timestep: f64,
    steps: u64,
    /// Forces at the state, N, if `fresh`.
    forces: Vec<f64>,
    fresh: bool,
    power: Power,
}

impl RapierForces {
    /// `timestep` in seconds, positive.
    ///
    /// # Errors
    /// [`Unsupported`] for masses outside of what rapier can move.
    pub fn new(scene: &Scene, system: ParticleSystem, timestep: f64) -> Result<Self, Unsupported> {
        let state = ParticleSystem::initial_state(scene);
        Ok(Self {
            world: World::new(scene, timestep, &Settings::FORCES)?,
            system,
            forces: vec![0.0; state.x.len()],
            state,
            timestep,
            steps: 0,
            fresh: false,
            power: Power::default(),
        })
    }

    fn evaluate(&mut self) {
        let State { t, x, v, .. } = &self.state;
        self.power = self.system.forces(*t, x, v, &mut self.forces);
        self.fresh = true;
    }
}

impl Engine for RapierForces {
    fn step(&mut self) -> Result<(), StepError> {
        if !self.fresh {
            self.evaluate();
        }
        self.world.set_forces(&self.forces);
        self.world.step(&mut self.state);
        self.steps += 1;
        self.state.t = self.steps as f64 * self.timestep;
        self.fresh = false;
        // The trapezoid needs the powers at the end; the forces there are the next step's.
        if self.system.is_damped() || self.system.is_driven() {
            self.state.work.advance(self.power, 0.5 * self.timestep);
            self.evaluate();
            self.state.work.advance(self.power, 0.5 * self.timestep);
        }
        Ok(())
    }

    fn state(&self) -> &State {
        &self.state
    }

    /// One evaluation a step; an extra one at the end of a run serves the work integral alone.
    fn counts(&self) -> Counts {
        Counts {
            force_evaluations: Some(self.steps),
            ..Counts::default()
        }
    }
}
