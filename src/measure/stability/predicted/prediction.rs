//! The effect of a method on a linearised scene: on one part of it, and on several together.

use super::Limit;
use super::spectrum::Mode;

/// The effect of one method on a linearised scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    pub limit: Limit,
    /// How far the limit may be too large, relative: 0 where it is exact to rounding, 1 where nothing is sure.
    pub error: f64,
    /// ln(spectral radius) / h of the amplitude at the given timestep, 1/s; at most 0 where it is stable, 0
    /// where all motion is free. None where it would take the full spectrum of too many coordinates.
    pub growth_per_s: Option<f64>,
    /// Where nothing oscillates (drag alone, overdamped modes): the largest step, s, up to which every
    /// mode decays without changing sign from step to step; None where something oscillates in truth,
    /// where no step is too large (`reason` says so), and for splittings where damping couples modes.
    pub smooth_below_s: Option<f64>,
    /// The reason in words: which mode binds, how sure the limit is, or why there is none.
    pub reason: Option<String>,
    /// The mode that sets the limit.
    pub(super) binding: Option<Mode>,
}

impl Prediction {
    pub(super) fn unknown(why: impl Into<String>) -> Self {
        Self::only(Limit::Unknown(why.into()))
    }

    pub(super) fn only(limit: Limit) -> Self {
        Self {
            limit,
            error: 0.0,
            growth_per_s: None,
            smooth_below_s: None,
            reason: None,
            binding: None,
        }
    }

    /// The same with a limit that may be too large by `error`, relative.
    pub(super) fn within(self, error: f64) -> Self {
        let error = error.clamp(0.0, 1.0).max(self.error);
        Self { error, ..self }
    }

    /// The prediction for one mode, with its growth at `h`, s.
    pub(super) fn of(mode: Mode, limit: Limit, growth: f64, smooth: Option<f64>, h: f64) -> Self {
        let of = Self {
            smooth_below_s: smooth,
            binding: Some(mode),
            ..Self::only(limit)
        };
        of.growing(Some(growth), h)
    }

    /// The same with its growth at `h`, s. A stable step does not grow, so a positive rate there is rounding
    /// and becomes 0.
    pub(super) fn growing(self, growth: Option<f64>, h: f64) -> Self {
        let stable = self.limit.allows(h);
        let growth = growth.map(|growth| if stable { growth.min(0.0) } else { growth });
        Self {
            growth_per_s: growth,
            ..self
        }
    }

    /// The prediction for two parts together. `Never` outranks an unknown limit, and an unknown limit
    /// outranks a known one.
    pub(super) fn and(self, other: Self) -> Self {
        let growth_per_s = match (self.growth_per_s, other.growth_per_s) {
            (Some(a), Some(b)) => Some(a.max(b)),
            // One part that grows is enough.
            (one, another) => one.or(another).filter(|growth| *growth > 0.0),
        };
        let smooth = self.smooth_below_s.zip(other.smooth_below_s);
        let rank = |limit: &Limit| match limit {
            Limit::Never => 0,
            Limit::Unknown(_) => 1,
            Limit::At(_) | Limit::Between(..) => 2,
            Limit::Unconditional => 3,
        };
        let ours_binds = match (&self.limit, &other.limit) {
            (Limit::At(a), Limit::At(b)) => a <= b,
            // Of modes that are never stable, the fastest stands for all.
            (Limit::Never, Limit::Never) => {
                let rate = |of: &Self| of.binding.map_or(0.0, Mode::rate);
                rate(&self) >= rate(&other)
            }
            (a, b) => rank(a) <= rank(b),
        };
        Self {
            growth_per_s,
            smooth_below_s: smooth.map(|(a, b)| a.min(b)),
            ..if ours_binds { self } else { other }
        }
    }

    /// The prediction of a whole scene with its reason in words. `modes` counts what does not rest and
    /// `undamped` what of these does not decay. Before this call the reason only says how sure a limit is,
    /// and a step that is smooth without bound is infinite.
    pub(super) fn explained(self, undamped: usize, modes: usize) -> Self {
        let mode = self.binding.map(Mode::words);
        let reason = match &self.limit {
            Limit::Unknown(why) => Some(why.clone()),
            Limit::At(_) | Limit::Between(..) => {
                let words: Vec<String> = mode.into_iter().chain(self.reason).collect();
                (!words.is_empty()).then(|| words.join("; "))
            }
            Limit::Unconditional => (self.smooth_below_s == Some(f64::INFINITY))
                .then(|| "smooth at every step: nothing oscillates".to_owned()),
            Limit::Never if undamped > 0 && undamped < modes => mode.map(|mode| {
                let (are, those) = match undamped {
                    1 => ("is", "that"),
                    _ => ("are", "those"),
                };
                format!(
                    "{mode}; {undamped} of {modes} modes {are} undamped, and on {those} it is stable at \
                     no step"
                )
            }),
            Limit::Never => mode,
        };
        Self {
            growth_per_s: self.growth_per_s.filter(|growth| growth.is_finite()),
            smooth_below_s: self.smooth_below_s.filter(|smooth| smooth.is_finite()),
            reason,
            ..self
        }
    }
}
