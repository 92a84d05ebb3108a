//! How fast errors fall as steps do.

use crate::outcome::CostPoint;

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

/// Least squares.
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
