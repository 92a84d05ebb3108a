//! Where truths are kept between runs.

use super::output::temporary;
use crate::truth::Store;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Names the folder; empty means that nothing is kept.
const VARIABLE: &str = "SPRINGCHECK_CACHE";
/// The oldest entries go when there are more than this many bytes.
const LARGEST: u64 = 512 << 20;

/// A folder of files named by their keys. A file appears whole or not at all; whoever comes second
/// overwrites with the same bytes.
#[derive(Debug)]
pub struct Cache {
    folder: Option<PathBuf>,
}

impl Cache {
    /// The folder `SPRINGCHECK_CACHE` names, else `springcheck` in the user's cache folder.
    pub fn new() -> Self {
        Self { folder: folder() }
    }
}

fn folder() -> Option<PathBuf> {
    let named = |name| std::env::var_os(name).map(PathBuf::from);
    if let Some(folder) = named(VARIABLE) {
        return Some(folder).filter(|folder| !folder.as_os_str().is_empty());
    }
    let absolute = |path: &PathBuf| path.is_absolute();
    named("XDG_CACHE_HOME")
        .filter(absolute)
        .or_else(|| named("LOCALAPPDATA").filter(absolute))
        .or_else(|| Some(named("HOME").filter(absolute)?.join(".cache")))
        .map(|caches| caches.join("springcheck"))
}

impl Store for Cache {
    fn load(&self, key: &str) -> Option<Vec<u8>> {
        std::fs::read(self.folder.as_ref()?.join(key)).ok()
    }

    fn save(&self, key: &str, bytes: &[u8]) {
        // A cache that cannot be written is an empty one.
        if let Some(folder) = &self.folder {
            let _ = put(folder, key, bytes);
            let _ = prune(folder);
        }
    }
}

fn put(folder: &Path, key: &str, bytes: &[u8]) -> std::io::Result<()> {
    std::fs::create_dir_all(folder)?;
    let mut file = temporary(folder)?;
    file.write_all(bytes)?;
    file.persist(folder.join(key))?;
    Ok(())
}

/// Removes the oldest entries beyond the limit.
fn prune(folder: &Path) -> std::io::Result<()> {
    let mut entries = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        let facts = entry.metadata()?;
        // Only what this program wrote: keys are hexadecimal.
        let name = entry.file_name();
        let key = name.to_str().is_some_and(is_key);
        if facts.is_file() && key {
            entries.push((facts.modified()?, facts.len(), entry.path()));
        }
    }
    entries.sort();
    let mut total: u64 = entries.iter().map(|(_, bytes, _)| bytes).sum();
    for (_, bytes, path) in entries {
        if total <= LARGEST {
            break;
        }
        std::fs::remove_file(path)?;
        total -= bytes;
    }
    Ok(())
}

fn is_key(name: &str) -> bool {
    name.len() >= 16 && name.bytes().all(|b| b.is_ascii_hexdigit())
}
