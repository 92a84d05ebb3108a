//! The order a list of errors shows, and whether it shows any.

use std::fmt;

/// The error of one run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// The step, s, positive.
    pub h: f64,
    /// Its error, m: the largest over the horizon.
    pub error: f64,
    /// An error up to here may be the truth's or the rounding's, m: ten times the truth's error bar,
    /// plus what rounding may have added up to. Not to be confused with the bar itself, a tenth.
    pub floor: f64,
}

/// Ratios of steps an order is read from: four, of five points.
pub const RATIOS: usize = 4;

/// An order may be off by this much, and estimates may differ by this much among themselves.
pub const TOLERANCE: f64 = 0.05;

/// From the coarsest of five steps to the finest, each half the one before.
const SPAN: f64 = 16.0;

/// The order that a list of errors shows.
#[derive(Debug, Clone, PartialEq)]
pub struct Observed {
    /// The order the method claims.
    pub stated: u32,
    /// The order seen; None where the verdict is inconclusive.
    pub order: Option<f64>,
    /// How far its estimates from neighbouring steps differ; at most [`TOLERANCE`] where there is an
    /// order. None where there are too few points to estimate anything from.
    pub spread: Option<f64>,
    /// The points the estimates come from, coarse to fine. Empty where there were too few.
    pub used: Vec<Point>,
    pub verdict: Verdict,
}

/// The order seen against the order stated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Within [`TOLERANCE`].
    Meets,
    /// Higher: more than was promised, as happens where a leading error term vanishes.
    Above,
    /// Lower: the method is not what it claims to be.
    Misses,
    Inconclusive(Reason),
}

/// The reason why errors show no order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reason {
    /// No error at any step is above the floor.
    Exact,
    /// Too few errors are above the floor, or they reach it before they settle.
    AtFloor,
    /// Too few steps gave an error at all.
    TooFew,
    /// The slopes still change: the steps are too coarse.
    NotAsymptotic,
    /// The forces jump or have a kink along the motion: a method known to be good falls short of its
    /// order, too. Only a [`Study`](super::Study), which runs one, says so.
    NotSmooth,
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Exact => {
                "exact here: at no step does an error rise above rounding and the truth's own"
            }
            Self::AtFloor => {
                "at the floor: rounding or the truth's own error covers the finer steps"
            }
            Self::TooFew => "too few steps gave an error",
            Self::NotAsymptotic => {
                "not yet asymptotic: the steps are too coarse to follow the motion, or the observed order still changes with them"
            }
            Self::NotSmooth => {
                "the forces are not smooth along this motion: classical Runge-Kutta falls short of its order here, too"
            }
        })
    }
}

/// Reads the order off the errors of at least five steps, in any sequence.
///
/// With e = C h^p (1 + c h + ...), the slope of ln e over ln h between two neighbouring steps is
/// p + c g, with g their logarithmic mean; two neighbouring slopes give p without the term in c
/// (Richardson 1911). The four finest slopes, or the three extrapolations from them, whichever agree
/// better, are the estimates; the finest of them is the order, their range the spread. They are in
/// the asymptotic range when they agree within [`TOLERANCE`]. Where steps lie closer than a factor 2
/// the range counts for more, by what the five steps lack of a factor 16: estimates that change
/// slowly only because the steps do are not settled.
///
/// Points with an error at or below their floor are left out. A point within a factor ten of its
/// floor, of which the truth's own error may be a hundredth, is used if the slopes settle with it,
/// and left out otherwise; one farther above never is, so that a low-order term that shows at fine
/// steps only is not overlooked. Points that are not finite are left out.
///
/// The errors cannot show everything: steps so coarse that the method no longer follows the motion
/// at all can give settled slopes of any value.
pub fn observed(points: &[Point], stated: u32) -> Observed {
    let given = usable(points);
    let above = given.iter().copied().filter(|p| p.error > p.floor);
    let above: Vec<Point> = above.collect();
    let inconclusive = |reason, spread, used: &[Point]| Observed {
        stated,
        order: None,
        spread,
        used: used.to_vec(),
        verdict: Verdict::Inconclusive(reason),
    };
    if given.len() <= RATIOS {
        return inconclusive(Reason::TooFew, None, &[]);
    }
    if above.is_empty() {
        return inconclusive(Reason::Exact, None, &[]);
    }
    let floored = given.last() != above.last();
    let mut unsettled = None;
    for end in (RATIOS + 1..=above.len()).rev() {
        let used = &above[end - RATIOS - 1..end];
        let estimate = Estimate::of(used);
        if estimate.spread <= TOLERANCE {
            return Observed {
                stated,
                order: Some(estimate.order),
                spread: Some(estimate.spread),
                used: used.to_vec(),
                verdict: judge(estimate.order, stated),
            };
        }
        let (spread, unsettled) = *unsettled.get_or_insert((estimate.spread, used));
        let finest = &above[end - 1];
        if finest.error > 10.0 * finest.floor {
            let reason = if floored || end < above.len() {
                Reason::AtFloor
            } else {
                Reason::NotAsymptotic
            };
            return inconclusive(reason, Some(spread), unsettled);
        }
    }
    match unsettled {
        Some((spread, used)) => inconclusive(Reason::AtFloor, Some(spread), used),
        None if above.len() < given.len() => inconclusive(Reason::AtFloor, None, &[]),
        None => inconclusive(Reason::TooFew, None, &[]),
    }
}

/// Finite points of different steps, coarse to fine.
fn usable(points: &[Point]) -> Vec<Point> {
    let fine = |p: &&Point| {
        p.h > 0.0 && p.h.is_finite() && p.error >= 0.0 && p.error.is_finite() && p.floor >= 0.0
    };
    let mut usable: Vec<Point> = points.iter().filter(fine).copied().collect();
    usable.sort_by(|a, b| b.h.total_cmp(&a.h));
    // Steps closer than this have no slope between them.
    usable.dedup_by(|finer, coarser| finer.h > 0.99 * coarser.h);
    usable
}

fn judge(order: f64, stated: u32) -> Verdict {
    let off = order - f64::from(stated);
    if off < -TOLERANCE {
        Verdict::Misses
    } else if off > TOLERANCE {
        Verdict::Above
    } else {
        Verdict::Meets
    }
}

struct Estimate {
    order: f64,
    spread: f64,
}

impl Estimate {
    /// The estimate from points coarse to fine, with positive errors.
    fn of(points: &[Point]) -> Self {
        // The slope between two steps, and where it belongs: their logarithmic mean.
        let slopes: Vec<(f64, f64)> = points
            .windows(2)
            .map(|w| {
                let ratio = (w[0].h / w[1].h).ln();
                // The logarithms are taken apart, since a quotient may overflow.
                let slope = (w[0].error.ln() - w[1].error.ln()) / ratio;
                (slope, (w[0].h - w[1].h) / ratio)
            })
            .collect();
        let raw = slopes.iter().map(|(slope, _)| *slope);
        let extrapolated = slopes.windows(2).map(|w| {
            let ((coarse, at), (fine, below)) = (w[0], w[1]);
            fine + (fine - coarse) * below / (at - below)
        });
        let (raw, extrapolated) = (Self::finest(raw), Self::finest(extrapolated));
        let closer = if raw.spread <= extrapolated.spread {
            raw
        } else {
            extrapolated
        };
        let span = points.first().zip(points.last());
        let span = span.map_or(1.0, |(coarse, fine)| coarse.h / fine.h);
        Self {
            order: closer.order,
            spread: closer.spread * f64::max(1.0, SPAN / span),
        }
    }

    /// The last of these, and their range.
    fn finest(estimates: impl Iterator<Item = f64>) -> Self {
        let (mut low, mut high, mut last) = (f64::INFINITY, f64::NEG_INFINITY, 0.0);
        for estimate in estimates {
            (low, high, last) = (low.min(estimate), high.max(estimate), estimate);
        }
        Self {
            order: last,
            spread: high - low,
        }
    }
}
