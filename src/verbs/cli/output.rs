//! The output of verbs: `--format` and `--output`, the report's folder, the last lines printed, and files that are
//! written whole.

use crate::report::json::Tool;
use crate::verbs::{Report, formats, series};
use anyhow::Context;
use clap::builder::PossibleValuesParser;
use std::io::{ErrorKind, Write};
use std::path::{Component, Path, PathBuf};

/// The format of tables for people, with files beside them.
const HUMAN: &str = "human";

#[derive(Debug, clap::Args)]
pub struct Output {
    /// What goes to stdout.
    #[arg(long, default_value = HUMAN, value_parser = format_ids())]
    format: String,

    /// Where reports go [default: reports; with a --format other than human, nowhere].
    #[arg(long, value_name = "DIR")]
    output: Option<PathBuf>,
}

pub fn format_ids() -> PossibleValuesParser {
    PossibleValuesParser::new(formats::FORMATS.iter().map(|format| format.id))
}

impl Output {
    /// Whether stdout has the format for people.
    pub fn is_human(&self) -> bool {
        self.format == HUMAN
    }

    /// Whether figures are wanted: in files, or as links.
    pub fn draws(&self) -> bool {
        self.output.is_some() || self.format == "markdown"
    }

    /// The folder of this file's report, where `--output` is stated.
    pub fn stated_place(&self, file: &Path) -> Option<Place> {
        let output = self.output.as_ref()?;
        Some(Place::new(output, file))
    }

    /// The same; without `--output` a folder in `reports`, where the format is for people.
    pub fn place(&self, scene: &Path) -> Option<Place> {
        let default = || Place::new("reports".as_ref(), scene);
        self.stated_place(scene)
            .or_else(|| self.is_human().then(default))
    }

    /// Prints the reports to stdout.
    pub fn print(&self, tool: &Tool, reports: &[Report]) -> anyhow::Result<()> {
        print(&rendered(&self.format, tool, reports)?)
    }

    /// Prints one report to stdout; for people, the text of [`human`].
    pub fn print_one(
        &self,
        report: &Report,
        place: Option<&Place>,
        next: Option<String>,
        otherwise: &str,
    ) -> anyhow::Result<()> {
        if self.is_human() {
            print(&human(report, place, next, otherwise))
        } else {
            self.print(&Tool::this(), std::slice::from_ref(report))
        }
    }
}

/// Reports made by `tool`, in the format of this id.
pub fn rendered(format: &str, tool: &Tool, reports: &[Report]) -> anyhow::Result<String> {
    let format = formats::format(format).context("a format without a row")?;
    Ok((format.render)(tool, reports))
}

/// Writes to stdout. A reader that has closed the pipe (`| head`) is not an error.
pub fn print(text: &str) -> anyhow::Result<()> {
    let mut out = anstream::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        other => other.context("cannot write to stdout"),
    }
}

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

    /// The report's page, which a reader opens first.
    pub fn report(&self, report: &Report) -> PathBuf {
        self.folder.join(format!("{}.md", report.stem()))
    }

    /// Makes the folder if it does not exist.
    pub fn create(&self) -> anyhow::Result<()> {
        std::fs::create_dir_all(&self.folder)
            .with_context(|| format!("cannot make {}", self.folder.display()))
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

    /// Writes a file whole or not at all: it is written under a temporary name, then renamed.
    fn put(&self, name: &str, bytes: &[u8]) -> anyhow::Result<()> {
        put(&self.folder.join(name), bytes)
    }
}

/// Writes a file whole or not at all.
pub fn put(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    let write = || -> std::io::Result<()> {
        let mut file = temporary(folder.unwrap_or_else(|| Path::new(".")))?;
        file.write_all(bytes)?;
        file.persist(path)?;
        Ok(())
    };
    write().with_context(|| format!("cannot write {}", path.display()))
}

/// A temporary file in the folder of the final one, with the permissions of any other file.
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

/// Writes the report to its folder and returns it. Without a folder there are no figures, so the report loses its
/// series and nothing links to them.
pub fn written(report: Report, place: Option<&Place>) -> anyhow::Result<Report> {
    let Some(place) = place else {
        return Ok(report.without_series());
    };
    place.create()?;
    place.write(&Tool::this(), &report)?;
    Ok(report)
}

/// The table and its verdict, then the report's path if it has a folder.
pub fn table(report: &Report, place: Option<&Place>) -> String {
    let table = report.human();
    let written = place.map_or_else(String::new, |place| {
        let file = place.report(report).display().to_string();
        format!("report: {}\n", file.replace(char::is_control, "?"))
    });
    format!("{table}{written}")
}

/// The same with a command to try next as the last line: `next`, or `otherwise` where that is missing or too long.
pub fn human(
    report: &Report,
    place: Option<&Place>,
    next: Option<String>,
    otherwise: &str,
) -> String {
    let next = next
        .filter(|next| next.chars().count() + "next: ".len() <= crate::report::terminal::WIDTH)
        .unwrap_or_else(|| otherwise.to_owned());
    format!("{}next: {next}\n", table(report, place))
}

/// The path quoted as one word for a POSIX shell; None where a terminal cannot show it.
pub fn quoted(path: &Path) -> Option<String> {
    let text = path
        .to_str()
        .filter(|text| !text.contains(char::is_control))?;
    let text = if text.starts_with('-') {
        format!("./{text}")
    } else {
        text.to_owned()
    };
    let plain = |c: char| c.is_alphanumeric() || "/._-+,:@%".contains(c);
    if text.chars().all(plain) {
        Some(text)
    } else {
        Some(format!("'{}'", text.replace('\'', "'\\''")))
    }
}

/// The value with three digits, which are enough for a suggestion.
pub fn rounded(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}
