//! Who reaches an error cheapest.

use super::reach::{Misses, reach};
use crate::outcome::{CostCurve, CostRank, CostReached, CostTarget};
use std::cmp::Ordering;

/// Whether errors can be held against a target at all.
#[derive(Debug, Clone, PartialEq)]
pub enum Judged {
    /// Against a truth good enough.
    Yes,
    /// Why nobody can be said to reach it.
    No(String),
}

/// Extrapolating farther than this is guessing; so is a line that hardly falls.
const MOST_STEPS: f64 = 1e4;
const SLOWEST: f64 = 0.5;

/// The answer for one target, m, over all curves.
pub fn target(curves: &[CostCurve], error: f64, judged: &Judged) -> CostTarget {
    let mut answer = CostTarget {
        error_m: error,
        cheapest: None,
        fewest_evaluations: None,
        ranking: Vec::new(),
        reference: Vec::new(),
        reason: None,
    };
    if let Judged::No(reason) = judged {
        answer.reason = Some(reason.clone());
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
    let reached = || {
        answer
            .ranking
            .iter()
            .filter_map(|rank| rank.reached.as_ref())
    };
    let cheapest = reached().next().cloned();
    let counted = reached().filter_map(|r| Some((r.force_evaluations?, r)));
    let fewest = counted.min_by_key(|(evaluations, _)| *evaluations);
    answer.fewest_evaluations = fewest.map(|(_, reached)| reached.clone());
    let least = cheapest.as_ref().and_then(|c| c.wall_median_s);
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
    answer.cheapest = cheapest;
    answer
}

fn rank(curve: &CostCurve, error: f64) -> CostRank {
    let found = reach(&curve.points, error);
    let reached = found.as_ref().ok().and_then(|at| curve.points.get(*at));
    CostRank {
        engine: curve.engine.clone(),
        reached: reached.map(|point| CostReached {
            engine: curve.engine.clone(),
            timestep: point.timestep,
            tolerance: point.tolerance,
            error_m: point.error_m.unwrap_or(error),
            wall_median_s: point.wall_s.as_ref().map(|wall| wall.median),
            force_evaluations: point.force_evaluations,
        }),
        wall_ratio: None,
        more_steps: found
            .as_ref()
            .err()
            .and_then(|m| more_steps(curve, m, error)),
        extrapolated_wall_ratio: None,
        reason: found.err().map(|misses| why(curve, &misses)),
    }
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
fn more_steps(curve: &CostCurve, misses: &Misses, target: f64) -> Option<f64> {
    let Misses::Nearest(nearest) = misses else {
        return None;
    };
    let order = curve.observed_order.filter(|order| *order > SLOWEST)?;
    let on_line = curve.slope_points.last() == Some(&curve.points.len().checked_sub(1)?);
    let times = (nearest / target).powf(1.0 / order);
    (on_line && times < MOST_STEPS).then_some(times)
}

/// By median time; untimed after timed ones, by evaluations; those that do not reach it last.
fn cheaper(a: &CostRank, b: &CostRank) -> Ordering {
    let key = |rank: &CostRank| {
        let reached = rank.reached.as_ref();
        let time = reached
            .and_then(|r| r.wall_median_s)
            .unwrap_or(f64::INFINITY);
        let count = reached
            .and_then(|r| r.force_evaluations)
            .unwrap_or(u64::MAX);
        (reached.is_none(), time, count)
    };
    let (a, b) = (key(a), key(b));
    let times = || a.1.total_cmp(&b.1);
    a.0.cmp(&b.0).then_with(times).then_with(|| a.2.cmp(&b.2))
}
