//! Gauss's method of three stages and order 6 on the public system: slow, simple, and exact enough.

use springcheck::physics::{State, System};

/// Carries a state over `time` in `steps` steps, stages iterated to the last bit or nearly.
pub fn advance(system: &dyn System, state: &mut State, time: f64, steps: usize) {
    let root = 15f64.sqrt();
    let a = [
        [
            5.0 / 36.0,
            2.0 / 9.0 - root / 15.0,
            5.0 / 36.0 - root / 30.0,
        ],
        [
            5.0 / 36.0 + root / 24.0,
            2.0 / 9.0,
            5.0 / 36.0 - root / 24.0,
        ],
        [
            5.0 / 36.0 + root / 30.0,
            2.0 / 9.0 + root / 15.0,
            5.0 / 36.0,
        ],
    ];
    let b = [5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0];
    let (n, h) = (state.x.len(), time / steps as f64);
    // Slopes of position and velocity in each stage.
    let mut slopes = vec![vec![0.0; 2 * n]; 3];
    let at = |y: &[f64], slopes: &[Vec<f64>], row: &[f64; 3]| -> Vec<f64> {
        let sum = |c: usize| (0..3).map(|j| row[j] * slopes[j][c]).sum::<f64>();
        (0..2 * n).map(|c| y[c] + h * sum(c)).collect()
    };
    for _ in 0..steps {
        let y: Vec<f64> = state.x.iter().chain(&state.v).copied().collect();
        for _ in 0..100 {
            let mut change = 0.0_f64;
            for stage in 0..3 {
                let y = at(&y, &slopes, &a[stage]);
                let mut slope = vec![0.0; 2 * n];
                slope[..n].copy_from_slice(&y[n..]);
                system.acceleration(state.t, &y[..n], &y[n..], &mut slope[n..]);
                let size = slope.iter().fold(0.0, |m: f64, s| m.max(s.abs()));
                for (old, new) in slopes[stage].iter().zip(&slope) {
                    change = change.max((old - new).abs() / size.max(f64::MIN_POSITIVE));
                }
                slopes[stage] = slope;
            }
            if change <= 4.0 * f64::EPSILON {
                break;
            }
        }
        let y = at(&y, &slopes, &b);
        state.x.copy_from_slice(&y[..n]);
        state.v.copy_from_slice(&y[n..]);
        state.t += h;
    }
}
