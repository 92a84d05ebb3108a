//! When a trend is more than noise: two tests that a random walk does not fool.
//!
//! [`one_way`] asks whether the path climbs without falling back, whatever the shape of the climb;
//! [`slow`] whether the trend stands out of the slow part of the fluctuation, whatever rides on top.
//! Their critical values are simulated on driftless random walks, the worst of the null families, so
//! that the two together alarm on one in a thousand. Two things pass for a trend by nature: the half
//! period of a wave slower than the run, and, in up to 2 % of short series, a walk that noise of short
//! memory hides but for its slowest part.

use std::f64::consts::{LN_2, TAU};

/// The finding of a test.
pub struct Evidence {
    /// Along the trend, in units of y.
    pub change: f64,
    /// The part of the change that noise explains: a fraction from [`one_way`], in units of y from
    /// [`slow`].
    pub doubt: f64,
}

/// Fewer moves than this can all point the same way by chance: 2 in 2^12.
pub const ONE_WAY_SAMPLES: usize = 13;

/// The largest rise against the largest fall, where one dwarfs the other. A Brownian path rises by an
/// exponential multiple of `a` before it falls by `a` (Taylor 1975), and a time change turns every
/// continuous martingale into one (Dambis, Dubins & Schwarz 1965): the ratio needs neither a scale nor an
/// even pace, so an exponential, a decay over by the tenth sample and a straight line are alike to it.
/// Blind to a trend under an oscillation of its own size; that is for [`slow`].
pub fn one_way(y: &[f64]) -> Option<Evidence> {
    let (mut lowest, mut highest, mut rise, mut fall) = (y[0], y[0], 0.0_f64, 0.0_f64);
    for &y in y {
        (lowest, highest) = (lowest.min(y), highest.max(y));
        (rise, fall) = (rise.max(y - lowest), fall.max(highest - y));
    }
    let n = y.len() as f64;
    // 10.5 for a Brownian path; a short walk never reaches its own extremes, so it falls back by less.
    let doubt = (10.5 + 9e3 / (n * n)) * rise.min(fall) / rise.max(fall);
    (y.len() >= ONE_WAY_SAMPLES && doubt < 1.0).then_some(Evidence {
        change: rise - fall,
        doubt,
    })
}

/// Below this the slow frequencies are too few to tell noise from trend: nothing is significant.
const SLOW_SAMPLES: usize = 32;
/// Below this a random walk can pass for noise without memory.
const LEVEL_SAMPLES: usize = 125;
const WALK_CRITICAL: f64 = 4.5;
const LEVEL_CRITICAL: f64 = 7.5;

/// The trend against the slow end of its own fluctuation, in units of y over s = 0..1. `residual` is what
/// the least-squares line with change `line` leaves.
///
/// Low frequencies carry the evidence (Müller & Watson 2008). The noise at frequency zero is continued
/// from the first periodogram ordinates as a random walk's, 1/k^2, or, where they are no higher than the
/// rest, as flat: one answer for noise with and without memory, as in Harvey, Leybourne & Taylor 2007.
/// The Hann taper keeps an oscillation of five periods or more out of the trend (2/p^2 of its amplitude,
/// against 1.2/p for least squares), and the median over frequencies keeps it out of the noise.
pub fn slow(s: &[f64], residual: &[f64], line: f64) -> Evidence {
    let n = residual.len();
    let steps = (n - 1) as f64;
    if n < SLOW_SAMPLES {
        let squares: f64 = residual
            .windows(2)
            .map(|w| (w[1] - w[0] + line / steps).powi(2))
            .sum();
        return Evidence {
            change: line,
            doubt: WALK_CRITICAL * (1.5 * squares).sqrt(),
        };
    }
    // The mean of the increments under a Hann window is the series against one sine: no differencing.
    let sines: Vec<f64> = (0..n).map(|i| (TAU * i as f64 / steps).sin()).collect();
    let against = |v: &[f64]| sines.iter().zip(v).map(|(sine, v)| sine * v).sum::<f64>();
    let beyond = against(residual) / against(s);
    let detrended: Vec<f64> = residual
        .iter()
        .zip(s)
        .map(|(u, s)| u - beyond * (s - 0.5))
        .collect();

    // Ordinates k = 1, 2, ..., scaled so that a random walk's change has the variance k^2 power[k].
    let power = periodogram(&detrended, 25.min(n / 3 + 1));
    let squared = |k: usize| (k * k) as f64 * power[k];
    let walk = median((2..power.len()).map(squared));
    // A wave of one to four periods is no trend, and its power sits in the first two ordinates.
    let wave = (squared(1) + squared(2)) / 2.0;
    let as_walk = WALK_CRITICAL * walk.max(wave / 4.0).sqrt();

    let change = line + beyond;
    if n < LEVEL_SAMPLES {
        return Evidence {
            change,
            doubt: as_walk,
        };
    }
    // A level of short memory and, where the first ordinates exceed the rest, a walk beneath it: over
    // k = 2..=7 a walk's mean power is k^2 power / 11.7. A level's change has a third of its power.
    let first = (2..8).map(|k| power[k]).sum::<f64>() / 6.0;
    let rest = median(power[8..].iter().copied());
    let as_level = LEVEL_CRITICAL * (first.max(rest) / 3.0 + 11.7 * (first - rest).max(0.0)).sqrt();
    Evidence {
        change,
        doubt: as_walk.min(as_level),
    }
}

/// Hann-tapered power at k = 0..=last cycles per series, (4 pi / n)^2 |sum|^2; index 0 is unused.
fn periodogram(values: &[f64], last: usize) -> Vec<f64> {
    let steps = values.len() - 1;
    let circle: Vec<(f64, f64)> = (0..steps)
        .map(|i| (TAU * i as f64 / steps as f64).sin_cos())
        .collect();
    let taper = |i: usize| 0.5 - 0.5 * circle[i % steps].1;
    let weight: f64 = (0..=steps).map(taper).sum();
    let mean = values
        .iter()
        .enumerate()
        .map(|(i, v)| taper(i) * v)
        .sum::<f64>()
        / weight;
    let tapered: Vec<f64> = values
        .iter()
        .enumerate()
        .map(|(i, v)| taper(i) * (v - mean))
        .collect();
    let scale = 2.0 * TAU / values.len() as f64;
    let at = |k: usize| {
        let (mut sine, mut cosine, mut angle) = (0.0, 0.0, 0);
        for v in &tapered {
            let (sin, cos) = circle[angle];
            (sine, cosine) = (sine + v * sin, cosine + v * cos);
            angle += k;
            if angle >= steps {
                angle -= steps;
            }
        }
        (scale * sine).powi(2) + (scale * cosine).powi(2)
    };
    (0..=last).map(at).collect()
}

/// The mean of exponential variates, read off their median so that a few spectral lines do not move it.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let half = values.len() / 2;
    let middle = if values.len() % 2 == 1 {
        values[half]
    } else {
        (values[half - 1] + values[half]) / 2.0
    };
    middle / LN_2
}
