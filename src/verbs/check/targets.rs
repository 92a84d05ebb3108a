//! The files that the gate writes, found before the work that fills them.

use crate::verbs::cli::target::{Target, without_aliases};
use anyhow::{Context, bail};
use std::path::{Path, PathBuf};

/// The files that --accept and --write name.
#[derive(Debug, Default)]
pub struct Targets<'a> {
    pub accept: Option<Target>,
    /// Each with its format.
    pub writes: Vec<(&'a str, Target)>,
}

impl<'a> Targets<'a> {
    /// Finds the files, and tries whether they can be written.
    ///
    /// # Errors
    /// Fails where one of them cannot be written, is `read` as something else, or is another of them. A baseline may be
    /// accepted where it was.
    pub fn find<'r>(
        read: impl Iterator<Item = &'r PathBuf>,
        baseline: Option<&Path>,
        accept: Option<&'a Path>,
        writes: impl Iterator<Item = (&'a str, &'a Path)>,
    ) -> anyhow::Result<Self> {
        // What a file is already, by its one path. A link is a file, and so is what it leads to.
        let mut taken: Vec<(PathBuf, String)> = Vec::new();
        for path in read {
            let what = format!("{} is read", path.display());
            taken.extend(without_aliases(path).map(|path| (path, what.clone())));
            taken.extend(path.canonicalize().map(|path| (path, what)));
        }
        let baseline = baseline.and_then(|path| path.canonicalize().ok());
        let accept = accept.map(|path| (None, path)).into_iter();
        let mut targets = Self::default();
        for (format, path) in accept.chain(writes.map(|(format, path)| (Some(format), path))) {
            let flag = match format {
                Some(format) => format!("--write {format}={}", path.display()),
                None => format!("--accept {}", path.display()),
            };
            let target = Target::of(path).with_context(|| format!("{flag}: cannot write there"))?;
            if let Some(file) = target.file() {
                let known = taken.iter().find(|(path, _)| path == file);
                let what = known.map(|(_, what)| what.as_str());
                let compared = format.is_some() && baseline.as_deref() == Some(file);
                if let Some(what) = what.or(compared.then_some("it is the baseline")) {
                    bail!("{flag}: the file would be lost, since {what}; name another");
                }
                taken.push((file.to_owned(), format!("{flag} goes there")));
            }
            target.prepare().with_context(|| flag)?;
            match format {
                Some(format) => targets.writes.push((format, target)),
                None => targets.accept = Some(target),
            }
        }
        Ok(targets)
    }
}
