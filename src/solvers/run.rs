//! A run advances a solver, passes its states to an observer, and stops when it diverges.

use super::setting::Setting;
use super::{Counts, Engine};
use crate::integrators::StepError;
use crate::physics::{ParticleSystem, State, System};
use crate::trajectory::Observer;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// The status of an outcome, as reports state it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    Completed,
    Diverged,
    Failed,
    Unsupported,
}

/// The limits beyond which a run counts as diverged: a state that is not finite, or K + U_elastic above a
/// limit.
#[derive(Clone)]
pub struct Limits {
    system: ParticleSystem,
    /// The largest K + U_elastic, J.
    limit: Option<f64>,
    /// The largest mass, kg.
    heaviest: f64,
    /// The number of steps from one test to the next.
    every: u64,
}

/// How a run ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Ended {
    Completed,
    /// Diverged at the end of this step, with the reason in words.
    Diverged {
        step: u64,
        reason: String,
    },
    /// Failed in this step, which could not be taken.
    Failed {
        step: u64,
        error: StepError,
    },
    /// An adaptive pair has not reached the end within the steps that its setting allows.
    Exhausted,
}

/// The elastic energy is computed only when the kinetic energy exceeds this fraction of the limit. In a
/// diverging run this happens first, unless one step alone multiplies the energy by a million.
const SUSPECT: f64 = 1e-6;

impl Limits {
    /// `limit` in joules, as [`divergence_limit`](crate::measure::divergence_limit) gives it; with None only
    /// the state's finiteness is tested.
    pub fn new(system: ParticleSystem, limit: Option<f64>) -> Self {
        let inverse = system.inverse_mass().iter().filter(|w| **w > 0.0);
        let heaviest = inverse.fold(0.0, |m: f64, w| m.max(1.0 / w));
        Self {
            system,
            limit,
            heaviest,
            every: 1,
        }
    }

    /// The same limits, tested every 16 steps only, at almost no cost. A run that diverges under these diverged
    /// at most 16 steps earlier: run it again under the exact limits to find the step.
    pub fn coarse(&self) -> Self {
        Self {
            every: 16,
            ..self.clone()
        }
    }

    /// The reason why this state counts as diverged; None if it does not.
    pub(crate) fn exceeded(&self, state: &State) -> Option<String> {
        // The squared speeds bound K from above at half its cost.
        let kinetic = 0.5 * self.heaviest * sum_of_squares(&state.v);
        let calm = match self.limit {
            Some(limit) => kinetic <= SUSPECT * limit,
            None => kinetic.is_finite(),
        };
        // NaN is not calm.
        if calm { None } else { self.examine(state) }
    }

    /// Tests the full definition.
    fn examine(&self, state: &State) -> Option<String> {
        let bad = |values: &[f64]| values.iter().position(|c| !c.is_finite());
        if let Some(at) = bad(&state.x).or_else(|| bad(&state.v)) {
            return Some(format!("particle {} is no longer finite", at / 3));
        }
        let energy = self.system.kinetic(&state.v) + self.system.elastic(state.t, &state.x);
        if !energy.is_finite() {
            let fastest = fastest(&state.v);
            return Some(format!(
                "the energy is no longer finite, fastest at particle {fastest}"
            ));
        }
        let limit = self.limit?;
        (energy > limit).then(|| {
            let fastest = fastest(&state.v);
            format!("its energy passed the limit of {limit:.1e} J, fastest at particle {fastest}")
        })
    }
}

/// The sum of v², in eight running sums: one long chain of additions would cost more than a spring force.
fn sum_of_squares(v: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let blocks = v.chunks_exact(8);
    let rest: f64 = blocks.remainder().iter().map(|v| v * v).sum();
    for block in blocks {
        for i in 0..8 {
            sums[i] += block[i] * block[i];
        }
    }
    sums.iter().sum::<f64>() + rest
}

/// The particle with the largest speed.
fn fastest(v: &[f64]) -> usize {
    let speeds = v
        .chunks_exact(3)
        .map(|v| v.iter().map(|c| c * c).sum::<f64>());
    speeds
        .enumerate()
        .fold(
            (0, 0.0),
            |best, (i, s)| if s > best.1 { (i, s) } else { best },
        )
        .0
}

/// The evaluations of several runs together. Each run adds its own when it is dropped.
#[derive(Debug, Default)]
pub struct Tally {
    forces: AtomicU64,
    damping: AtomicU64,
}

impl Tally {
    /// Full evaluations, and evaluations of damping alone.
    pub fn evaluations(&self) -> [u64; 2] {
        [&self.forces, &self.damping].map(|count| count.load(Ordering::Relaxed))
    }
}

/// A solver on a scene, at the start or part of the way. Only a run steps an engine.
pub struct Run {
    engine: Box<dyn Engine>,
    setting: Setting,
    taken: u64,
    tally: Option<Arc<Tally>>,
}

impl Run {
    pub(super) fn new(engine: Box<dyn Engine>, setting: Setting) -> Self {
        Self {
            engine,
            setting,
            taken: 0,
            tally: None,
        }
    }

    /// The same run, which adds its evaluations to `tally` when it is dropped.
    #[must_use]
    pub fn tallied(mut self, tally: &Arc<Tally>) -> Self {
        self.tally = Some(Arc::clone(tally));
        self
    }

    /// The present state.
    pub fn state(&self) -> &State {
        self.engine.state()
    }

    /// The work counted so far.
    pub fn counts(&self) -> Counts {
        self.engine.counts()
    }

    /// The number of steps taken; for an adaptive pair, of accepted steps.
    pub fn taken(&self) -> u64 {
        self.taken
    }

    /// Takes this many steps without an observer, regardless of the setting's end.
    ///
    /// # Errors
    /// The first step that could not be taken; the state is then the last good one.
    pub fn advance(&mut self, steps: u64) -> Result<(), StepError> {
        for _ in 0..steps {
            self.step()?;
        }
        Ok(())
    }

    fn step(&mut self) -> Result<(), StepError> {
        self.engine.step()?;
        self.taken += 1;
        Ok(())
    }

    /// Runs to the end of the setting, or until the run diverges, fails or is exhausted. It observes step 0
    /// first, so the run has to be at its start.
    ///
    /// `tick` is called every 1024 steps, and at the end, with the steps taken since the last call.
    pub fn finish(
        &mut self,
        limits: &Limits,
        observer: &mut dyn Observer,
        tick: &dyn Fn(u64),
    ) -> Ended {
        let mut due = observer.next(0);
        let mut ticked = 0;
        loop {
            let step = self.taken;
            if due == Some(step) {
                observer.observe(step, self.state());
                due = observer.next(step + 1);
            }
            if step - ticked == 1024 {
                tick(1024);
                ticked = step;
            }
            if let Some(ended) = self.end() {
                if self.setting.tolerance().is_some() {
                    observer.observe_end(step, self.state());
                }
                tick(step - ticked);
                return ended;
            }
            if let Err(error) = self.step() {
                return Ended::Failed { step, error };
            }
            let step = self.taken;
            let looked_at = step.is_multiple_of(limits.every) || self.end().is_some();
            if looked_at && let Some(reason) = limits.exceeded(self.state()) {
                if self.state().is_finite() {
                    observer.observe_diverged(step, self.state());
                }
                return Ended::Diverged { step, reason };
            }
        }
    }

    /// How the run ends at the present step; None if it goes on.
    fn end(&self) -> Option<Ended> {
        match self.setting {
            Setting::Steps { steps, .. } => (self.taken >= steps).then_some(Ended::Completed),
            Setting::Tolerance { .. } if self.engine.done() => Some(Ended::Completed),
            Setting::Tolerance { max_steps, .. } => {
                (self.taken + self.engine.rejected() >= max_steps).then_some(Ended::Exhausted)
            }
        }
    }
}

impl Drop for Run {
    fn drop(&mut self) {
        if let Some(tally) = &self.tally {
            let counts = self.engine.counts();
            let add = |sum: &AtomicU64, count: Option<u64>| {
                sum.fetch_add(count.unwrap_or(0), Ordering::Relaxed);
            };
            add(&tally.forces, counts.force_evaluations);
            add(&tally.damping, counts.damping_evaluations);
        }
    }
}
