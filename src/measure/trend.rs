//! The trend of the energy balance: the fitted line, its interval, and the class read from both.
//!
//! With D the fitted trend times the duration and f half the peak-to-peak of the residual, a series
//! is bounded when the trend is insignificant at 99.9 % or |D| < 0.1 f, growing or dissipating when
//! |D| > f, drifting in between. What "significant" takes is in `evidence`: it holds against noise
//! that remembers, up to a random walk, where the textbook interval of a slope does not. A path
//! that goes one way, in whatever shape, is its own trend: D is its net change and f half its
//! largest reversal, since a straight line through a decay over in 2 % of the run, or through e^23,
//! misses most of it.

mod evidence;

/// The fewest samples that can show a trend.
pub use evidence::ONE_WAY_SAMPLES as FEWEST;
#[cfg(test)]
mod tests;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum EnergyClass {
    Bounded,
    Drifting,
    Dissipating,
    Growing,
}

/// The straight-line trend of b(t) and the class of the whole series.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trend {
    /// Least-squares slope, units of b per unit of t. Not a growth rate: that is the slope of ln b.
    pub slope: f64,
    /// 99.9 % two-sided interval of the slope, low to high, `slope` inside. It excludes 0 exactly
    /// when the trend is significant; a significant trend may still be bounded (|D| < 0.1 f).
    pub interval: [f64; 2],
    /// Half the peak-to-peak of the residual about the least-squares line, units of b. Not that of
    /// b.
    pub fluctuation: f64,
    pub class: EnergyClass,
}

/// A trend below this fraction of the fluctuation is none.
const NEGLIGIBLE: f64 = 0.1;

/// Fits and classifies b(t): `t` strictly increasing, evenly spaced but for a shorter last gap; `b`
/// finite and as long as `t`. Fewer than two samples have no trend. A series whose peak-to-peak is
/// below `floor` (units of b) is bounded whatever its shape. A slope too steep for f64 saturates,
/// so that every answer is finite.
pub fn trend(t: &[f64], b: &[f64], floor: f64) -> Trend {
    let (low, high) = extremes(b);
    if t.len() < 2 || low == high {
        return Trend {
            slope: 0.0,
            interval: [0.0; 2],
            fluctuation: 0.0,
            class: EnergyClass::Bounded,
        };
    }
    let (time, value) = (Unit::of(t), Unit::of(b));
    let (line, residual) = least_squares(&time.values, &value.values);
    let (below, above) = extremes(&residual);
    let f = (above - below) / 2.0;

    let measurable = high - low >= floor;
    let along = |change: f64| measurable && change * line > 0.0;
    let path = evidence::one_way(&value.values).filter(|path| along(path.change));
    let slow = evidence::slow(&time.values, &residual, line);
    let ([least, most], class) = if let Some(path) = path {
        let doubt = line.abs() * path.doubt;
        ([line - doubt, line + doubt], directed(path.change))
    } else {
        let [least, most] = [slow.change - slow.doubt, slow.change + slow.doubt];
        if along(slow.change) && slow.change.abs() > slow.doubt {
            // An oscillation of few periods tilts the line; both estimates must call it a trend.
            let class = match line.abs().min(slow.change.abs()) {
                smaller if smaller < NEGLIGIBLE * f => EnergyClass::Bounded,
                _ if line.abs() > f => directed(line),
                _ => EnergyClass::Drifting,
            };
            ([least, most], class)
        } else {
            ([least.min(0.0), most.max(0.0)], EnergyClass::Bounded)
        }
    };

    // Held finite, lest 0 times infinity make NaN of no change.
    let per_time = finite(value.spread / time.spread * finite(value.scale / time.scale));
    Trend {
        slope: finite(line * per_time),
        interval: [least.min(line), most.max(line)].map(|change| finite(change * per_time)),
        fluctuation: finite(f * value.spread * value.scale),
        class,
    }
}

fn directed(change: f64) -> EnergyClass {
    if change > 0.0 {
        EnergyClass::Growing
    } else {
        EnergyClass::Dissipating
    }
}

/// Values mapped onto [0, 1], so that neither 1e300 nor 1e-300 is ever squared, and slopes become
/// D. The range they had is `spread` times `scale`, a product that may overflow.
struct Unit {
    values: Vec<f64>,
    spread: f64,
    scale: f64,
}

impl Unit {
    fn of(values: &[f64]) -> Unit {
        let (low, high) = extremes(values);
        let scale = low.abs().max(high.abs());
        let spread = high / scale - low / scale;
        let values = values
            .iter()
            .map(|v| (v / scale - low / scale) / spread)
            .collect();
        Unit {
            values,
            spread,
            scale,
        }
    }
}

/// The line's change over s = 0..1 and the residual about it, whose mean and trend are zero.
fn least_squares(s: &[f64], y: &[f64]) -> (f64, Vec<f64>) {
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let (s_mean, y_mean) = (mean(s), mean(y));
    let products = s.iter().zip(y).map(|(s, y)| (s - s_mean) * (y - y_mean));
    let squares = s.iter().map(|s| (s - s_mean).powi(2));
    let line = products.sum::<f64>() / squares.sum::<f64>();
    (
        line,
        s.iter()
            .zip(y)
            .map(|(s, y)| y - y_mean - line * (s - s_mean))
            .collect(),
    )
}

fn extremes(values: &[f64]) -> (f64, f64) {
    let grow = |(low, high): (f64, f64), v: &f64| (low.min(*v), high.max(*v));
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), grow)
}

fn finite(value: f64) -> f64 {
    value.clamp(-f64::MAX, f64::MAX)
}
