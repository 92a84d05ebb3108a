//! What a method does to one part, and to several.

use super::Limit;
use super::mode::Mode;

#[derive(Debug, Clone)]
pub(super) struct Verdict {
    pub limit: Limit,
    /// The largest of ln(modulus) / h at the timestep asked for, 1/s; None where nobody knows.
    pub growth: Option<f64>,
    /// Infinite where no mode ever changes its sign; None where one oscillates in truth, or nobody
    /// knows.
    pub smooth: Option<f64>,
    /// The mode that sets the limit.
    pub binding: Option<Mode>,
    /// How sure the limit is, where it is not.
    pub note: Option<String>,
}

impl Verdict {
    pub(super) fn unknown(why: &str) -> Self {
        Self {
            limit: Limit::Unknown(why.to_owned()),
            growth: None,
            smooth: None,
            binding: None,
            note: None,
        }
    }

    /// A mode's: a step that is stable does not grow, whatever rounding says.
    pub(super) fn of(limit: Limit, growth: f64, smooth: Option<f64>, h: f64, mode: Mode) -> Self {
        let stable = match limit {
            Limit::Unconditional => true,
            Limit::At(limit) | Limit::Between(limit, _) => h <= limit,
            Limit::Never | Limit::Unknown(_) => false,
        };
        Self {
            limit,
            growth: Some(if stable { growth.min(0.0) } else { growth }),
            smooth,
            binding: Some(mode),
            note: None,
        }
    }

    /// Of both together: never beats unknown, unknown beats what is known.
    pub(super) fn and(self, other: Self) -> Self {
        let growth = match (self.growth, other.growth) {
            (Some(a), Some(b)) => Some(a.max(b)),
            // One that grows is enough to say so.
            (one, another) => one.or(another).filter(|growth| *growth > 0.0),
        };
        let smooth = self.smooth.zip(other.smooth).map(|(a, b)| a.min(b));
        let ours_binds = match (rank(&self.limit), rank(&other.limit)) {
            (a, b) if a == b => match (&self.limit, &other.limit) {
                (Limit::At(a), Limit::At(b)) => a <= b,
                // Of modes that are never stable, the fastest stands for all.
                (Limit::Never, Limit::Never) => {
                    let rate = |v: &Self| v.binding.map_or(0.0, Mode::rate);
                    rate(&self) >= rate(&other)
                }
                _ => true,
            },
            (a, b) => a < b,
        };
        let binding = if ours_binds { self } else { other };
        Self {
            growth,
            smooth,
            ..binding
        }
    }
}

fn rank(limit: &Limit) -> u8 {
    match limit {
        Limit::Never => 0,
        Limit::Unknown(_) => 1,
        Limit::At(_) | Limit::Between(..) => 2,
        Limit::Unconditional => 3,
    }
}
