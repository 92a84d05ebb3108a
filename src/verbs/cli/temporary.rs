//! Temporary files and folders: hidden, and gone with the process that holds them.
//!
//! A process locks what it makes, and the system drops a lock with its process. So what can be locked belongs to nobody
//! any more: the next run in the same folder removes it.

use super::interrupt;
use std::fs::{File, TryLockError};
use std::io::{Result, Seek, SeekFrom, Write};
use std::path::Path;
use tempfile::{Builder, NamedTempFile, TempDir};

/// What the name of everything temporary begins with.
const PREFIX: &str = ".springcheck-";
/// Another process may take something for abandoned before it is locked. It is then made again, up to so many times.
const TRIALS: usize = 8;

/// A temporary file. It is removed when it is dropped, or when a signal ends the program. Its errors are those of the
/// system: they do not name it, since nobody has heard of it.
#[derive(Debug)]
pub struct Temporary(NamedTempFile);

/// A temporary folder, which goes with all that is in it.
#[derive(Debug)]
pub struct Folder {
    folder: TempDir,
    /// Held for its lock; None where a folder cannot be opened.
    _lock: Option<File>,
}

/// A temporary file in this folder, with the permissions of any other file.
pub fn file(folder: &Path) -> Result<Temporary> {
    let mut options = File::options();
    options.read(true).write(true).create_new(true);
    let make = || {
        Builder::new()
            .prefix(PREFIX)
            .make_in(folder, |path| options.open(path))
    };
    let lock = |made: &NamedTempFile| made.as_file().try_lock();
    held(make, NamedTempFile::path, lock).map(Temporary)
}

/// A temporary folder where the system keeps such.
pub fn folder() -> Result<Folder> {
    let place = std::env::temp_dir();
    sweep(&place);
    let make = || {
        let folder = Builder::new().prefix(PREFIX).tempdir_in(&place)?;
        let lock = File::open(folder.path()).ok();
        Ok(Folder {
            folder,
            _lock: lock,
        })
    };
    let lock = |made: &Folder| made._lock.as_ref().map_or(Ok(()), File::try_lock);
    held(make, Folder::path, lock)
}

/// Makes and locks something.
fn held<T>(
    make: impl Fn() -> Result<T>,
    path: impl Fn(&T) -> &Path,
    lock: impl Fn(&T) -> std::result::Result<(), TryLockError>,
) -> Result<T> {
    let mut made = interrupt::remembered(&make, &path)?;
    for _ in 1..TRIALS {
        // Where a disk knows no locks, nothing is taken for abandoned either.
        let taken = matches!(lock(&made), Err(TryLockError::WouldBlock));
        if !taken && path(&made).exists() {
            break;
        }
        made = interrupt::remembered(&make, &path)?;
    }
    Ok(made)
}

impl Temporary {
    /// Becomes the file of this path, in the place of one that is there.
    pub fn become_file(self, path: &Path) -> Result<()> {
        Ok(self.0.persist(path).map(drop)?)
    }

    /// The same, but a file that is there stays.
    pub fn become_new(self, path: &Path) -> Result<()> {
        Ok(self.0.persist_noclobber(path).map(drop)?)
    }

    pub fn as_file(&mut self) -> &mut File {
        self.0.as_file_mut()
    }
}

impl Write for Temporary {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        self.as_file().write(bytes)
    }

    fn flush(&mut self) -> Result<()> {
        self.as_file().flush()
    }
}

impl Seek for Temporary {
    fn seek(&mut self, to: SeekFrom) -> Result<u64> {
        self.as_file().seek(to)
    }
}

impl Folder {
    pub fn path(&self) -> &Path {
        self.folder.path()
    }
}

/// Removes what is temporary in the folder and of a process that was killed. Failures are ignored: the next run tries
/// again.
pub fn sweep(folder: &Path) {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return;
    };
    for entry in entries.flatten() {
        let (name, path) = (entry.file_name(), entry.path());
        let ours = name.as_encoded_bytes().starts_with(PREFIX.as_bytes());
        let Some(kind) = entry.file_type().ok().filter(|_| ours) else {
            continue;
        };
        let opened = match kind.is_dir() {
            true => File::open(&path),
            false if kind.is_file() => File::options().write(true).open(&path),
            false => continue,
        };
        // Held until it is removed: who made it a moment ago then knows that it is gone.
        if let Some(_held) = opened.ok().filter(|file| file.try_lock().is_ok()) {
            let _ = match kind.is_dir() {
                true => std::fs::remove_dir_all(&path),
                false => std::fs::remove_file(&path),
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_held_stays_and_what_is_abandoned_goes() {
        let folder = tempfile::tempdir().unwrap();
        let held = file(folder.path()).unwrap();
        let abandoned = ["x", "y"].map(|name| folder.path().join(format!("{PREFIX}{name}")));
        let other = folder.path().join("report.md");
        std::fs::create_dir(&abandoned[1]).unwrap();
        for path in [&abandoned[0], &abandoned[1].join("scene.json"), &other] {
            std::fs::write(path, "text").unwrap();
        }
        sweep(folder.path());
        assert!(held.0.path().exists() && other.exists());
        assert!(abandoned.iter().all(|path| !path.exists()));
    }
}
