//! How long work will take, said before it starts.

use crate::verbs::host::Estimate;
use std::io::Write;

/// Work expected to take longer than this is announced, seconds.
const ANNOUNCED: f64 = 10.0;

/// Wall seconds all cases will take together: no less than the longest, no less than a fair share.
pub fn expected(estimates: &[Estimate]) -> f64 {
    let sum: f64 = estimates.iter().map(|e| e.seconds).sum();
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let longest = estimates.iter().fold(0.0, |m: f64, e| m.max(e.seconds));
    longest.max(sum / threads as f64)
}

/// Long work by engine, and the flags that shorten it.
pub fn announce(estimates: &[Estimate], expected: f64, shorter: &str) {
    if expected <= ANNOUNCED {
        return;
    }
    let mut err = anstream::stderr().lock();
    let _ = writeln!(err, "about {expected:.0} s expected:");
    for estimate in estimates {
        let Estimate { label, seconds } = estimate;
        let _ = writeln!(
            err,
            "  {:<30} {seconds:>8.1} s  ({} steps)",
            label.engine, label.steps
        );
    }
    let _ = writeln!(err, "shorter: {shorter}");
}
