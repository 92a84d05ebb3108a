//! Is this step stable? One run, or one pair of runs, watched until it is clear.

use super::growth::{Course, Maxima, WINDOWS};
use super::shake::scramble;
use crate::engines::Engine;
use crate::integrators::StepError;

/// What is watched.
pub(super) trait Run {
    /// Engine steps a step costs.
    const ENGINES: u64;

    fn step(&mut self) -> Result<(), StepError>;

    /// Where the energy is now.
    fn level(&mut self) -> Level;

    /// Whether what is watched is no larger than rounding.
    fn drowned(&mut self) -> bool;

    /// Force passes and linear solves so far, where the engine counts them.
    fn passes(&self) -> u64;
}

/// An energy, against its start or its scale, as a logarithm.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Level {
    Log(f64),
    /// Too high to stay there.
    High(f64),
    /// Past all bounds.
    Exploded(f64),
    /// Decayed to nothing.
    Gone,
    Failed(String),
}

/// How a probe ended.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Fate {
    /// Bounded, as far as it was watched.
    Steady,
    /// Rising throughout, too slowly to call it growth.
    Creeps,
    Decays,
    /// Unstable, and how; `lost` where the run could not go on.
    Grows {
        why: String,
        lost: bool,
    },
    /// Not taken to its end.
    Impatient,
}

/// A probe's answer.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Probed {
    pub fate: Fate,
    /// Of ln(energy), per step; None where nothing was left to measure.
    pub rate: Option<f64>,
}

impl Probed {
    pub fn unstable(&self) -> bool {
        matches!(self.fate, Fate::Grows { .. })
    }

    fn grows(why: &str, rate: f64) -> Self {
        Self {
            fate: Fate::Grows {
                why: why.to_owned(),
                lost: false,
            },
            rate: Some(rate),
        }
    }

    fn lost(why: String, rate: Option<f64>) -> Self {
        Self {
            fate: Fate::Grows { why, lost: true },
            rate,
        }
    }
}

/// How long to watch, and how much is growth.
#[derive(Debug, Clone, Copy)]
pub(super) struct Watch {
    /// At first; up to 4^`extensions` as many while the trend is undecided.
    pub steps: u64,
    pub extensions: u32,
    /// Rise of ln(energy) over the tail from which growth counts.
    pub clear: f64,
}

/// Counts steps against a budget.
pub(super) struct Budget<'a> {
    pub left: u64,
    pub taken: u64,
    pub tick: &'a (dyn Fn(u64) + Sync),
}

/// A step that takes more force passes than this counts as several: Newton far from its root.
const USUAL: u64 = 20;
/// What a linear solve counts as.
const SOLVE: u64 = 3;

/// Force passes an engine took, its linear solves turned into such.
pub(super) fn passes(engine: &dyn Engine) -> u64 {
    let counts = engine.counts();
    counts.all_force_passes().unwrap_or(0) + SOLVE * counts.linear_solves.unwrap_or(0)
}

impl Budget<'_> {
    /// Steps, and what of them was more work than steps usually are: `passes` in all of them.
    pub fn spend_on(&mut self, steps: u64, passes: u64) -> bool {
        let over = (passes / USUAL).saturating_sub(steps);
        self.left = self.left.saturating_sub(over);
        self.spend(steps)
    }

    /// False when nothing is left.
    pub fn spend(&mut self, steps: u64) -> bool {
        self.taken += steps;
        (self.tick)(steps);
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

/// Steps are paid for in lots of so many.
const PAID: u64 = 256;

/// Runs until the answer is clear.
pub(super) fn probe<R: Run>(run: &mut R, watch: Watch, budget: &mut Budget) -> Probed {
    let mut maxima = Maxima::new(watch.steps);
    let mut paid = run.passes();
    let mut pay = |budget: &mut Budget, run: &R, steps: u64| {
        let passes = run.passes();
        let since = passes.saturating_sub(std::mem::replace(&mut paid, passes));
        budget.spend_on(R::ENGINES * steps, since)
    };
    let mut step = 0;
    let mut high = 0;
    for extension in 0..=watch.extensions {
        if extension > 0 {
            maxima.widen();
        }
        let end = maxima.steps();
        let mut unpaid = 0;
        let mut look = step + 1;
        let mut rest = step + end / WINDOWS as u64;
        high = 0;
        while step < end {
            if let Err(error) = run.step() {
                pay(budget, run, unpaid + 1);
                return Probed::lost(format!("step {step} fails: {error}"), None);
            }
            step += 1;
            unpaid += 1;
            // Also at the end of every window: what grows is largest there.
            if step >= look || step >= rest {
                look = step + stride(step);
                match run.level() {
                    Level::Log(level) => maxima.push(step, level),
                    Level::High(level) => {
                        maxima.push(step, level);
                        high = step;
                    }
                    Level::Exploded(level) => {
                        pay(budget, run, unpaid);
                        return Probed::lost(
                            match step {
                                1 => "its energy explodes within one step".to_owned(),
                                step => format!("its energy explodes within {step} steps"),
                            },
                            Some(level / step as f64),
                        );
                    }
                    Level::Gone => {
                        pay(budget, run, unpaid);
                        return Probed {
                            fate: Fate::Decays,
                            rate: None,
                        };
                    }
                    Level::Failed(why) => {
                        pay(budget, run, unpaid);
                        return Probed::lost(format!("{why} within {step} steps"), None);
                    }
                }
            }
            if unpaid >= PAID {
                if !pay(budget, run, unpaid) {
                    return Probed {
                        fate: Fate::Impatient,
                        rate: None,
                    };
                }
                unpaid = 0;
            }
            if step >= rest {
                rest = step + end / WINDOWS as u64;
                if run.drowned() {
                    pay(budget, run, unpaid);
                    return Probed {
                        fate: Fate::Decays,
                        rate: None,
                    };
                }
            }
        }
        if !pay(budget, run, unpaid) {
            return Probed {
                fate: Fate::Impatient,
                rate: None,
            };
        }
        if maxima.judge(watch.clear).course != Course::Faint {
            break;
        }
    }
    let judged = maxima.judge(watch.clear);
    if judged.course == Course::Grows {
        return Probed::grows("its energy keeps growing", judged.rate);
    }
    // The last quarter.
    if high > 0 && high >= step - step / 4 {
        return Probed::grows("its energy stays far too high", judged.rate);
    }
    Probed {
        fate: match judged.course {
            Course::Falls => Fate::Decays,
            Course::Faint => Fate::Creeps,
            _ => Fate::Steady,
        },
        rate: Some(judged.rate),
    }
}
