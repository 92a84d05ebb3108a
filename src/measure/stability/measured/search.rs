//! Where to probe next: from a guess to the first step that fails, to 5e-4 of itself.

use super::Limit;
use super::bench::{Bench, STEPS};
use super::growth::Maxima;
use super::probe::{Budget, Fate, Probed};
use crate::engines::Unsupported;

/// An answer.
pub(super) struct Found {
    pub limit: Limit,
    /// How the first failing step fails, or how far was looked.
    pub reason: String,
}

/// Why a search ends without an answer.
pub(super) enum Stop {
    Unsupported(Unsupported),
    Impatient {
        stable: Option<f64>,
        unstable: Option<f64>,
    },
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
    pub bench: &'a Bench<'a>,
    pub budget: &'a mut Budget<'b>,
    /// The shortest time scale, s.
    pub unit: f64,
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
        let mut found = self.found(near)?;
        if self.bench.steps < STEPS {
            found.reason += &format!("; seen over {} steps at most", self.bench.steps);
        }
        Ok(found)
    }

    fn found(&mut self, near: Option<f64>) -> Result<Found, Stop> {
        let mut first = self.full(near.map_or(2.0 * self.unit, |near| near * (1.0 - BESIDE)))?;
        if let Some(near) = near
            && !first.probed.unstable()
        {
            let beside = self
                .full(near * (1.0 + BESIDE))
                .map_err(|stop| known(stop, Some(first.h), None))?;
            if beside.probed.unstable() {
                return self.below(first, beside);
            }
            first = beside;
        }
        let (stable, unstable) = if first.probed.unstable() {
            match self.down(first)? {
                Ok(bracket) => bracket,
                Err(never) => return Ok(never),
            }
        } else {
            match self.up(first)? {
                Ok(bracket) => bracket,
                Err(unconditional) => return Ok(unconditional),
            }
        };
        self.below(stable, unstable)
    }

    fn try_at(&mut self, h: f64, steps: u64, extensions: u32) -> Result<Tried, Stop> {
        let probed = self
            .bench
            .probe(h, steps, extensions, self.budget)
            .map_err(Stop::Unsupported)?;
        if probed.fate == Fate::Impatient {
            return Err(Stop::Impatient {
                stable: None,
                unstable: None,
            });
        }
        Ok(Tried { h, probed })
    }

    fn full(&mut self, h: f64) -> Result<Tried, Stop> {
        self.try_at(h, self.bench.steps, 2)
    }

    /// From an unstable step to smaller ones. Err is an answer: none is stable.
    fn down(&mut self, first: Tried) -> Result<Result<(Tried, Tried), Found>, Stop> {
        let mut unstable = vec![first];
        loop {
            let last = unstable.last().map_or(self.unit, |t| t.h);
            if last < SMALL * self.unit {
                return Ok(Err(self.never(last)));
            }
            let tried = self
                .full(0.5 * last)
                .map_err(|stop| known(stop, None, Some(last)))?;
            if tried.probed.unstable() {
                unstable.push(tried);
                continue;
            }
            if self.vanishes(&tried, &unstable)? {
                return Ok(Err(self.never(last)));
            }
            let lowest = unstable.pop();
            return match lowest {
                Some(lowest) => Ok(Ok((tried, lowest))),
                None => Ok(Err(self.never(last))),
            };
        }
    }

    fn never(&self, smallest: f64) -> Found {
        Found {
            limit: Limit::Never,
            reason: format!(
                "its energy grows at every step tried, down to {smallest:.2e} s, where it grows too \
                 slowly to see"
            ),
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
        let seen = VISIBLE * self.bench.clear();
        power_law(unstable).is_some_and(|next| next * Maxima::span(self.bench.steps) < seen)
    }

    /// From a stable step to larger ones. Err is an answer: all are stable.
    fn up(&mut self, first: Tried) -> Result<Result<(Tried, Tried), Found>, Stop> {
        let guess = first.h;
        let end = FAR * self.unit.max(0.1 * guess);
        let mut stable = first;
        while stable.h < end {
            let zone = ZONES.iter().find(|zone| stable.h < zone.upto * guess);
            let Some(zone) = zone else { break };
            let h = stable.h * zone.ratio;
            let tried = match self.try_at(h, self.bench.steps / zone.shorter, 0) {
                Err(Stop::Unsupported(unsupported)) => {
                    return Ok(Err(self.unconditional(stable.h, &unsupported.reason, "")));
                }
                other => other.map_err(|stop| known(stop, Some(stable.h), None))?,
            };
            if tried.probed.unstable() {
                return Ok(Ok((stable, tried)));
            }
            stable = tried;
        }
        // Briefly they were; once more at length, where nothing was tried at length yet.
        let last = match self.full(stable.h) {
            Err(Stop::Impatient { .. }) => {
                return Ok(Err(self.unconditional(stable.h, "", "looked at briefly")));
            }
            other => other?,
        };
        if last.probed.unstable() {
            return Ok(Ok((
                Tried {
                    h: guess,
                    ..last.clone()
                },
                last,
            )));
        }
        Ok(Err(self.unconditional(stable.h, "", "")))
    }

    fn unconditional(&self, largest: f64, why: &str, how: &str) -> Found {
        let ended = match (why, how) {
            ("", "") => String::new(),
            ("", how) => format!(", {how}"),
            (why, _) => format!("; beyond it cannot run: {why}"),
        };
        Found {
            limit: Limit::Unconditional,
            reason: format!("stable at every step tried, up to {largest:.2e} s{ended}"),
        }
    }

    /// From a bracket to the answer, once smaller steps have been looked through for a failing one.
    fn below(&mut self, stable: Tried, unstable: Tried) -> Result<Found, Stop> {
        let mut lower: Option<Tried> = None;
        for k in (1..=BELOW).rev() {
            let h = stable.h * 0.5_f64.powf(0.5 * f64::from(k));
            let tried = self
                .try_at(h, self.bench.steps.min(STEPS / BRIEF), 0)
                .map_err(|stop| known(stop, Some(stable.h), Some(unstable.h)))?;
            if tried.probed.unstable() {
                let bracket = match lower {
                    Some(lower) => Ok((lower, tried)),
                    // Unstable from there on: what was found stable is a window itself.
                    None => self.down(tried)?,
                };
                return match bracket {
                    Ok((lower, tried)) => self.bisect(lower, tried),
                    Err(never) => Ok(never),
                };
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
            let tried = self
                .full(h)
                .map_err(|stop| known(stop, Some(low), Some(high.h)))?;
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

/// What is known when patience ends.
fn known(stop: Stop, stable: Option<f64>, unstable: Option<f64>) -> Stop {
    match stop {
        Stop::Impatient { .. } => Stop::Impatient { stable, unstable },
        other => other,
    }
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
