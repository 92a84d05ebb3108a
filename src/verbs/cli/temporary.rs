//! Temporary files: hidden, beside the file they become, and gone with the process that holds them.
//!
//! A process locks its files, and the system drops a lock with its process. So what can be locked belongs to nobody
//! any more: the next run in the folder removes it.

use super::interrupt;
use std::fs::File;
use std::path::Path;
use tempfile::NamedTempFile;

/// What the name of a temporary file begins with.
const PREFIX: &str = ".springcheck-";
/// Another process may take a file for an abandoned one before it is locked. It is then made again, up to so many
/// times.
const TRIALS: usize = 8;

/// A temporary file in the folder of the final one, with the permissions of any other file. It is removed when it is
/// dropped, or when a signal ends the program.
pub fn file(folder: &Path) -> std::io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The process's umask still applies.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.prefix(PREFIX);
    let mut made = interrupt::remembered(|| builder.tempfile_in(folder), NamedTempFile::path)?;
    for _ in 1..TRIALS {
        // Where a disk knows no locks, nothing is taken for abandoned either.
        let taken = matches!(
            made.as_file().try_lock(),
            Err(std::fs::TryLockError::WouldBlock)
        );
        if !taken && made.path().exists() {
            break;
        }
        made = interrupt::remembered(|| builder.tempfile_in(folder), NamedTempFile::path)?;
    }
    Ok(made)
}

/// Removes the temporary files in the folder whose process was killed. Failures are ignored: the next run tries again.
pub fn sweep(folder: &Path) {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return;
    };
    for entry in entries.flatten() {
        let ours = entry
            .file_name()
            .as_encoded_bytes()
            .starts_with(PREFIX.as_bytes());
        if !ours || !entry.file_type().is_ok_and(|kind| kind.is_file()) {
            continue;
        }
        let file = File::options().write(true).open(entry.path());
        if file.is_ok_and(|file| file.try_lock().is_ok()) {
            let _ = std::fs::remove_file(entry.path());
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
        let abandoned = folder.path().join(format!("{PREFIX}x"));
        let other = folder.path().join("report.md");
        for path in [&abandoned, &other] {
            std::fs::write(path, "text").unwrap();
        }
        sweep(folder.path());
        assert!(held.path().exists() && other.exists() && !abandoned.exists());
    }
}
