//! The engines that run the integrators of this program, and the function that takes their steps.

use super::{Counts, Engine};
use crate::integrators::adaptive::{Adaptive, Pair};
use crate::integrators::{Coefficients, Integrator, Method, Settings, StepError, events};
use crate::physics::constraints::{Corrections, limit, stabilise};
use crate::physics::{Counting, ParticleSystem, State, System};
use crate::scene::Scene;

/// Advances a state by a step of `h` seconds from `state.t`, after which the time counts as `end`: `state.t + h` but for
/// rounding. What is driven is then in its place. Returns what the strain limit corrected.
///
/// Every step of an integrator outside of [`conformance`](crate::conformance) is taken here. Events within a
/// step belong here, and so do corrections after it: states are moved onto rods, unless the integrator keeps them, and
/// then the strain limit acts.
///
/// # Errors
/// [`StepError`] as the integrator's; the state is then as it was.
pub fn advance(
    integrator: &mut dyn Integrator,
    system: &dyn System,
    h: f64,
    end: f64,
    state: &mut State,
) -> Result<Corrections, StepError> {
    let start = (system.rods().is_some() || system.obstacles().is_some()).then(|| state.clone());
    let stepped = events::through(integrator, system, h, state).and_then(|impacts| {
        state.t = end;
        system.place(end, &mut state.x, &mut state.v);
        let corrected = correct(integrator.keeps_rods(), system, start.as_ref(), state)?;
        Ok(Corrections {
            impacts,
            ..corrected
        })
    });
    if let (Err(_), Some(start)) = (&stepped, start) {
        *state = start;
    }
    stepped
}

/// What is done after a step, from `start` on where there are rods.
fn correct(
    kept: bool,
    system: &dyn System,
    start: Option<&State>,
    state: &mut State,
) -> Result<Corrections, StepError> {
    if let (Some(rods), Some(start)) = (system.rods(), start) {
        if !state.is_finite() {
            // Where tensions are not determined there is no acceleration.
            rods.at(&start.x)?;
            return Ok(Corrections::default());
        }
        if !kept {
            stabilise(system, rods, state)?;
        }
    }
    let limiter = system.strain_limiter();
    Ok(limiter.map_or(Ok(Corrections::default()), |limiter| {
        limit(system, limiter, state)
    })?)
}

/// An integrator on a scene's particle system at a fixed timestep.
pub struct IntegratorEngine {
    system: Counting<ParticleSystem>,
    integrator: Box<dyn Integrator>,
    state: State,
    timestep: f64,
    steps: u64,
    corrected: Corrections,
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
            corrected: Corrections::default(),
        }
    }
}

impl Engine for IntegratorEngine {
    fn step(&mut self) -> Result<(), StepError> {
        // n h, not a running sum, which would drift.
        let time = |steps: u64| steps as f64 * self.timestep;
        self.state.t = time(self.steps);
        self.corrected += advance(
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
        let counted = evaluated(&self.system, &self.corrected);
        Counts {
            // An integrator with a contact of its own counts no impacts.
            corrections: counted
                .corrections
                .filter(|_| !self.integrator.keeps_contact()),
            linear_solves: Some(self.integrator.linear_solves()),
            newton_iterations: Some(self.integrator.newton_iterations()),
            ..counted
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
    corrected: Corrections,
    /// The formula that advances, for steps that an event cuts.
    formula: Box<dyn Integrator>,
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
            corrected: Corrections::default(),
            formula: Coefficients::Pair(*pair).build(&Settings::default()),
        }
    }
}

impl Engine for AdaptiveEngine {
    /// Takes one accepted step. The last one ends exactly at `until`; further calls do nothing.
    fn step(&mut self) -> Result<(), StepError> {
        if self.done() {
            return Ok(());
        }
        let obstacles = self.system.obstacles().is_some();
        let start = (self.system.rods().is_some() || obstacles).then(|| self.state.clone());
        self.stepper
            .step(&self.system, self.until, &mut self.state)?;
        if let (true, Some(start)) = (obstacles, &start) {
            // The pair has chosen the length of the step; what happens in it is found on steps of that length.
            let end = self.state.t;
            self.state.clone_from(start);
            let (formula, h) = (self.formula.as_mut(), end - start.t);
            self.corrected += advance(formula, &self.system, h, end, &mut self.state)?;
            return Ok(());
        }
        let State { t, x, v, .. } = &mut self.state;
        self.system.place(*t, x, v);
        match (
            correct(false, &self.system, start.as_ref(), &mut self.state),
            start,
        ) {
            (Ok(corrected), _) => self.corrected += corrected,
            (Err(error), start) => {
                self.state = start.unwrap_or_else(|| self.state.clone());
                return Err(error);
            }
        }
        Ok(())
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn counts(&self) -> Counts {
        Counts {
            linear_solves: Some(0),
            newton_iterations: Some(0),
            ..evaluated(&self.system, &self.corrected)
        }
    }

    fn done(&self) -> bool {
        self.state.t >= self.until
    }

    fn rejected(&self) -> u64 {
        self.stepper.rejected()
    }
}

/// What a system counted, and what its strain limit corrected.
fn evaluated(system: &Counting<ParticleSystem>, corrected: &Corrections) -> Counts {
    let evaluations = system.evaluations();
    Counts {
        force_evaluations: Some(evaluations.forces),
        damping_evaluations: Some(evaluations.damping),
        corrections: (system.strain_limiter().is_some() || system.obstacles().is_some())
            .then_some(*corrected),
        ..Counts::default()
    }
}
