//! The session of a command line: a progress bar, files, a cache of truths, and the announcement of long work.

use super::cache::Cache;
use super::interrupt;
use super::note::note;
use super::save::Files;
use crate::physics::State;
use crate::trajectory::{Observer, SaveError};
use crate::truth::Store;
use crate::verbs::session::{Label, Saver, Session, TimeEstimate};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use std::fmt;
use std::io::IsTerminal;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// The expected time beyond which work is announced, s.
const MIN_ANNOUNCED: f64 = 10.0;
/// Work that has not ended by then shows its progress, whatever was expected.
const PATIENCE: Duration = Duration::from_millis(1500);
/// The time from one picture of the progress to the next.
const TICK: Duration = Duration::from_millis(250);

/// A progress bar on stderr, files beside the report, truths in the user's cache.
pub struct Terminal {
    bar: ProgressBar,
    quiet: bool,
    files: Option<Files>,
    failure: Failure,
    cache: Cache,
    /// Ends the thread that waits to show the bar, when it is dropped.
    _waiting: Option<Sender<()>>,
}

/// The first failure to save a run. It is not the run's failure: the report is made all the same.
type Failure = Arc<Mutex<Option<SaveError>>>;

impl Terminal {
    /// A session for work that begins now. On a terminal it shows that it works before anyone wonders, and leaves
    /// nothing of that when it is dropped.
    pub fn new(quiet: bool) -> Self {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} so far") {
            bar.set_style(style);
        }
        let shown = !quiet && std::io::stderr().is_terminal();
        let waiting = shown.then(|| {
            let (waiting, ended) = channel();
            let bar = bar.clone();
            std::thread::spawn(move || {
                if ended.recv_timeout(PATIENCE) == Err(RecvTimeoutError::Timeout) {
                    bar.set_draw_target(ProgressDrawTarget::stderr());
                    bar.enable_steady_tick(TICK);
                }
            });
            waiting
        });
        interrupt::shows(shown.then(|| bar.clone()));
        Self {
            bar,
            quiet,
            files: None,
            failure: Failure::default(),
            cache: Cache::new(),
            _waiting: waiting,
        }
    }

    /// The same session, which saves every run's steps to files.
    #[must_use]
    pub fn saving(mut self, files: Option<Files>) -> Self {
        self.files = files;
        self
    }

    /// States that `units` of work lie ahead, and what they are expected to take, as a whole, s, and part by part.
    /// Long work is announced, with the flags that make it shorter.
    pub fn expect(&self, units: u64, expected: f64, estimates: &[TimeEstimate], shorter: &str) {
        let left = move |state: &ProgressState, to: &mut dyn fmt::Write| {
            let part = state.pos() as f64 / state.len().unwrap_or(0).max(1) as f64;
            let _ = to.write_str(&left(part, state.elapsed().as_secs_f64(), expected));
        };
        if let Ok(style) =
            ProgressStyle::with_template("{bar:40} {percent:>3} %  {left} ({elapsed} so far)")
        {
            self.bar.set_style(style.with_key("left", left));
        }
        self.bar.set_length(units);
        self.bar.reset_elapsed();
        if !self.quiet && expected > MIN_ANNOUNCED {
            let announced = announcement(estimates, expected, shorter);
            self.bar.suspend(|| note(&announced));
        }
    }

    /// The first failure to save a run.
    ///
    /// # Errors
    /// Returns it once.
    pub fn saved(&self) -> Result<(), SaveError> {
        let mut failure = self.failure.lock().unwrap_or_else(PoisonError::into_inner);
        failure.take().map_or(Ok(()), Err)
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        interrupt::shows(None);
        self.bar.finish_and_clear();
    }
}

/// What is left of work of which a part is done: first by what was expected, from a quarter on by what it took.
fn left(part: f64, elapsed: f64, expected: f64) -> String {
    let trust = (4.0 * part).min(1.0);
    let by_time = if part > 0.0 { elapsed / part } else { 0.0 };
    let whole = trust * by_time + (1.0 - trust) * expected.max(elapsed);
    match whole - elapsed {
        seconds if seconds < 1.0 => "finishing".to_owned(),
        seconds => format!("about {} left", duration(seconds)),
    }
}

/// A duration as people say it: `40 s`, `3 min`, `1.5 h`.
fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 99.5 => format!("{s:.0} s"),
        s if s < 5_970.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

impl Session for Terminal {
    fn saver(&self, case: &Label) -> Result<Option<Box<dyn Saver>>, SaveError> {
        let saver = self.files.as_ref().map(|files| files.saver(case));
        Ok(saver.map(|saver| -> Box<dyn Saver> {
            let failure = Arc::clone(&self.failure);
            Box::new(Remembering { saver, failure })
        }))
    }

    fn progress(&self, steps: u64) {
        self.bar.inc(steps);
    }

    fn store(&self) -> &dyn Store {
        &self.cache
    }
}

/// A saver whose failure, to start or to go on, is kept for the end.
struct Remembering {
    saver: Result<Box<dyn Saver>, SaveError>,
    failure: Failure,
}

impl Observer for Remembering {
    fn next(&self, from: u64) -> Option<u64> {
        self.saver.as_ref().ok()?.next(from)
    }

    fn observe(&mut self, step: u64, state: &State) {
        if let Ok(saver) = &mut self.saver {
            saver.observe(step, state);
        }
    }
}

impl Saver for Remembering {
    fn finish(self: Box<Self>) -> Result<(), SaveError> {
        if let Err(error) = self.saver.and_then(Saver::finish) {
            let mut failure = self.failure.lock().unwrap_or_else(PoisonError::into_inner);
            failure.get_or_insert(error);
        }
        Ok(())
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

/// How long work will take, part by part, and which flags make it shorter.
fn announcement(estimates: &[TimeEstimate], expected: f64, shorter: &str) -> String {
    let mut text = format!("about {} expected:\n", duration(expected));
    for TimeEstimate { label, seconds } in estimates {
        let steps = match label.steps {
            0 => String::new(),
            steps => format!("  ({steps} steps)"),
        };
        text += &format!("  {:<30} {seconds:>8.1} s{steps}\n", label.engine);
    }
    text + "shorter: " + shorter
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_begins_with_what_was_expected_and_ends_with_what_it_took() {
        // 100 s in truth; ten times that, or a tenth, was expected.
        for expected in [1000.0, 10.0] {
            assert_eq!(left(0.5, 50.0, expected), "about 50 s left");
        }
        assert_eq!(left(0.0, 0.0, 30.0), "about 30 s left");
        assert_eq!(left(0.0, 0.0, 7200.0), "about 2.0 h left");
        assert_eq!(left(1.0, 100.0, 10.0), "finishing");
        // Nothing is known of work of no units.
        assert_eq!(left(0.0, 5.0, 0.0), "finishing");
    }
}
