//! The cache that keeps truths between runs.

use super::temporary;
use crate::truth::Store;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The environment variable that names the folder; if it is empty, nothing is kept.
const VARIABLE: &str = "SPRINGCHECK_CACHE";
/// The size of the cache, bytes, beyond which its oldest entries are removed.
const MAX_BYTES: u64 = 512 << 20;

/// A folder of files named by their keys. A file appears whole or not at all; a second writer overwrites it
/// with the same bytes.
#[derive(Debug)]
pub struct Cache {
    folder: Option<PathBuf>,
}

impl Cache {
    /// The folder that `SPRINGCHECK_CACHE` names, else `springcheck` in the user's cache folder.
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
        // Failures are ignored: without the entry, the truth is computed again.
        if let Some(folder) = &self.folder {
            let _ = put(folder, key, bytes);
            temporary::sweep(folder);
            let _ = prune(folder);
        }
    }
}

fn put(folder: &Path, key: &str, bytes: &[u8]) -> std::io::Result<()> {
    std::fs::create_dir_all(folder)?;
    let mut file = temporary::file(folder)?;
    file.write_all(bytes)?;
    file.become_file(&folder.join(key))
}

/// Removes the oldest entries beyond the limit.
fn prune(folder: &Path) -> std::io::Result<()> {
    let mut entries = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        let facts = entry.metadata()?;
        // Only files that this program wrote are removed: their names are hexadecimal keys.
        let name = entry.file_name();
        let key = name.to_str().is_some_and(is_key);
        if facts.is_file() && key {
            entries.push((facts.modified()?, facts.len(), entry.path()));
        }
    }
    entries.sort();
    let mut total: u64 = entries.iter().map(|(_, bytes, _)| bytes).sum();
    for (_, bytes, path) in entries {
        if total <= MAX_BYTES {
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
