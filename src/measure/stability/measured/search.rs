//! The choice of the next probe: from a guess to the first step that fails, to 5e-4 of itself.

use super::experiment::{Experiment, Found, STEPS, Stop};
use super::probe::{ProbeOutcome, Probed, span};
use crate::measure::stability::Limit;
use crate::solvers::Unsupported;

/// A step and the answer of its probe.
#[derive(Clone)]
struct Tried {
    h: f64,
    probed: Probed,
}

/// Relative width to which a limit is promised.
const PROMISED: f64 = 1e-3;
/// The width the search goes to where the map is linear: half of that. Elsewhere limits are not sharper than
/// what is promised.
pub(super) const WIDTH: f64 = 5e-4;
/// Largest step tried, in shortest time scales.
const FAR: f64 = 1e6;
/// Smallest step tried, in shortest time scales.
const SMALL: f64 = 1e-5;
/// A good guess is seen to be one at this relative distance to either side.
const BESIDE: f64 = 2e-3;
/// Brief probes are this many times shorter: what fails far out or in a window fails soon.
const BRIEF: u64 = 5;
/// The zones in which larger steps are tried: up to this many times the guess, by this ratio from one to
/// the next, in probes this many times shorter than a full one. Farther from the guess, steps are coarser
/// and probes briefer.
const ZONES: [(f64, f64, u64); 3] = [
    (4.0, 1.189_207_115_002_721, BRIEF),
    (32.0, 2.0, 2 * BRIEF),
    (f64::INFINITY, 8.0, 4 * BRIEF),
];
/// Factors of √2 below the limit that are searched for windows of instability.
const BELOW: i32 = 10;
/// A rise of this many times a clear one cannot be overlooked.
const VISIBLE: f64 = 4.0;
/// Growth rates that belong to one power of h have exponents this close.
const SAME_POWER: f64 = 0.4;

impl Experiment<'_> {
    /// The limit and its reason in words. `near` and `budget` as in [`measure`](super::measure).
    pub fn limit(&mut self, near: Option<f64>, budget: u64) -> (Limit, Option<String>) {
        let bracket = self.bracket(near);
        match bracket.and_then(|(stable, unstable)| self.within(stable, unstable)) {
            Ok((limit, mut reason)) | Err(Stop::Found((limit, mut reason))) => {
                if self.shortest < STEPS {
                    reason += &format!("; seen over {} steps at most", self.shortest);
                }
                (limit, Some(reason))
            }
            Err(Stop::Unsupported(Unsupported { reason })) => (Limit::Unknown(reason), None),
            Err(Stop::Spent) => unfinished(self.known, budget),
        }
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
        let probed = self.probe(h, steps, extensions)?;
        Ok(Tried { h, probed })
    }

    fn full(&mut self, h: f64) -> Result<Tried, Stop> {
        self.try_at(h, self.steps, 2)
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
        Ok(match tried.probed.outcome {
            ProbeOutcome::Creeps => {
                let further = self.full(tried.h * std::f64::consts::FRAC_1_SQRT_2)?;
                further.probed.outcome == ProbeOutcome::Creeps || self.power_law(unstable)
            }
            ProbeOutcome::Steady => self.power_law(unstable),
            _ => false,
        })
    }

    /// Whether rates fall like a power of the step, to one too small to be seen at the next.
    fn power_law(&self, unstable: &[Tried]) -> bool {
        let seen = VISIBLE * self.clear();
        power_law(unstable).is_some_and(|next| next * span(self.steps) < seen)
    }

    /// From a stable step to larger ones, until one is not.
    fn up(&mut self, first: Tried) -> Result<(Tried, Tried), Stop> {
        let guess = first.h;
        let end = FAR * self.unit.max(0.1 * guess);
        let mut stable = first;
        while stable.h < end {
            let zone = ZONES.iter().find(|(upto, ..)| stable.h < upto * guess);
            let Some((_, ratio, shorter)) = zone else {
                break;
            };
            self.known = (Some(stable.h), None);
            let tried = match self.try_at(stable.h * ratio, self.steps / shorter, 0) {
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
        // All were stable in brief probes; the last is probed in full, since nothing was yet.
        let last = match self.full(stable.h) {
            Err(Stop::Spent) => return Err(unconditional(stable.h, ", looked at briefly")),
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
            let tried = self.try_at(h, self.steps.min(STEPS / BRIEF), 0)?;
            if tried.probed.unstable() {
                let (lower, tried) = match lower {
                    Some(lower) => (lower, tried),
                    // Every smaller step is unstable so far: the step found stable is in a window itself.
                    None => self.down(tried)?,
                };
                return self.bisect(lower, tried);
            }
            lower = Some(tried);
        }
        self.bisect(stable, unstable)
    }

    fn bisect(&mut self, stable: Tried, unstable: Tried) -> Result<Found, Stop> {
        let (first, mut failing) = (stable.h, unstable);
        self.known = (Some(first), Some(failing.h));
        let width = if self.is_linear() { WIDTH } else { PROMISED };
        let low = bisect(first, failing.h, width, |h| -> Result<bool, Stop> {
            let tried = self.full(h)?;
            if tried.probed.unstable() {
                self.known.1 = Some(h);
                failing = tried;
                return Ok(false);
            }
            self.known.0 = Some(h);
            Ok(true)
        })?;
        let why = match failing.probed.outcome {
            ProbeOutcome::Grows { why, .. } => why,
            _ => String::new(),
        };
        Ok((Limit::At(low), format!("at {:.4e} s {why}", failing.h)))
    }
}

/// The largest step found at which something holds that does so at `low` and not at `high`: to a relative
/// `width`.
pub(super) fn bisect<E>(
    mut low: f64,
    mut high: f64,
    width: f64,
    mut holds: impl FnMut(f64) -> Result<bool, E>,
) -> Result<f64, E> {
    while high - low > width * low {
        // Halves ratios while they are large.
        let h = if high > 2.0 * low {
            (low * high).sqrt()
        } else {
            0.5 * (low + high)
        };
        if holds(h)? {
            low = h;
        } else {
            high = h;
        }
    }
    Ok(low)
}

/// The answer when the budget ends: a step found stable, and one found unstable.
fn unfinished(known: (Option<f64>, Option<f64>), budget: u64) -> (Limit, Option<String>) {
    let ended = format!("no closer within {budget} steps");
    let why = match known {
        (Some(low), Some(high)) if low < high && high - low <= PROMISED * low => {
            return (Limit::At(low), Some(format!("unstable at {high:.4e} s")));
        }
        (Some(low), Some(high)) if low < high => {
            let why = format!("between {low:.3e} s (stable) and {high:.3e} s (unstable), {ended}");
            return (Limit::Between(low, high), Some(why));
        }
        (Some(low), _) => {
            format!("stable at {low:.3e} s; larger steps were not tried, {ended}")
        }
        (None, Some(high)) => {
            format!("unstable at {high:.3e} s; smaller steps were not tried, {ended}")
        }
        (None, None) => ended,
    };
    (Limit::Unknown(why), None)
}

fn never(smallest: f64) -> Stop {
    let reason = format!(
        "its energy grows at every step tried, down to {smallest:.2e} s, where it grows too slowly to \
         see"
    );
    Stop::Found((Limit::Never, reason))
}

fn unconditional(largest: f64, ended: &str) -> Stop {
    let reason = format!("stable at every step tried, up to {largest:.2e} s{ended}");
    Stop::Found((Limit::Unconditional, reason))
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
