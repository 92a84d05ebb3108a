//! A session that computes a truth once, however many runs ask for it.

use springcheck::trajectory::SaveError;
use springcheck::truth::Store;
use springcheck::verbs::session::{Label, Saver, Session};
use std::collections::HashMap;
use std::sync::Mutex;

/// Keeps truths while the tests run, and nothing else.
pub struct Remembering(Mutex<HashMap<String, Vec<u8>>>);

/// One for all tests.
pub fn remembering() -> &'static Remembering {
    static ONE: std::sync::LazyLock<Remembering> =
        std::sync::LazyLock::new(|| Remembering(Mutex::default()));
    &ONE
}

impl Session for Remembering {
    fn saver(&self, _case: &Label) -> Result<Option<Box<dyn Saver>>, SaveError> {
        Ok(None)
    }

    fn progress(&self, _steps: u64) {}

    fn store(&self) -> &dyn Store {
        self
    }
}

impl Store for Remembering {
    fn load(&self, key: &str) -> Option<Vec<u8>> {
        self.0.lock().expect("no panic").get(key).cloned()
    }

    fn save(&self, key: &str, bytes: &[u8]) {
        let mut kept = self.0.lock().expect("no panic");
        kept.insert(key.to_owned(), bytes.to_vec());
    }
}
