//! Where to probe next: from a guess to the first step that fails, to 5e-4 of itself.

use super::growth::Maxima;
use super::probe::{Budget, Fate, Probed};
use super::setup::{STEPS, Setup};
use crate::measure::stability::Limit;
use crate::solvers::Unsupported;

/// An answer.
pub(super) struct Found {
    pub limit: Limit,
    /// How the first failing step fails, or how far was looked.
    pub reason: String,
}

/// Why a search ends before a limit is bracketed.
pub(super) enum Stop {
    /// There is none to bracket.
    Found(Found),
    Unsupported(Unsupported),
    /// The budget is spent.
    Impatient,
}

/// A step and what became of it.
#[derive(Clone)]
struct Tried {
    h: f64,
    probed: Probed,
}

/// How larger steps are tried.
struct Zone {
    /// Times the guess.
    upto: f64,
    /// From one step to the next.
    ratio: f64,
    /// Times as a full probe.
    shorter: u64,
}

/// One search.
pub(super) struct Search<'a, 'b> {
    pub setup: &'a Setup<'a>,
    pub budget: &'a mut Budget<'b>,
    /// The shortest time scale, s.
    pub unit: f64,
    /// The step found stable and the one found unstable, s, that a spent budget leaves behind.
    pub known: (Option<f64>, Option<f64>),
}

/// The answer's relative width, half of what is promised.
const WIDTH: f64 = 5e-4;
/// Largest step tried, in shortest time scales.
const FAR: f64 = 1e6;
/// Smallest.
const SMALL: f64 = 1e-5;
/// A good guess is seen to be one at this relative distance to either side.
const BESIDE: f64 = 2e-3;
/// Brief probes are so many times shorter: what fails far out or in a window fails soon.
const BRIEF: u64 = 5;
/// The farther from the guess, the coarser and the briefer.
const ZONES: [Zone; 3] = [
    Zone {
        upto: 4.0,
        ratio: 1.189_207_115_002_721,
        shorter: BRIEF,
    },
    Zone {
        upto: 32.0,
        ratio: 2.0,
        shorter: 2 * BRIEF,
    },
    Zone {
        upto: f64::INFINITY,
        ratio: 8.0,
        shorter: 4 * BRIEF,
    },
];
/// Factors of √2 below the limit that are looked through for windows.
const BELOW: i32 = 10;
/// Times a clear rise that cannot be overlooked.
const VISIBLE: f64 = 4.0;
/// Growth rates that belong to one power of h have exponents this close.
const SAME_POWER: f64 = 0.4;

impl Search<'_, '_> {
    /// `near` as in [`measure`](super::measure).
    pub fn limit(&mut self, near: Option<f64>) -> Result<Found, Stop> {
        let found = self
            .bracket(near)
            .and_then(|(stable, unstable)| self.within(stable, unstable));
        let mut found = match found {
            Ok(found) | Err(Stop::Found(found)) => found,
            Err(stop) => return Err(stop),
        };
        if self.setup.steps < STEPS {
            found.reason += &format!("; seen over {} steps at most", self.setup.steps);
        }
        Ok(found)
    }

    /// A stable step and a larger one that is not.
    fn bracket(&mut self, near: Option<f64>) -> Result<(Tried, Tried), Stop> {
        let mut first = self.full(near.map_or(2.0 * self.unit, |near| near * (1.0 - BESIDE)))?;
        if let Some(near) = near
            && !first.probed.unstable()
        {
            self.known = (Some(first.h), None);
            let beside = self.full(near * (1.0 + BESIDE))?;
            if beside.probed.unstable() {
                return Ok((first, beside));
            }
            first = beside;
        }
        if first.probed.unstable() {
            self.down(first)
        } else {
            self.up(first)
        }
    }

    fn try_at(&mut self, h: f64, steps: u64, extensions: u32) -> Result<Tried, Stop> {
        let probed = self
            .setup
            .probe(h, steps, extensions, self.budget)
            .map_err(Stop::Unsupported)?;
        if probed.fate == Fate::Impatient {
            return Err(Stop::Impatient);
        }
        Ok(Tried { h, probed })
    }

    fn full(&mut self, h: f64) -> Result<Tried, Stop> {
        self.try_at(h, self.setup.steps, 2)
    }

    /// From an unstable step to smaller ones, until one is stable.
    fn down(&mut self, first: Tried) -> Result<(Tried, Tried), Stop> {
        let mut unstable = vec![first];
        loop {
            let last = unstable.last().map_or(self.unit, |t| t.h);
            if last < SMALL * self.unit {
                return Err(never(last));
            }
            self.known = (None, Some(last));
            let tried = self.full(0.5 * last)?;
            if tried.probed.unstable() {
                unstable.push(tried);
                continue;
            }
            self.known = (None, None);
            if self.vanishes(&tried, &unstable)? {
                return Err(never(last));
            }
            let lowest = unstable.pop().ok_or_else(|| never(last))?;
            return Ok((tried, lowest));
        }
    }

    /// Whether growth does not end at `tried` but only falls below what can be seen: the energy still
    /// creeps up there and further down, or its rate fell like a power of the step so far.
    fn vanishes(&mut self, tried: &Tried, unstable: &[Tried]) -> Result<bool, Stop> {
        Ok(match tried.probed.fate {
            Fate::Creeps => {
                let further = self.full(tried.h * std::f64::consts::FRAC_1_SQRT_2)?;
                further.probed.fate == Fate::Creeps || self.power_law(unstable)
            }
            Fate::Steady => self.power_law(unstable),
            _ => false,
        })
    }

    /// Whether rates fall like a power of the step, to one too small to be seen at the next.
    fn power_law(&self, unstable: &[Tried]) -> bool {
        let seen = VISIBLE * self.setup.clear();
        power_law(unstable).is_some_and(|next| next * Maxima::span(self.setup.steps) < seen)
    }

    /// From a stable step to larger ones, until one is not.
    fn up(&mut self, first: Tried) -> Result<(Tried, Tried), Stop> {
        let guess = first.h;
        let end = FAR * self.unit.max(0.1 * guess);
        let mut stable = first;
        while stable.h < end {
            let zone = ZONES.iter().find(|zone| stable.h < zone.upto * guess);
            let Some(zone) = zone else { break };
            self.known = (Some(stable.h), None);
            let h = stable.h * zone.ratio;
            let tried = match self.try_at(h, self.setup.steps / zone.shorter, 0) {
                Err(Stop::Unsupported(Unsupported { reason })) => {
                    let ended = format!("; beyond it cannot run: {reason}");
                    return Err(unconditional(stable.h, &ended));
                }
                tried => tried?,
            };
            if tried.probed.unstable() {
                return Ok((stable, tried));
            }
            stable = tried;
        }
        // Briefly they were; once more at length, where nothing was tried at length yet.
        let last = match self.full(stable.h) {
            Err(Stop::Impatient) => return Err(unconditional(stable.h, ", looked at briefly")),
            last => last?,
        };
        if last.probed.unstable() {
            let first = Tried {
                h: guess,
                ..last.clone()
            };
            return Ok((first, last));
        }
        Err(unconditional(stable.h, ""))
    }

    /// From a bracket to the answer, once smaller steps have been looked through for a failing one.
    fn within(&mut self, stable: Tried, unstable: Tried) -> Result<Found, Stop> {
        let mut lower: Option<Tried> = None;
        for k in (1..=BELOW).rev() {
            self.known = (Some(stable.h), Some(unstable.h));
            let h = stable.h * 0.5_f64.powf(0.5 * f64::from(k));
            let tried = self.try_at(h, self.setup.steps.min(STEPS / BRIEF), 0)?;
            if tried.probed.unstable() {
                let (lower, tried) = match lower {
                    Some(lower) => (lower, tried),
                    // Unstable from there on: what was found stable is a window itself.
                    None => self.down(tried)?,
                };
                return self.bisect(lower, tried);
            }
            lower = Some(tried);
        }
        self.bisect(stable, unstable)
    }

    fn bisect(&mut self, stable: Tried, unstable: Tried) -> Result<Found, Stop> {
        let (mut low, mut high) = (stable.h, unstable);
        while high.h - low > WIDTH * low {
            // Halves ratios while they are large.
            let h = if high.h > 2.0 * low {
                (low * high.h).sqrt()
            } else {
                0.5 * (low + high.h)
            };
            self.known = (Some(low), Some(high.h));
            let tried = self.full(h)?;
            if tried.probed.unstable() {
                high = tried;
            } else {
                low = h;
            }
        }
        let why = match high.probed.fate {
            Fate::Grows { why, .. } => why,
            _ => String::new(),
        };
        Ok(Found {
            limit: Limit::At(low),
            reason: format!("at {:.4e} s {why}", high.h),
        })
    }
}

fn never(smallest: f64) -> Stop {
    Stop::Found(Found {
        limit: Limit::Never,
        reason: format!(
            "its energy grows at every step tried, down to {smallest:.2e} s, where it grows too \
             slowly to see"
        ),
    })
}

fn unconditional(largest: f64, ended: &str) -> Stop {
    Stop::Found(Found {
        limit: Limit::Unconditional,
        reason: format!("stable at every step tried, up to {largest:.2e} s{ended}"),
    })
}

/// The rate at half the last step, if the last three go like one power of the step.
fn power_law(unstable: &[Tried]) -> Option<f64> {
    let rates: Vec<f64> = unstable
        .iter()
        .rev()
        .map_while(|tried| tried.probed.rate.filter(|rate| *rate > 0.0))
        .take(3)
        .collect();
    let [low, middle, high] = rates.as_slice() else {
        return None;
    };
    let (below, above) = ((middle / low).log2(), (high / middle).log2());
    ((below - above).abs() < SAME_POWER && below > 0.5).then(|| low / below.exp2())
}
