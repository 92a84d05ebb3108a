//! What a sweep of settings says: which reach an error, at what price, and how fast errors fall.
//!
//! Pure functions of [`CostPoint`]s, coarse to fine.

#[cfg(test)]
mod tests;

use crate::solvers::Status;
use crate::verbs::cost::{CostCurve, CostPoint, CostRank, CostReached, CostTarget};
use std::cmp::Ordering;

/// Indices of the points with an error that no other point has both at most the error and at most the
/// work of, one of them less. Of equal ones all are kept. Work is counted, so the answer is the same in
/// every run.
pub fn pareto(points: &[CostPoint]) -> Vec<usize> {
    let known = |at: &usize| Some((points[*at].error_m?, points[*at].work()));
    let beaten = |(error, work): (f64, u64)| {
        let mut others = points.iter().filter_map(|p| Some((p.error_m?, p.work())));
        others.any(|other| other.0 <= error && other.1 <= work && other != (error, work))
    };
    let kept = |at: &usize| known(at).is_some_and(|own| !beaten(own));
    (0..points.len()).filter(kept).collect()
}

/// Points a slope is fitted through at least.
const FEWEST: usize = 4;
/// Neighbouring slopes of one straight line differ by no more than this: errors of the next order up add
/// about their ratio to the slope, and within this a line through the points is off by half of it at most.
const STRAIGHT: f64 = 0.15;

/// Points at the fine end that rounding may have spoilt without reaching the floor.
const SPOILT: usize = 2;

/// Orders are whole numbers from 1 on: what falls slower than this has not begun to.
const LEAST: f64 = 0.75;

/// A fitted slope.
#[derive(Debug, Clone, PartialEq)]
pub struct Slope {
    /// d ln(error) / d ln(step).
    pub order: f64,
    /// Indices of the points it was fitted through, coarse to fine.
    pub points: Vec<usize>,
}

/// The slope of ln(error) over ln(step) through the finest points of `points` (coarse to fine) that lie
/// on a straight line: neither in the floor, nor so coarse that the slope still changes.
///
/// Reading orders to 0.05 and calling a method wrong is [`order`](crate::measure::order)'s, which makes
/// runs of its own; this one is read off the settings of a diagram. None with fewer than four such
/// points.
pub fn slope(points: &[CostPoint]) -> Option<Slope> {
    let usable: Vec<(usize, f64, f64)> = points
        .iter()
        .enumerate()
        .filter(|(_, point)| !point.at_floor)
        .filter_map(|(at, point)| {
            let error = point.error_m.filter(|error| *error > 0.0)?;
            Some((at, point.timestep.ln(), error.ln()))
        })
        .collect();
    // From the finest on, as long as neighbouring slopes agree; where the finest do not, one is left out
    // at a time: rounding may already show in it.
    let mut best: Option<Slope> = None;
    for end in (FEWEST..=usable.len()).rev().take(SPOILT + 1) {
        let line = straight(&usable[..end]);
        if line.len() >= FEWEST && best.as_ref().is_none_or(|b| line.len() > b.points.len()) {
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
        .take_while(|s| **s >= LEAST && (*s - last).abs() <= STRAIGHT);
    &points[points.len() - 1 - agree.count()..]
}

/// The least-squares line through these points.
fn fitted(points: &[(usize, f64, f64)]) -> Option<Slope> {
    let n = points.len() as f64;
    let mean = |value: fn(&(usize, f64, f64)) -> f64| points.iter().map(value).sum::<f64>() / n;
    let (x, y) = (mean(|p| p.1), mean(|p| p.2));
    let (mut over, mut under) = (0.0, 0.0);
    for point in points {
        over += (point.1 - x) * (point.2 - y);
        under += (point.1 - x) * (point.1 - x);
    }
    let order = over / under;
    order.is_finite().then(|| Slope {
        order,
        points: points.iter().map(|p| p.0).collect(),
    })
}

/// Why a curve reaches a target at no setting.
#[derive(Debug, Clone, PartialEq)]
pub enum Misses {
    /// There is nothing finer than what was tried, and that has this error, m.
    Nearest(f64),
    /// Some setting is near enough, and a finer one is not: a lucky zero crossing, or rounding. The
    /// error of the finest that is not, m.
    Unsettled(f64),
    /// The finest setting has no error.
    Ended,
    /// No setting was tried.
    Nothing,
}

/// The first of `points` (coarse to fine) from which on every finer one, itself included, has at most
/// the error `target`, m.
///
/// Not the coarsest that does: an error that changes its sign passes through 0 on its way, and a
/// setting there would be credited with an accuracy that its neighbours on both sides have not.
///
/// # Errors
/// [`Misses`] where the finest does not reach it.
pub fn reach(points: &[CostPoint], target: f64) -> Result<usize, Misses> {
    let near = |point: &CostPoint| {
        point.status == Status::Completed && point.error_m.is_some_and(|error| error <= target)
    };
    let fine = points.iter().rev().take_while(|p| near(p)).count();
    if fine > 0 {
        return Ok(points.len() - fine);
    }
    let Some(finest) = points.last() else {
        return Err(Misses::Nothing);
    };
    let Some(error) = finest.error_m else {
        return Err(Misses::Ended);
    };
    let errors = points.iter().filter_map(|point| point.error_m);
    let nearest = errors.fold(error, f64::min);
    Err(if nearest <= target {
        Misses::Unsettled(error)
    } else {
        Misses::Nearest(nearest)
    })
}

/// Extrapolating farther than this is guessing; so is a line that hardly falls.
const MOST_STEPS: f64 = 1e4;
const SLOWEST: f64 = 0.5;

/// The answer for one target, m, over all curves; only the reason where there is one why errors cannot be
/// held against the target at all.
pub fn target(curves: &[CostCurve], error: f64, unjudged: Option<String>) -> CostTarget {
    let mut answer = CostTarget {
        error_m: error,
        cheapest: None,
        fewest_evaluations: None,
        ranking: Vec::new(),
        reference: Vec::new(),
        reason: unjudged,
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
    // Stable: equal and untimed ones stay in the order of the curves.
    answer.ranking.sort_by(cheaper);
    let reached = answer.ranking.iter().filter_map(|r| r.reached.as_ref());
    answer.cheapest = reached.clone().next().cloned();
    let counted = reached.filter(|r| r.force_evaluations.is_some());
    answer.fewest_evaluations = counted.min_by_key(|r| r.force_evaluations).cloned();
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
            });
        }
        Err(misses) => {
            if let Misses::Nearest(nearest) = misses {
                rank.more_steps = more_steps(curve, nearest, error);
            }
            rank.reason = Some(why(curve, &misses));
        }
    }
    rank
}

fn why(curve: &CostCurve, misses: &Misses) -> String {
    match misses {
        Misses::Nearest(error) => format!("nearest {error:.1e} m at the settings tried"),
        Misses::Unsettled(error) => {
            format!("near enough at a coarser setting only: {error:.1e} m at the finest")
        }
        Misses::Ended | Misses::Nothing => {
            let reason = curve.points.last().and_then(|point| point.reason.clone());
            reason.unwrap_or_else(|| "no setting gave an error".to_owned())
        }
    }
}

/// What the curve's slope promises beyond its finest setting, where that is still on its line.
fn more_steps(curve: &CostCurve, nearest: f64, target: f64) -> Option<f64> {
    let order = curve.observed_order.filter(|order| *order > SLOWEST)?;
    let on_line = curve.slope_points.last() == Some(&curve.points.len().checked_sub(1)?);
    let times = (nearest / target).powf(1.0 / order);
    (on_line && times < MOST_STEPS).then_some(times)
}

/// By median time; untimed after timed ones, by evaluations; those that do not reach it last.
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
