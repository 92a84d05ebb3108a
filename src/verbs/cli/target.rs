//! Where a file goes that somebody names: behind its links, and whole or not at all.

use super::temporary::{self, Temporary};
use anyhow::Context;
use std::fs::File;
use std::io::{Error, ErrorKind, Result, Seek, Write};
use std::path::{Path, PathBuf};

/// A file to write. What is there is replaced whole and keeps its permissions; what is no regular file, a pipe or a
/// device, is written into.
#[derive(Debug, Clone)]
pub struct Target {
    /// As it was named.
    named: PathBuf,
    /// The regular file, absolute and without links; None for what is written into.
    file: Option<PathBuf>,
}

/// More links in a row than any system follows.
const MAX_LINKS: usize = 40;

impl Target {
    /// Follows the links of the path. The last of them may lead to a file that is still to be made.
    ///
    /// # Errors
    /// Fails where the path leads to a folder, in a circle, or through a folder that is not there.
    pub fn of(path: &Path) -> Result<Self> {
        let file = match path.metadata() {
            Ok(facts) if facts.is_dir() => return Err(ErrorKind::IsADirectory.into()),
            Ok(facts) if !facts.is_file() => None,
            Ok(_) => behind(path)?,
            Err(error) if error.kind() == ErrorKind::NotFound => behind(path)?,
            Err(error) => return Err(error),
        };
        let named = path.to_owned();
        Ok(Self { named, file })
    }

    /// The regular file it is, absolute and without links; None for a pipe or a device.
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// The temporary file that its content is collected in.
    pub fn begin(&self) -> Result<Temporary> {
        match self.file() {
            Some(file) => temporary::file(folder(file)),
            None => temporary::file(&std::env::temp_dir()),
        }
    }

    /// Puts the content into its place.
    pub fn complete(&self, mut content: Temporary) -> Result<()> {
        let Some(file) = self.file() else {
            content.rewind()?;
            // Neither cuts nor overwrites what others write to the same open file, as to /dev/stdout.
            let mut into = File::options().append(true).open(&self.named)?;
            return std::io::copy(content.as_file(), &mut into).map(drop);
        };
        if let Ok(facts) = file.metadata() {
            // A disk without permissions has none to keep.
            let _ = content.as_file().set_permissions(facts.permissions());
        }
        content.become_file(file)
    }

    /// Tries whether it can be written. A pipe is not opened: its reader would take that for the end.
    ///
    /// # Errors
    /// Fails where no file can be made in its folder.
    pub fn prepare(&self) -> anyhow::Result<()> {
        let tried = match self.file() {
            Some(_) => self.begin().and_then(|mut file| file.write_all(b"trial")),
            None => Ok(()),
        };
        tried.with_context(|| self.refusal())
    }

    /// Writes the whole content.
    ///
    /// # Errors
    /// Fails where it cannot be written. A regular file then stays as it was.
    pub fn put(&self, content: &[u8]) -> anyhow::Result<()> {
        let written = self.begin().and_then(|mut file| {
            file.write_all(content)?;
            self.complete(file)
        });
        written.with_context(|| self.refusal())
    }

    fn refusal(&self) -> String {
        format!("cannot write {}", self.named.display())
    }
}

/// The path of the same file without links: absolute, whether or not the file is there. None where a link is the
/// system's name of an open file, as /dev/stdout leads to one: in its place no other file can be put.
fn behind(path: &Path) -> Result<Option<PathBuf>> {
    let mut at = path.to_owned();
    for _ in 0..MAX_LINKS {
        at = without_aliases(&at)?;
        match at.read_link() {
            Ok(_) if at.starts_with("/proc") => return Ok(None),
            Ok(to) => at = folder(&at).join(to),
            // The system may know one name in several spellings.
            Err(_) => return Ok(Some(at.canonicalize().unwrap_or(at))),
        }
    }
    Err(Error::other("too many links"))
}

/// The one path of a file by whatever way its folder is named: absolute. A link is a file of its own.
///
/// # Errors
/// Fails where the folder is not there, or the path is that of a folder.
pub fn without_aliases(path: &Path) -> Result<PathBuf> {
    let no_file = || Error::new(ErrorKind::InvalidInput, "it names no file");
    let name = path.file_name().ok_or_else(no_file)?;
    Ok(folder(path).canonicalize()?.join(name))
}

/// The folder that a file is in.
fn folder(file: &Path) -> &Path {
    let folder = file.parent();
    let folder = folder.filter(|folder| !folder.as_os_str().is_empty());
    folder.unwrap_or_else(|| Path::new("."))
}
