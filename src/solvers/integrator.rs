//! The engines that run the integrators of this program, and the function that takes their steps.

use super::{Counts, Engine};
use crate::integrators::adaptive::{Adaptive, Pair};
use crate::integrators::{Integrator, Method, Settings, StepError};
use crate::physics::{Counting, ParticleSystem, State, System};
use crate::scene::Scene;

/// Advances a state by a step of `h` seconds from `state.t`, after which the time counts as `end`: `state.t + h` but for
/// rounding. What is driven is then in its place.
///
/// Every step of an integrator outside of [`conformance`](crate::conformance) is taken here. Events within a
/// step belong here, and so do corrections after it, which add the energy they take out to `state.work`.
///
/// # Errors
/// [`StepError`] as the integrator's; the state is then as it was.
pub fn advance(
    integrator: &mut dyn Integrator,
    system: &dyn System,
    h: f64,
    end: f64,
    state: &mut State,
) -> Result<(), StepError> {
    integrator.step(system, h, state)?;
    state.t = end;
    system.place(end, &mut state.x, &mut state.v);
    Ok(())
}

/// An integrator on a scene's particle system at a fixed timestep.
pub struct IntegratorEngine {
    system: Counting<ParticleSystem>,
    integrator: Box<dyn Integrator>,
    state: State,
    timestep: f64,
    steps: u64,
}

impl IntegratorEngine {
    /// An engine for a method. `timestep` in seconds, positive.
    pub fn new(
        scene: &Scene,
        system: ParticleSystem,
        method: &Method,
        settings: &Settings,
        timestep: f64,
    ) -> Self {
        Self::with(scene, system, method.build(settings), timestep)
    }

    /// An engine for an integrator of the caller's own.
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
        let time = |steps: u64| steps as f64 * self.timestep;
        self.state.t = time(self.steps);
        advance(
            self.integrator.as_mut(),
            &self.system,
            self.timestep,
            time(self.steps + 1),
            &mut self.state,
        )?;
        self.steps += 1;
        Ok(())
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn counts(&self) -> Counts {
        Counts {
            linear_solves: Some(self.integrator.linear_solves()),
            newton_iterations: Some(self.integrator.newton_iterations()),
            ..evaluated(&self.system)
        }
    }
}

/// An adaptive pair on a scene's particle system, from t = 0 to a given time, in steps of its own.
///
/// Its state's time is the sum of its steps, and at the end exactly `until`.
pub struct AdaptiveEngine {
    system: Counting<ParticleSystem>,
    stepper: Adaptive,
    state: State,
    until: f64,
}

impl AdaptiveEngine {
    /// `tolerance` is relative to the scene's size, as in [`Adaptive`]; `until` is in seconds. Unless `until` is
    /// positive and finite the engine takes no step.
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
        }
    }
}

impl Engine for AdaptiveEngine {
    /// Takes one accepted step. The last one ends exactly at `until`; further calls do nothing.
    fn step(&mut self) -> Result<(), StepError> {
        if self.done() {
            return Ok(());
        }
        self.stepper
            .step(&self.system, self.until, &mut self.state)?;
        let State { t, x, v, .. } = &mut self.state;
        self.system.place(*t, x, v);
        Ok(())
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn counts(&self) -> Counts {
        Counts {
            linear_solves: Some(0),
            newton_iterations: Some(0),
            ..evaluated(&self.system)
        }
    }

    fn done(&self) -> bool {
        self.state.t >= self.until
    }

    fn rejected(&self) -> u64 {
        self.stepper.rejected()
    }
}

/// The evaluations that a system counted.
fn evaluated(system: &Counting<ParticleSystem>) -> Counts {
    let evaluations = system.evaluations();
    Counts {
        force_evaluations: Some(evaluations.forces),
        damping_evaluations: Some(evaluations.damping),
        ..Counts::default()
    }
}
