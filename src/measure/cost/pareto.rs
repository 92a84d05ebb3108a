//! Settings that no other beats in error and work at once.

use crate::outcome::CostPoint;

/// Indices of the points with an error that no other point has both at most the error and at most the
/// work of, one of them less. Of equal ones all are kept. Work is counted, so the answer is the same in
/// every run.
pub fn pareto(points: &[CostPoint]) -> Vec<usize> {
    let kept: Vec<(usize, f64, u64)> = points
        .iter()
        .enumerate()
        .filter_map(|(at, point)| Some((at, point.error_m?, point.work())))
        .collect();
    let beaten = |&(_, error, work): &(usize, f64, u64)| {
        kept.iter().any(|&(_, other, less)| {
            other <= error && less <= work && (other < error || less < work)
        })
    };
    let front = kept.iter().filter(|point| !beaten(point));
    front.map(|(at, ..)| *at).collect()
}
