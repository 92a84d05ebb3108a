//! Is this step stable? Runs are watched until it is clear.

use super::growth::{Course, Maxima, WINDOWS};
use super::perturbation::scramble;
use super::watched::{Gauge, Level, Runs};

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

    fn grows(why: impl Into<String>, lost: bool, rate: Option<f64>) -> Self {
        Self {
            fate: Fate::Grows {
                why: why.into(),
                lost,
            },
            rate,
        }
    }

    fn without_rate(fate: Fate) -> Self {
        Self { fate, rate: None }
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
    left: u64,
    /// In all.
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

    /// Steps, and what of `passes`, all they took, was more work than steps usually are. False when
    /// nothing is left.
    pub fn spend(&mut self, steps: u64, passes: u64) -> bool {
        self.taken += steps;
        (self.tick)(steps);
        let over = (passes / USUAL).saturating_sub(steps);
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

/// Steps are paid for in lots of so many.
const PAID: u64 = 256;

/// Steps the runs until the answer is clear.
pub(super) fn probe(
    runs: &mut Runs,
    gauge: &mut dyn Gauge,
    watch: Watch,
    budget: &mut Budget,
) -> Probed {
    let mut maxima = Maxima::new(watch.steps);
    let mut passes = runs.passes();
    let mut pay = |runs: &Runs, steps: u64| {
        let since = runs.passes().saturating_sub(passes);
        passes = runs.passes();
        budget.spend(runs.len() as u64 * steps, since)
    };
    let mut step = 0;
    let mut high = 0;
    for extension in 0..=watch.extensions {
        if extension > 0 {
            maxima.widen();
        }
        let end = maxima.steps();
        let window = end / WINDOWS as u64;
        let mut unpaid = 0;
        let mut look = step + 1;
        let mut rest = step + window;
        high = 0;
        while step < end {
            unpaid += 1;
            if let Err(error) = runs.step() {
                pay(runs, unpaid);
                return Probed::grows(format!("step {step} fails: {error}"), true, None);
            }
            step += 1;
            // Also at the end of every window: what grows is largest there.
            if step >= look || step >= rest {
                look = step + stride(step);
                let level = gauge.level(runs);
                if let Level::Log(level) | Level::High(level) = level {
                    maxima.push(step, level);
                }
                if let Level::High(_) = level {
                    high = step;
                }
                if let Some(ended) = ended(level, step) {
                    pay(runs, unpaid);
                    return ended;
                }
            }
            if unpaid >= PAID {
                if !pay(runs, unpaid) {
                    return Probed::without_rate(Fate::Impatient);
                }
                unpaid = 0;
            }
            if step >= rest {
                rest = step + window;
                if gauge.is_rounding(runs) {
                    pay(runs, unpaid);
                    return Probed::without_rate(Fate::Decays);
                }
            }
        }
        if !pay(runs, unpaid) {
            return Probed::without_rate(Fate::Impatient);
        }
        if maxima.judge(watch.clear).course != Course::Faint {
            break;
        }
    }
    let judged = maxima.judge(watch.clear);
    let rate = Some(judged.rate);
    let fate = match judged.course {
        Course::Grows => return Probed::grows("its energy keeps growing", false, rate),
        // In the last quarter.
        _ if high > 0 && high >= step - step / 4 => {
            return Probed::grows("its energy stays far too high", false, rate);
        }
        Course::Falls => Fate::Decays,
        Course::Faint => Fate::Creeps,
        Course::Level => Fate::Steady,
    };
    Probed { fate, rate }
}

/// The answer, if the energy after so many steps leaves no other.
fn ended(level: Level, step: u64) -> Option<Probed> {
    match level {
        Level::Log(_) | Level::High(_) => None,
        Level::Gone => Some(Probed::without_rate(Fate::Decays)),
        Level::Exploded(level) => Some(Probed::grows(
            match step {
                1 => "its energy explodes within one step".to_owned(),
                step => format!("its energy explodes within {step} steps"),
            },
            true,
            Some(level / step as f64),
        )),
        Level::NotFinite => Some(Probed::grows(
            format!("it left the range of finite numbers within {step} steps"),
            true,
            None,
        )),
    }
}
