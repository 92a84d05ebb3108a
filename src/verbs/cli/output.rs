//! Where reports go, and how they get there whole.

use crate::report::json::Tool;
use crate::verbs::Report;
use crate::verbs::{formats, series};
use anyhow::Context;
use std::io::Write;
use std::path::{Component, Path, PathBuf};

/// The folder of one scene's report.
#[derive(Debug, Clone)]
pub struct Place {
    folder: PathBuf,
}

impl Place {
    /// `output` followed by the scene's path without its extension; a leading `scenes` is dropped,
    /// and a path outside the working directory is mirrored from its root.
    pub fn new(output: &Path, scene: &Path) -> Self {
        let stem = scene.with_extension("");
        let absolute = std::path::absolute(&stem).unwrap_or(stem);
        let here = std::env::current_dir().unwrap_or_default();
        let inside = absolute.strip_prefix(&here).unwrap_or(&absolute);
        let mut parts: Vec<_> = Vec::new();
        for component in inside.components() {
            match component {
                Component::Normal(part) => parts.push(part),
                Component::ParentDir => {
                    parts.pop();
                }
                Component::Prefix(_) | Component::RootDir | Component::CurDir => {}
            }
        }
        if parts.len() > 1 && parts[0] == "scenes" {
            parts.remove(0);
        }
        Self {
            folder: output.join(parts.iter().collect::<PathBuf>()),
        }
    }

    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The file to open first.
    pub fn report(&self, report: &Report) -> PathBuf {
        self.folder.join(format!("{}.md", report.stem()))
    }

    /// Makes the folder where it is not there.
    pub fn create(&self) -> anyhow::Result<()> {
        std::fs::create_dir_all(&self.folder)
            .with_context(|| format!("cannot make {}", self.folder.display()))
    }

    /// Writes the report in every file format, its figures, and what these are drawn from. `tool` made it.
    pub fn write(&self, tool: &Tool, report: &Report) -> anyhow::Result<()> {
        let reports = std::slice::from_ref(report);
        let stem = report.stem();
        if let Some(bytes) = series::pack(reports) {
            self.put(&format!("{stem}.{}", series::EXTENSION), &bytes)?;
        }
        for format in formats::FORMATS.iter().filter(|format| format.file) {
            let name = format!("{stem}.{}", format.extension);
            let text = (format.render)(tool, reports);
            self.put(&name, text.as_bytes())?;
        }
        for (name, svg) in report.svg() {
            self.put(name, svg.as_bytes())?;
        }
        Ok(())
    }

    /// A whole file or none: written beside its place, then renamed.
    fn put(&self, name: &str, bytes: &[u8]) -> anyhow::Result<()> {
        let path = self.folder.join(name);
        let write = || -> std::io::Result<()> {
            let mut file = temporary(&self.folder)?;
            file.write_all(bytes)?;
            file.persist(&path)?;
            Ok(())
        };
        write().with_context(|| format!("cannot write {}", path.display()))
    }
}

/// A temporary file in the folder of its final place, readable as any other file will be.
pub fn temporary(folder: &Path) -> std::io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The process's umask still applies.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.prefix(".springcheck-").tempfile_in(folder)
}
