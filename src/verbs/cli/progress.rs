//! The progress bar: on stderr, only on a terminal, only on long runs.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;

/// Shorter work shows nothing, seconds.
const LONG: f64 = 1.0;

/// Counts steps over all cases of a scene.
pub struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// `steps` in all, `expected` seconds of work.
    pub fn new(steps: u64, expected: f64, quiet: bool) -> Self {
        let shown = !quiet && expected > LONG && std::io::stderr().is_terminal();
        let target = if shown {
            ProgressDrawTarget::stderr()
        } else {
            ProgressDrawTarget::hidden()
        };
        let bar = ProgressBar::with_draw_target(Some(steps), target);
        if let Ok(style) = ProgressStyle::with_template("{bar:40} {percent:>3} %  {eta} left") {
            bar.set_style(style);
        }
        Self { bar }
    }

    pub fn advance(&self, steps: u64) {
        self.bar.inc(steps);
    }

    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
