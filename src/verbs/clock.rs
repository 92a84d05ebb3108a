//! Wall times of equal runs.

use serde::{Deserialize, Serialize};

#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct WallTime {
    pub min: f64,
    pub median: f64,
    /// Median absolute deviation; null for a single run.
    pub mad: Option<f64>,
}

/// Wall times of equal runs; at least one.
pub fn spread(mut times: Vec<f64>) -> WallTime {
    let median = median(&mut times);
    let mut off: Vec<f64> = times.iter().map(|t| (t - median).abs()).collect();
    WallTime {
        min: times[0],
        median,
        mad: (off.len() > 1).then(|| self::median(&mut off)),
    }
}

/// Sorts; not empty.
fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    let half = values.len() / 2;
    if values.len() % 2 == 1 {
        values[half]
    } else {
        0.5 * (values[half - 1] + values[half])
    }
}
