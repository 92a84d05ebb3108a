//! What a run needs of the outside: files to save to, somebody to show progress.

use super::progress::Progress;
use super::save::Files;
use springcheck::crosscheck::{Host, Label, Saver};
use springcheck::trajectory::SaveError;

/// Progress and files as the library sees them.
pub fn host<'a>(progress: &'a Progress, files: Option<&'a Files>) -> impl Host + 'a {
    Terminal { progress, files }
}

struct Terminal<'a> {
    progress: &'a Progress,
    files: Option<&'a Files>,
}

impl Host for Terminal<'_> {
    fn saver(&self, case: &Label) -> Result<Option<Box<dyn Saver>>, SaveError> {
        self.files.map(|files| files.saver(case)).transpose()
    }

    fn progress(&self, steps: u64) {
        self.progress.advance(steps);
    }
}
