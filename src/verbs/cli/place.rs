//! The folder of a scene's report: where it is, whether it can be written, and its files.

use super::flags::EXTENSIONS;
use super::target::Target;
use super::temporary;
use crate::report::json::Tool;
use crate::verbs::{Report, formats, series};
use anyhow::Context;
use std::ffi::OsStr;
use std::io::Write;
use std::path::{Component, Path, PathBuf};

/// The folder of one scene's report.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    folder: PathBuf,
}

/// The folder for scenes from outside of the working directory.
const OUTSIDE: &str = "@root";

impl Place {
    /// `output` followed by the scene's path without its extension; a leading `scenes` is dropped, and a path
    /// outside the working directory is mirrored from its root. What is dropped stays where another scene would
    /// otherwise have the same folder.
    pub fn new(output: &Path, scene: &Path) -> Self {
        // None where the working directory has been removed: then everything is outside of it.
        let here = std::env::current_dir().ok();
        let whole = without_dots(&std::path::absolute(scene).unwrap_or_else(|_| scene.into()));
        let inside = here.and_then(|here| {
            let inside = whole.strip_prefix(&here).ok()?.to_owned();
            let rest = inside.strip_prefix("scenes").ok();
            let rest = rest.filter(|rest| !is_there(&here.join(rest)));
            Some(rest.map(Path::to_owned).unwrap_or(inside))
        });
        let kept = match inside {
            Some(inside) => inside,
            None => {
                let normal = whole
                    .components()
                    .filter(|c| matches!(c, Component::Normal(_)));
                Path::new(OUTSIDE).join(normal.collect::<PathBuf>())
            }
        };
        Self {
            folder: output.join(kept.with_file_name(stem(&whole))),
        }
    }

    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The report's page, which a reader opens first.
    pub fn report(&self, report: &Report) -> PathBuf {
        self.folder.join(format!("{}.md", report.stem()))
    }

    /// Makes the folder ready before any work is done: makes it if it does not exist, writes a file as a trial, and
    /// removes what runs that were killed have left.
    ///
    /// # Errors
    /// Fails where no file can be written.
    pub fn prepare(&self) -> anyhow::Result<()> {
        let written = || -> std::io::Result<()> {
            std::fs::create_dir_all(&self.folder)?;
            temporary::sweep(&self.folder);
            temporary::file(&self.folder)?.write_all(b"trial")
        };
        written().with_context(|| {
            let folder = self.folder.display();
            format!("cannot write to {folder}: state another --output, or --no-files")
        })
    }

    /// Writes the report in every file format, its figures, and their series. `tool` is the program that made it.
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

    /// Writes the page that a browser shows of the folder; returns its path.
    pub fn write_page(&self, page: &str) -> anyhow::Result<PathBuf> {
        let path = self.folder.join(INDEX);
        put(&path, page.as_bytes())?;
        Ok(path)
    }

    fn put(&self, name: &str, bytes: &[u8]) -> anyhow::Result<()> {
        put(&self.folder.join(name), bytes)
    }
}

/// The page that a browser shows of a folder.
pub const INDEX: &str = "index.html";

/// Writes a whole file, or nothing.
pub fn put(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    let refusal = || format!("cannot write {}", path.display());
    Target::of(path).with_context(refusal)?.put(bytes)
}

/// The path without `..` and `.`.
fn without_dots(path: &Path) -> PathBuf {
    let mut whole = PathBuf::new();
    for component in path.components() {
        match component {
            Component::ParentDir => {
                whole.pop();
            }
            Component::CurDir => {}
            other => whole.push(other),
        }
    }
    whole
}

/// Whether a scene file is at this path, with either extension.
fn is_there(path: &Path) -> bool {
    EXTENSIONS.iter().any(|e| path.with_extension(e).exists())
}

/// The name of a scene's folder: its file's without the extension, but for names made of dots, which would not name
/// a folder, and for the second of two scenes that differ in the extension alone.
fn stem(scene: &Path) -> &OsStr {
    let name = scene.file_name().unwrap_or_default();
    let stem = scene.file_stem().unwrap_or_default();
    let dots = stem.as_encoded_bytes().iter().all(|byte| *byte == b'.');
    let [first, others @ ..] = EXTENSIONS;
    let is_second = scene
        .extension()
        .is_some_and(|e| others.iter().any(|other| e == *other));
    match dots || is_second && scene.with_extension(first).exists() {
        true => name,
        false => stem,
    }
}
