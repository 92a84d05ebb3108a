//! Advances an engine over a run, hands states to an observer, and stops what diverges.

use super::{AdaptiveEngine, Engine};
use crate::integrators::StepError;
use crate::system::{ParticleSystem, State, System};

/// Sees the states of a run.
pub trait Observer {
    /// The first step number, at or after `from`, at which it wants the state; None for no more.
    fn next(&self, from: u64) -> Option<u64>;

    /// The state at step `step` (0 is the start), called at the steps asked for, in order.
    fn observe(&mut self, step: u64, state: &State);

    /// The state a run diverged in, if it is still finite: the last one of this run.
    fn observe_diverged(&mut self, step: u64, state: &State) {
        self.observe(step, state);
    }
}

/// When a run counts as diverged: non-finite, or K + U_elastic beyond a limit.
#[derive(Clone)]
pub struct Limits {
    system: ParticleSystem,
    /// Joules.
    limit: Option<f64>,
    /// Largest mass, kg.
    heaviest: f64,
    /// Steps from one look to the next.
    every: u64,
}

/// How a run ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Ended {
    Completed,
    /// At the end of this step; the cause in words.
    Diverged {
        step: u64,
        reason: String,
    },
    /// In this step, which could not be taken.
    Failed {
        step: u64,
        error: StepError,
    },
}

/// The elastic energy is looked at only when the kinetic energy has passed this share of the limit:
/// in an exploding run it passes first unless one step alone grows the energy a millionfold.
const SUSPECT: f64 = 1e-6;

impl Limits {
    /// `limit` in joules, as [`divergence_limit`](crate::measure::divergence_limit) gives it; None
    /// leaves only the finiteness test.
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

    /// The same, looked at only now and then, which costs a run next to nothing. A run that ends
    /// early under these ended *about* there: run it again under the exact limits to know where.
    pub fn now_and_then(&self) -> Self {
        Self {
            every: 16,
            ..self.clone()
        }
    }

    /// Why this state counts as diverged, if it does.
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

    /// The definition in full.
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

/// Sum of v², in eight running sums: one long chain of additions would cost more than a spring.
fn sum_of_squares(v: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let blocks = v.chunks_exact(8);
    let rest: f64 = blocks.remainder().iter().map(|v| v * v).sum();
    for block in blocks {
        for lane in 0..8 {
            sums[lane] += block[lane] * block[lane];
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

/// Takes `steps` steps, or fewer if the run diverges or fails; observes step 0 first.
///
/// `tick` is called now and then with the steps taken since the last call.
pub fn simulate(
    engine: &mut dyn Engine,
    steps: u64,
    limits: &Limits,
    observer: &mut dyn Observer,
    tick: &dyn Fn(u64),
) -> Ended {
    let mut due = observer.next(0);
    let mut ticked = 0;
    for step in 0..=steps {
        if step > 0 {
            if let Err(error) = engine.step() {
                return Ended::Failed {
                    step: step - 1,
                    error,
                };
            }
            let looked_at = step % limits.every == 0 || step == steps;
            if looked_at && let Some(reason) = limits.exceeded(engine.state()) {
                if engine.state().is_finite() {
                    observer.observe_diverged(step, engine.state());
                }
                return Ended::Diverged { step, reason };
            }
        }
        if due == Some(step) {
            observer.observe(step, engine.state());
            due = observer.next(step + 1);
        }
        if step - ticked == 1024 {
            tick(1024);
            ticked = step;
        }
    }
    tick(steps - ticked);
    Ended::Completed
}

/// Takes an adaptive engine to its end, or until the run diverges or fails; `see` is shown the state after
/// every accepted step. `Failed` and `Diverged` count accepted steps. None where it is not there after
/// `most` steps, accepted or not.
pub fn adapt(
    engine: &mut AdaptiveEngine,
    limits: &Limits,
    most: u64,
    see: &mut dyn FnMut(&State),
) -> Option<Ended> {
    while !engine.done() {
        let step = engine.steps();
        if step + engine.steps_rejected() >= most {
            return None;
        }
        if let Err(error) = engine.step() {
            return Some(Ended::Failed { step, error });
        }
        let looked_at = step.is_multiple_of(limits.every) || engine.done();
        if looked_at && let Some(reason) = limits.exceeded(engine.state()) {
            let step = engine.steps();
            return Some(Ended::Diverged { step, reason });
        }
        see(engine.state());
    }
    Some(Ended::Completed)
}
