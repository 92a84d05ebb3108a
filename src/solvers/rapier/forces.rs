//! rapier's bodies under forces computed here.

use super::settings::RapierSettings;
use super::world::{World, unsupported};
use crate::integrators::StepError;
use crate::physics::{ParticleSystem, State};
use crate::scene::Scene;
use crate::solvers::{Counts, Engine, Unsupported};

/// A rapier world without joints or gravity. It gets all forces of the scene before each step, and holds them
/// over its n substeps of h/n: v1 = v0 + h a, x1 = x0 + h v0 + (n + 1)/(2 n) h² a, with a at (x0, v0).
///
/// With one substep this is symplectic Euler (kick, drift), with the same operations in the same order. With
/// more the oscillator gains energy, 1 + (n - 1)/(2 n) z² a step.
///
/// It accepts every effect that is a force. Not to be confused with [`RapierEngine`](super::RapierEngine),
/// which expresses the scene by rapier's own joints and gravity.
pub struct RapierForces {
    world: World,
    system: ParticleSystem,
    state: State,
    timestep: f64,
    steps: u64,
    /// Scratch: forces, N.
    forces: Vec<f64>,
}

impl RapierForces {
    /// `timestep` in seconds, positive.
    ///
    /// # Errors
    /// [`Unsupported`] for rods, a strain limit, and for masses outside the range that rapier can move.
    pub fn new(
        scene: &Scene,
        system: ParticleSystem,
        timestep: f64,
        settings: &RapierSettings,
    ) -> Result<Self, Unsupported> {
        if !scene.rods.is_empty() {
            return Err(unsupported(
                "rods are not taken: forces that are held over a step let lengths drift, and rapier's bodies cannot be \
                 moved back onto them; rapier takes rods as stiff joints"
                    .to_owned(),
            ));
        }
        let state = ParticleSystem::initial_state(scene);
        Ok(Self {
            world: World::new(scene, timestep, settings)?,
            system,
            forces: vec![0.0; state.x.len()],
            state,
            timestep,
            steps: 0,
        })
    }
}

impl Engine for RapierForces {
    fn step(&mut self) -> Result<(), StepError> {
        let State { t, x, v, .. } = &self.state;
        let power = self.system.forces(*t, x, v, &mut self.forces);
        // The work is taken at the kick. With one substep it equals symplectic Euler's to the last bit.
        self.state.work.advance(power, self.timestep);
        self.world.set_forces(&self.forces);
        self.steps += 1;
        let end = self.steps as f64 * self.timestep;
        self.world.step(end, &mut self.state);
        Ok(())
    }

    fn state(&self) -> &State {
        &self.state
    }

    /// One evaluation a step.
    fn counts(&self) -> Counts {
        Counts {
            force_evaluations: Some(self.steps),
            world: Some(self.world.built()),
            ..Counts::default()
        }
    }
}
