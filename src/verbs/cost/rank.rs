//! The answers a sweep of settings gives: which reach an error, at what cost, and how fast errors fall.
//!
//! Pure functions of [`CostPoint`]s, coarse to fine.

#[cfg(test)]
mod tests;

use crate::solvers::Status;
use crate::verbs::cost::{CostCurve, CostPoint, CostRank, CostReached, CostTarget};
use std::cmp::Ordering;

/// Indices of the points on the Pareto front of error and work. A point is on it if no other has at most
/// its error and at most its work, with one of the two less. Equal points are all kept; points without an
/// error are not. Work is counted, so the answer is the same in every run.
pub fn pareto(points: &[CostPoint]) -> Vec<usize> {
    let known = |at: &usize| Some((points[*at].error_m?, points[*at].work()));
    let beaten = |(error, work): (f64, u64)| {
        let mut others = points.iter().filter_map(|p| Some((p.error_m?, p.work())));
        others.any(|other| other.0 <= error && other.1 <= work && other != (error, work))
    };
    let kept = |at: &usize| known(at).is_some_and(|own| !beaten(own));
    (0..points.len()).filter(kept).collect()
}

/// The fewest points a slope is fitted through.
const MIN_POINTS: usize = 4;
/// Neighbouring slopes of one straight line differ by no more than this. The error term of the next order
/// adds about its ratio to the slope, so a line fitted within this is off by half of it at most.
const MAX_SLOPE_CHANGE: f64 = 0.15;

/// Points at the fine end that rounding may have spoilt without reaching the floor.
const MAX_SPOILT: usize = 2;

/// Orders are whole numbers from 1 on: an error that falls slower than this has not begun to converge.
const MIN_SLOPE: f64 = 0.75;

/// A fitted slope.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedSlope {
    /// d ln(error) / d ln(step).
    pub order: f64,
    /// Indices of the points it was fitted through, coarse to fine.
    pub points: Vec<usize>,
}

/// The slope of ln(error) over ln(step) through the finest points of `points` (coarse to fine) that lie
/// on a straight line: neither in the floor, nor so coarse that the slope still changes.
///
/// Not to be confused with [`order`](crate::measure::order), which makes runs of its own, finds orders to
/// 0.05 and calls a method wrong; this slope is read off the settings of a diagram. None with fewer than
/// four such points.
pub fn slope(points: &[CostPoint]) -> Option<FittedSlope> {
    let usable: Vec<(usize, f64, f64)> = points
        .iter()
        .enumerate()
        .filter(|(_, point)| !point.at_floor)
        .filter_map(|(at, point)| {
            let error = point.error_m.filter(|error| *error > 0.0)?;
            Some((at, point.timestep.ln(), error.ln()))
        })
        .collect();
    // The line starts at the finest point and grows as long as neighbouring slopes agree. Where the finest
    // do not agree, one is left out at a time: rounding may already show in it.
    let mut best: Option<FittedSlope> = None;
    for end in (MIN_POINTS..=usable.len()).rev().take(MAX_SPOILT + 1) {
        let line = straight(&usable[..end]);
        if line.len() >= MIN_POINTS && best.as_ref().is_none_or(|b| line.len() > b.points.len()) {
            best = fitted(line);
        }
    }
    best
}

/// The longest tail whose neighbouring slopes agree with its last one.
fn straight(points: &[(usize, f64, f64)]) -> &[(usize, f64, f64)] {
    let between = |pair: &[(usize, f64, f64)]| (pair[1].2 - pair[0].2) / (pair[1].1 - pair[0].1);
    let slopes: Vec<f64> = points.windows(2).map(between).collect();
    let Some(last) = slopes.last() else {
        return points;
    };
    let agree = slopes
        .iter()
        .rev()
        .take_while(|s| **s >= MIN_SLOPE && (*s - last).abs() <= MAX_SLOPE_CHANGE);
    &points[points.len() - 1 - agree.count()..]
}

/// The least-squares line through these points.
fn fitted(points: &[(usize, f64, f64)]) -> Option<FittedSlope> {
    let n = points.len() as f64;
    let mean = |value: fn(&(usize, f64, f64)) -> f64| points.iter().map(value).sum::<f64>() / n;
    let (x, y) = (mean(|p| p.1), mean(|p| p.2));
    let (mut over, mut under) = (0.0, 0.0);
    for point in points {
        over += (point.1 - x) * (point.2 - y);
        under += (point.1 - x) * (point.1 - x);
    }
    let order = over / under;
    order.is_finite().then(|| FittedSlope {
        order,
        points: points.iter().map(|p| p.0).collect(),
    })
}

/// Why a curve does not reach a target.
#[derive(Debug, Clone, PartialEq)]
pub enum Unreached {
    /// No setting tried has an error as small; the smallest found, m.
    Nearest(f64),
    /// Some setting has an error small enough, but the finest has not: a lucky zero crossing, or rounding.
    /// The error of the finest, m.
    Unsettled(f64),
    /// The finest setting has no error.
    Ended,
    /// No setting was tried.
    Nothing,
}

/// The first of `points` (coarse to fine) from which on every finer one, itself included, has at most
/// the error `target`, m.
///
/// Not to be confused with the coarsest that has: an error that changes its sign passes through 0, and a
/// setting there would be credited with an accuracy that its neighbours on both sides do not have.
///
/// # Errors
/// [`Unreached`] where the finest does not reach it.
pub fn reach(points: &[CostPoint], target: f64) -> Result<usize, Unreached> {
    let near = |point: &CostPoint| {
        point.status == Status::Completed && point.error_m.is_some_and(|error| error <= target)
    };
    let fine = points.iter().rev().take_while(|p| near(p)).count();
    if fine > 0 {
        return Ok(points.len() - fine);
    }
    let Some(finest) = points.last() else {
        return Err(Unreached::Nothing);
    };
    let Some(error) = finest.error_m else {
        return Err(Unreached::Ended);
    };
    let errors = points.iter().filter_map(|point| point.error_m);
    let nearest = errors.fold(error, f64::min);
    Err(if nearest <= target {
        Unreached::Unsettled(error)
    } else {
        Unreached::Nearest(nearest)
    })
}

/// Extrapolating by more steps than this is guessing; so is extrapolating a line that hardly falls.
const MAX_MORE_STEPS: f64 = 1e4;
const MIN_EXTRAPOLATED_SLOPE: f64 = 0.5;

/// The answer for one target, m, over all curves. With a `reason` why errors cannot be held against the
/// target, the answer holds that reason alone.
pub fn target(curves: &[CostCurve], error: f64, reason: Option<String>) -> CostTarget {
    let mut answer = CostTarget {
        error_m: error,
        cheapest: None,
        fewest_evaluations: None,
        ranking: Vec::new(),
        reference: Vec::new(),
        reason,
    };
    if answer.reason.is_some() {
        return answer;
    }
    let ranks = |ranked: bool| {
        let curves = curves
            .iter()
            .filter(move |curve| curve.is_ranked() == ranked);
        curves.map(|curve| rank(curve, error))
    };
    answer.ranking = ranks(true).collect();
    answer.reference = ranks(false).collect();
    // The sort is stable: equal and untimed entries stay in the order of the curves.
    answer.ranking.sort_by(cheaper);
    let reached = answer.ranking.iter().filter_map(|r| r.reached.as_ref());
    answer.cheapest = reached.clone().next().cloned();
    let counted = reached.filter(|r| r.force_evaluations.is_some());
    // Of equal counts the most accurate, so that the clock has no say.
    let fewest = counted.min_by(|one, other| {
        let counts = one.force_evaluations.cmp(&other.force_evaluations);
        counts.then(one.error_m.total_cmp(&other.error_m))
    });
    answer.fewest_evaluations = fewest.cloned();
    let least = answer.cheapest.as_ref().and_then(|c| c.wall_median_s);
    for rank in answer.ranking.iter_mut().chain(&mut answer.reference) {
        let own = rank.reached.as_ref().and_then(|r| r.wall_median_s);
        let ratio = own.zip(least).map(|(own, least)| own / least);
        rank.wall_ratio = ratio.filter(|ratio| ratio.is_finite());
        let curve = curves.iter().find(|curve| curve.engine == rank.engine);
        let finest = curve.and_then(|curve| curve.points.last()?.wall_s.as_ref());
        let ratio = finest.zip(rank.more_steps).zip(least);
        let ratio = ratio.map(|((wall, more), least)| wall.median * more / least);
        rank.extrapolated_wall_ratio = ratio.filter(|ratio| ratio.is_finite());
    }
    answer
}

fn rank(curve: &CostCurve, error: f64) -> CostRank {
    let mut rank = CostRank {
        engine: curve.engine.clone(),
        reached: None,
        wall_ratio: None,
        more_steps: None,
        extrapolated_wall_ratio: None,
        reason: None,
    };
    match reach(&curve.points, error) {
        Ok(at) => {
            let point = &curve.points[at];
            rank.reached = Some(CostReached {
                engine: curve.engine.clone(),
                timestep: point.timestep,
                tolerance: point.tolerance,
                error_m: point.error_m.unwrap_or(error),
                wall_median_s: point.wall_s.as_ref().map(|wall| wall.median),
                force_evaluations: point.force_evaluations,
                at_most: at == 0,
            });
        }
        Err(unreached) => {
            if let Unreached::Nearest(nearest) = unreached {
                rank.more_steps = more_steps(curve, nearest, error);
            }
            rank.reason = Some(reason(curve, &unreached));
        }
    }
    rank
}

fn reason(curve: &CostCurve, unreached: &Unreached) -> String {
    match unreached {
        Unreached::Nearest(error) => format!("nearest {error:.1e} m at the settings tried"),
        Unreached::Unsettled(error) => {
            format!("near enough at a coarser setting only: {error:.1e} m at the finest")
        }
        Unreached::Ended | Unreached::Nothing => {
            let reason = curve.points.last().and_then(|point| point.reason.clone());
            reason.unwrap_or_else(|| "no setting gave an error".to_owned())
        }
    }
}

/// Times the steps of the finest setting that would reach the target by the curve's slope, where the
/// finest setting is still on the fitted line.
fn more_steps(curve: &CostCurve, nearest: f64, target: f64) -> Option<f64> {
    let order = curve
        .observed_order
        .filter(|order| *order > MIN_EXTRAPOLATED_SLOPE)?;
    let on_line = curve.slope_points.last() == Some(&curve.points.len().checked_sub(1)?);
    let times = (nearest / target).powf(1.0 / order);
    (on_line && times < MAX_MORE_STEPS).then_some(times)
}

/// Orders by median time, then untimed entries by evaluations; entries that do not reach the target come
/// last.
fn cheaper(a: &CostRank, b: &CostRank) -> Ordering {
    let key = |rank: &CostRank| {
        let reached = rank.reached.as_ref();
        let time = reached.and_then(|r| r.wall_median_s);
        let count = reached.and_then(|r| r.force_evaluations);
        (
            reached.is_none(),
            time.unwrap_or(f64::INFINITY),
            count.unwrap_or(u64::MAX),
        )
    };
    key(a).partial_cmp(&key(b)).unwrap_or(Ordering::Equal)
}
