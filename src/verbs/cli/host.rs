//! What a run needs of the outside: files to save to, somebody to show progress, a place for truths.

use super::cache::Cache;
use super::progress::Progress;
use super::save::Files;
use crate::trajectory::SaveError;
use crate::truth::Store;
use crate::verbs::host::{Host, Label, Saver};

/// Progress, files and cache as the library sees them.
pub fn host<'a>(
    progress: &'a Progress,
    files: Option<&'a Files>,
    cache: &'a Cache,
) -> impl Host + 'a {
    Terminal {
        progress,
        files,
        cache,
    }
}

struct Terminal<'a> {
    progress: &'a Progress,
    files: Option<&'a Files>,
    cache: &'a Cache,
}

impl Host for Terminal<'_> {
    fn saver(&self, case: &Label) -> Result<Option<Box<dyn Saver>>, SaveError> {
        self.files.map(|files| files.saver(case)).transpose()
    }

    fn progress(&self, steps: u64) {
        self.progress.advance(steps);
    }

    fn store(&self) -> &dyn Store {
        self.cache
    }
}
