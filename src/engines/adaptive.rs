//! The engine that runs an adaptive pair.

use super::{Counts, Engine};
use crate::integrators::StepError;
use crate::integrators::adaptive::{Adaptive, Pair};
use crate::scene::Scene;
use crate::system::{Counting, ParticleSystem, State};

/// A pair on a scene's particle system, from t = 0 to a given time, in steps of its own.
///
/// Its state knows its time: `state().t` after n steps is what those steps add up to, not n times
/// anything, and at the end it is `until` to the last bit.
pub struct AdaptiveEngine {
    system: Counting<ParticleSystem>,
    stepper: Adaptive,
    state: State,
    until: f64,
    steps: u64,
}

impl AdaptiveEngine {
    /// `tolerance` is relative to the scene's size, as [`Adaptive`] has it; `until` in seconds. Unless
    /// that is positive and finite there is nothing to do.
    pub fn new(
        scene: &Scene,
        system: ParticleSystem,
        pair: &Pair,
        tolerance: f64,
        until: f64,
    ) -> Self {
        Self {
            system: Counting::new(system),
            stepper: Adaptive::new(pair, tolerance, scene.size()),
            state: ParticleSystem::initial_state(scene),
            until: if until.is_finite() { until } else { 0.0 },
            steps: 0,
        }
    }

    /// Whether the state is at the end.
    pub fn done(&self) -> bool {
        self.state.t >= self.until
    }

    /// Steps taken: accepted ones.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Attempts whose error was too large; their evaluations are counted with the others.
    pub fn steps_rejected(&self) -> u64 {
        self.stepper.rejected()
    }
}

impl Engine for AdaptiveEngine {
    /// One accepted step of its own length; the last ends exactly at `until`, and beyond it nothing
    /// happens.
    fn step(&mut self) -> Result<(), StepError> {
        if self.done() {
            return Ok(());
        }
        self.stepper
            .step(&self.system, self.until, &mut self.state)?;
        self.steps += 1;
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
            linear_solves: Some(0),
            newton_iterations: Some(0),
        }
    }
}
