//! Is this step stable? Runs are watched until it is clear.
//!
//! Whether their energy keeps growing is judged by its largest values in successive windows. A bound alone
//! (such as 1e4 times the start) does not find a limit: explicit Euler on an oscillator of damping ratio ζ
//! multiplies the energy by 1 + 4 ζ² δ a step at a relative distance δ beyond its limit, which takes 20,000
//! steps to reach 1e4 only from δ = 1.2 % on at ζ = 0.1. Largest values, not means: near a limit the energy
//! swings by orders of magnitude, but comes back to the same height.

use super::MakeRun;
use super::perturbation::{Perturbation, scramble};
use crate::integrators::StepError;
use crate::physics::State;
use crate::scene::Scene;
use crate::solvers::{Run, Unsupported};
use std::cell::Cell;

/// The outcome of a probe.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum ProbeOutcome {
    /// The energy is bounded, as far as it was watched.
    Steady,
    /// It rises throughout, too slowly to call it growth.
    Creeps,
    Decays,
    /// Unstable, and how; `lost` where the run could not go on.
    Grows {
        why: String,
        lost: bool,
    },
}

/// A probe's answer.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Probed {
    pub outcome: ProbeOutcome,
    /// Growth of ln(energy) per step; None where nothing was left to measure.
    pub rate: Option<f64>,
}

impl Probed {
    pub fn unstable(&self) -> bool {
        matches!(self.outcome, ProbeOutcome::Grows { .. })
    }

    /// The energy decays to nothing.
    pub fn decays() -> Self {
        Self {
            outcome: ProbeOutcome::Decays,
            rate: None,
        }
    }

    fn grows(why: impl Into<String>, lost: bool, rate: Option<f64>) -> Self {
        let why = why.into();
        Self {
            outcome: ProbeOutcome::Grows { why, lost },
            rate,
        }
    }

    /// After `step` steps the logarithm of the energy is so large that it does not come back.
    pub fn explodes(log: f64, step: u64) -> Self {
        let why = match step {
            1 => "its energy explodes within one step".to_owned(),
            step => format!("its energy explodes within {step} steps"),
        };
        Self::grows(why, true, Some(log / step as f64))
    }

    pub fn not_finite(step: u64) -> Self {
        let why = format!("it left the range of finite numbers within {step} steps");
        Self::grows(why, true, None)
    }
}

/// Runs at one timestep from different starts, advanced together.
pub(super) struct Runs(Vec<Run>);

/// The force passes that a linear solve counts as.
const SOLVE: u64 = 3;

impl Runs {
    /// One run from the start of each scene, at step `h`, s.
    pub fn new(make: &MakeRun, h: f64, scenes: &[&Scene]) -> Result<Self, Unsupported> {
        let runs = scenes.iter().map(|scene| make(scene, h));
        Ok(Self(runs.collect::<Result<_, _>>()?))
    }

    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Takes a step of each run.
    pub fn step(&mut self) -> Result<(), StepError> {
        self.0.iter_mut().try_for_each(|run| run.advance(1))
    }

    pub fn state(&self, run: usize) -> &State {
        self.0[run].state()
    }

    /// The state of one run minus that of the first.
    pub fn difference(&self, run: usize) -> Perturbation {
        let mut difference = Perturbation::default();
        difference.set_difference(self.state(0), self.state(run));
        difference
    }

    /// Linear solves so far, where solvers count them.
    pub fn solves(&self) -> u64 {
        let solves = self.0.iter().filter_map(|run| run.counts().linear_solves);
        solves.sum()
    }

    /// Force passes so far, linear solves counted as such, where solvers count them.
    pub fn passes(&self) -> u64 {
        let passes = self.0.iter().map(|run| {
            let counts = run.counts();
            counts.all_force_passes().unwrap_or(0) + SOLVE * counts.linear_solves.unwrap_or(0)
        });
        passes.sum()
    }
}

/// The energy of runs that a probe watches.
pub(super) trait Gauge {
    /// The energy after `step` steps.
    ///
    /// # Errors
    /// The answer of the probe, where the energy leaves no other.
    fn level(&mut self, runs: &Runs, step: u64) -> Result<EnergyLevel, Probed>;

    /// Whether what is watched is no larger than rounding.
    fn is_rounding(&mut self, _runs: &Runs) -> bool {
        false
    }
}

/// An energy against its start or its scale.
pub(super) struct EnergyLevel {
    /// Its logarithm.
    pub log: f64,
    /// Whether it is too high for a stable run to stay there.
    pub high: bool,
}

/// How long to watch, and how much is growth.
#[derive(Debug, Clone, Copy)]
pub(super) struct Watch {
    /// Steps at first; up to 4^`extensions` as many while the trend is undecided.
    pub steps: u64,
    pub extensions: u32,
    /// Rise of ln(energy) over the tail from which growth counts.
    pub clear: f64,
}

/// Counts steps against a budget.
pub(super) struct Budget<'a> {
    left: u64,
    /// Steps taken in all.
    pub taken: u64,
    tick: &'a (dyn Fn(u64) + Sync),
}

/// A step that takes more force passes than this counts as several: Newton far from its root.
const USUAL: u64 = 20;

impl<'a> Budget<'a> {
    /// `tick` is called with steps taken.
    pub fn new(left: u64, tick: &'a (dyn Fn(u64) + Sync)) -> Self {
        Self {
            left,
            taken: 0,
            tick,
        }
    }

    /// Spends `steps` steps, and more if their force passes, `passes`, exceed what steps usually
    /// take. False when nothing is left.
    pub fn spend(&mut self, steps: u64, passes: u64) -> bool {
        self.taken += steps;
        let over = (passes / USUAL).saturating_sub(steps);
        (self.tick)(steps.saturating_add(over));
        self.left = self.left.saturating_sub(over);
        let enough = self.left >= steps;
        self.left = self.left.saturating_sub(steps);
        enough
    }
}

/// Steps between two looks: irregular, since a fixed stride could meet an oscillation always in the
/// same phase.
fn stride(step: u64) -> u64 {
    1 + scramble(step) % 7
}

/// Steps are counted against the budget in batches of this many, fewer where they take more force passes than usual.
const PAID: u64 = 256;

/// Steps the runs until the answer is clear; None when the budget ends first.
pub(super) fn probe(
    runs: &mut Runs,
    gauge: &mut dyn Gauge,
    watch: Watch,
    budget: &mut Budget,
) -> Option<Probed> {
    let mut maxima = Maxima::new(watch.steps);
    let passes = Cell::new(runs.passes());
    let mut pay = |runs: &Runs, steps: u64| {
        let since = runs.passes().saturating_sub(passes.replace(runs.passes()));
        let enough = budget.spend(runs.len() as u64 * steps, since);
        enough.then_some(())
    };
    let (mut step, mut high, mut unpaid) = (0, 0, 0);
    let ended = 'watched: {
        for extension in 0..=watch.extensions {
            if extension > 0 {
                maxima.widen();
            }
            let end = maxima.steps();
            let window = end / WINDOWS as u64;
            let mut look = step + 1;
            let mut rest = step + window;
            high = 0;
            while step < end {
                unpaid += 1;
                if let Err(error) = runs.step() {
                    let why = format!("step {step} fails: {error}");
                    break 'watched Some(Probed::grows(why, true, None));
                }
                step += 1;
                // The runs are looked at at the end of every window too: what grows is largest there.
                if step >= look || step >= rest {
                    look = step + stride(step);
                    match gauge.level(runs, step) {
                        Ok(level) => {
                            maxima.push(step, level.log);
                            if level.high {
                                high = step;
                            }
                        }
                        Err(ended) => break 'watched Some(ended),
                    }
                }
                if unpaid >= PAID || runs.passes() > passes.get() + PAID * USUAL {
                    pay(runs, std::mem::take(&mut unpaid))?;
                }
                if step >= rest {
                    rest = step + window;
                    if gauge.is_rounding(runs) {
                        break 'watched Some(Probed::decays());
                    }
                }
            }
            pay(runs, std::mem::take(&mut unpaid))?;
            if maxima.judge(watch.clear).outcome != ProbeOutcome::Creeps {
                break;
            }
        }
        None
    };
    if ended.is_some() {
        pay(runs, unpaid);
        return ended;
    }
    let judged = maxima.judge(watch.clear);
    // The energy was too high in the last quarter.
    if !judged.unstable() && high > 0 && high >= step - step / 4 {
        let why = "its energy stays far too high";
        return Some(Probed::grows(why, false, judged.rate));
    }
    Some(judged)
}

/// Windows a run is judged by.
const WINDOWS: usize = 16;
/// The first half may be a transient.
const TAIL: usize = WINDOWS / 2;
/// Windows averaged at either end of the tail.
const ENDS: usize = 3;
/// Steps from the middle of one end to that of the other, in windows.
const SPAN: f64 = (TAIL - ENDS) as f64;
/// Growth must be this many times the largest fall between two windows.
const SURE: f64 = 4.0;
/// Fraction of a clear rise below which there is none.
const FAINT: f64 = 1e-3;

/// Steps over which the rise is taken in a run of `steps`.
pub(super) fn span(steps: u64) -> f64 {
    SPAN * (steps / WINDOWS as u64) as f64
}

/// Largest values of windows of equally many steps.
struct Maxima {
    window: u64,
    values: Vec<f64>,
}

impl Maxima {
    /// The windows of a run of `steps` steps; the values are logarithms.
    fn new(steps: u64) -> Self {
        Self {
            window: (steps / WINDOWS as u64).max(1),
            values: Vec::with_capacity(WINDOWS),
        }
    }

    /// Steps that fill all windows.
    fn steps(&self) -> u64 {
        self.window * WINDOWS as u64
    }

    /// Adds the value after step `step`, from 1; steps may be left out.
    fn push(&mut self, step: u64, value: f64) {
        let at = (step.saturating_sub(1) / self.window) as usize;
        if self.values.len() <= at {
            self.values.resize(at + 1, f64::NEG_INFINITY);
        }
        self.values[at] = self.values[at].max(value);
    }

    /// Makes windows four times as long, for a run four times as long.
    fn widen(&mut self) {
        self.window *= 4;
        let four = self.values.chunks(4);
        let largest = |v: &[f64]| v.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        self.values = four.map(largest).collect();
    }

    /// Judges the last half. `clear` is the rise of the logarithm from which growth counts; what creeps
    /// rises without a break, but by too little to be sure: more steps would tell.
    fn judge(&self, clear: f64) -> Probed {
        let tail = &self.values[self.values.len().saturating_sub(TAIL)..];
        let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len().max(1) as f64;
        let ends = tail.first_chunk::<ENDS>().zip(tail.last_chunk::<ENDS>());
        let rise = ends.map_or(0.0, |(first, last)| mean(last) - mean(first));
        let rise = if rise.is_finite() { rise } else { 0.0 };
        let rate = Some(rise / (SPAN * self.window as f64));
        if rise > clear && rise > SURE * largest_fall(tail) {
            return Probed::grows("its energy keeps growing", false, rate);
        }
        let outcome = if rise < -clear {
            ProbeOutcome::Decays
        } else if rise > FAINT * clear && tail.is_sorted() {
            ProbeOutcome::Creeps
        } else {
            ProbeOutcome::Steady
        };
        Probed { outcome, rate }
    }
}

/// The largest fall from one value to a later one.
fn largest_fall(values: &[f64]) -> f64 {
    let mut highest = f64::NEG_INFINITY;
    let mut fall = 0.0_f64;
    for value in values {
        highest = highest.max(*value);
        fall = fall.max(highest - value);
    }
    fall
}
