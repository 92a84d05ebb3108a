//! How errors grow, and what the classifier makes of it: rounding as a random walk, |error| ~ t^1/2
//! (Brouwer 1937), a method's own error in proportion to t.

use super::*;

/// Samples of each made-up run.
const SAMPLES: usize = 1_000;

/// The energy errors of 1,000 seeded runs.
fn runs(mut one: impl FnMut(&mut Random) -> Vec<f64>) -> Vec<Vec<f64>> {
    let mut random = Random(1_937);
    (0..1_000).map(|_| one(&mut random)).collect()
}

/// Slope of ln rms(t) over ln t, the rms over the runs: by least squares from the tenth sample on.
fn exponent(runs: &[Vec<f64>]) -> f64 {
    let rms = |i: usize| {
        let squares: f64 = runs.iter().map(|run| (run[i] - run[0]).powi(2)).sum();
        (squares / runs.len() as f64).sqrt()
    };
    let times: Vec<f64> = (10..SAMPLES).map(|i| i as f64).collect();
    let sizes: Vec<f64> = (10..SAMPLES).map(|i| rms(i).ln()).collect();
    let logs: Vec<f64> = times.iter().map(|t| t.ln()).collect();
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let (x, y) = (mean(&logs), mean(&sizes));
    let products: f64 = logs
        .iter()
        .zip(&sizes)
        .map(|(a, b)| (a - x) * (b - y))
        .sum();
    products / logs.iter().map(|a| (a - x).powi(2)).sum::<f64>()
}

/// Rounding alone.
fn brouwer(random: &mut Random) -> Vec<f64> {
    random.walk(SAMPLES)
}

/// A drift of one to two roundings a step, of either sign, over rounding.
fn linear(random: &mut Random) -> Vec<f64> {
    let drift = random.normal().signum() * (1.0 + random.unit());
    let rounding = random.walk(SAMPLES);
    rounding
        .iter()
        .enumerate()
        .map(|(i, x)| x + drift * i as f64)
        .collect()
}

#[test]
fn growth_of_exponent_one_half_is_no_trend_and_of_exponent_one_is() {
    let (rounding, systematic) = (runs(brouwer), runs(linear));
    // An rms over 1,000 runs is known to 2 %, over two decades of time: 0.02 / ln 100 = 0.005.
    let exponents = [exponent(&rounding), exponent(&systematic)];
    println!("exponents {exponents:?}");
    assert!((exponents[0] - 0.5).abs() < 0.015, "{exponents:?}");
    assert!((exponents[1] - 1.0).abs() < 0.003, "{exponents:?}");

    let alarms = rounding.iter().filter(|run| trending(run)).count();
    let missed = systematic.iter().filter(|run| {
        let up = run[SAMPLES - 1] > run[0];
        fit(run).class != if up { Growing } else { Dissipating }
    });
    let missed = missed.count();
    println!("{alarms} alarms, {missed} missed");
    // Ten each would do; the level of the test is one in a thousand.
    assert!(alarms <= 4 && missed <= 4, "{alarms} {missed}");
}

/// At least 99 % of drifts of one sigma a step, in every family: the standard deviation of what a sample
/// adds to the noise, or the amplitude of the wave, is 1.
#[test]
fn a_drift_of_one_sigma_a_step_is_found_in_every_family() {
    for (name, family) in TRENDLESS {
        for drift in [1.0, -1.0] {
            let found = alarms(family, drift, trending);
            assert!(found >= 990, "{name}: {found} in 1,000");
        }
    }
}
