//! The session of a command line: a progress bar, files, a cache of truths, and the announcement of long work.

use super::cache::Cache;
use super::save::Files;
use crate::trajectory::SaveError;
use crate::truth::Store;
use crate::verbs::session::{Label, Saver, Session, TimeEstimate};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressFinish, ProgressStyle};
use std::io::{IsTerminal, Write};

/// The expected time beyond which work is announced, s.
const MIN_ANNOUNCED: f64 = 10.0;
/// The expected time beyond which work shows its progress, s.
const MIN_SHOWN: f64 = 1.0;

/// A progress bar on stderr, files beside the report, truths in the user's cache.
pub struct Terminal {
    bar: ProgressBar,
    files: Option<Files>,
    cache: Cache,
}

impl Terminal {
    /// A session for `units` of work that are `expected` to take so many seconds in all. The bar is shown only on a
    /// terminal and for long work, and is cleared on drop.
    pub fn new(units: u64, expected: f64, quiet: bool) -> Self {
        let shown = !quiet && expected > MIN_SHOWN && std::io::stderr().is_terminal();
        let target = if shown {
            ProgressDrawTarget::stderr()
        } else {
            ProgressDrawTarget::hidden()
        };
        let bar = ProgressBar::with_draw_target(Some(units), target);
        let bar = bar.with_finish(ProgressFinish::AndClear);
        if let Ok(style) = ProgressStyle::with_template("{bar:40} {percent:>3} %  {eta} left") {
            bar.set_style(style);
        }
        Self {
            bar,
            files: None,
            cache: Cache::new(),
        }
    }

    /// The same session, which saves every run's steps to files.
    #[must_use]
    pub fn saving(self, files: Option<Files>) -> Self {
        Self { files, ..self }
    }
}

impl Session for Terminal {
    fn saver(&self, case: &Label) -> Result<Option<Box<dyn Saver>>, SaveError> {
        let files = self.files.as_ref();
        files.map(|files| files.saver(case)).transpose()
    }

    fn progress(&self, steps: u64) {
        self.bar.inc(steps);
    }

    fn store(&self) -> &dyn Store {
        &self.cache
    }
}

/// The wall time all cases will take together, s: at least that of the longest, and at least the sum
/// divided by the number of threads.
pub fn expected(estimates: &[TimeEstimate]) -> f64 {
    let sum: f64 = estimates.iter().map(|e| e.seconds).sum();
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let longest = estimates.iter().fold(0.0, |m: f64, e| m.max(e.seconds));
    longest.max(sum / threads as f64)
}

/// Prints before long work how long it will take, engine by engine, and which flags make it shorter.
pub fn announce(estimates: &[TimeEstimate], expected: f64, shorter: &str, quiet: bool) {
    if quiet || expected <= MIN_ANNOUNCED {
        return;
    }
    let mut err = anstream::stderr().lock();
    let _ = writeln!(err, "about {expected:.0} s expected:");
    for TimeEstimate { label, seconds } in estimates {
        let (engine, steps) = (&label.engine, label.steps);
        let steps = match steps {
            0 => String::new(),
            steps => format!("  ({steps} steps)"),
        };
        let _ = writeln!(err, "  {engine:<30} {seconds:>8.1} s{steps}");
    }
    let _ = writeln!(err, "shorter: {shorter}");
}
