//! Statistics of wall times.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Wall times of equal runs, s.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
pub struct WallTime {
    /// The shortest, s.
    pub min: f64,
    /// The median, s.
    pub median: f64,
    /// Median absolute deviation; null for a single run.
    pub mad: Option<f64>,
}

/// The spread of the wall times of equal runs, s; `times` holds at least one.
pub fn spread(mut times: Vec<f64>) -> WallTime {
    let median = median(&mut times);
    let mut deviations: Vec<f64> = times.iter().map(|t| (t - median).abs()).collect();
    WallTime {
        min: times[0],
        median,
        mad: (deviations.len() > 1).then(|| self::median(&mut deviations)),
    }
}

/// The median; it sorts the values, which are not empty.
fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    let half = values.len() / 2;
    if values.len() % 2 == 1 {
        values[half]
    } else {
        0.5 * (values[half - 1] + values[half])
    }
}
