//! What verbs print and where they write: `--format` and `--output`, the report's place, the last lines, and how
//! files get there whole.

use crate::report::json::Tool;
use crate::verbs::{Report, formats, series};
use anyhow::Context;
use clap::builder::PossibleValuesParser;
use std::io::{ErrorKind, Write};
use std::path::{Component, Path, PathBuf};

/// The format whose texts are tables for people, with files beside them.
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

fn format_ids() -> PossibleValuesParser {
    PossibleValuesParser::new(formats::FORMATS.iter().map(|format| format.id))
}

impl Output {
    /// Whether people read stdout.
    pub fn is_human(&self) -> bool {
        self.format == HUMAN
    }

    /// Whether figures are wanted: in files, or as links.
    pub fn draws(&self) -> bool {
        self.output.is_some() || self.format == "markdown"
    }

    /// The place of what is about this file, where a folder is asked for.
    pub fn asked_place(&self, file: &Path) -> Option<Place> {
        let output = self.output.as_ref()?;
        Some(Place::new(output, file))
    }

    /// The same, or where people look at the table a place in `reports`.
    pub fn place(&self, scene: &Path) -> Option<Place> {
        let usual = || Place::new("reports".as_ref(), scene);
        self.asked_place(scene)
            .or_else(|| self.is_human().then(usual))
    }

    /// The reports on stdout.
    pub fn print(&self, tool: &Tool, reports: &[Report]) -> anyhow::Result<()> {
        let format = formats::format(&self.format).context("a format without a row")?;
        print(&(format.render)(tool, reports))
    }

    /// One report on stdout; for people as [`human`] has it.
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

/// Writes to stdout. A reader that has gone away (`| head`) is not an error.
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

/// The report after it is written to its place. Without one there are no figures, so nothing links to
/// them.
pub fn written(report: Report, place: Option<&Place>) -> anyhow::Result<Report> {
    let Some(place) = place else {
        return Ok(report.without_series());
    };
    place.create()?;
    place.write(&Tool::this(), &report)?;
    Ok(report)
}

/// The table and its verdict, then the report's path if there is one.
pub fn table(report: &Report, place: Option<&Place>) -> String {
    let table = crate::report::terminal::render(report.view());
    let written = place.map_or_else(String::new, |place| {
        let file = place.report(report).display().to_string();
        format!("report: {}\n", file.replace(char::is_control, "?"))
    });
    format!("{table}{written}")
}

/// The same and, as the last line, a command to try next: this one, or where it is too long or cannot
/// be written down, `otherwise`.
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

/// The path as a POSIX shell takes it for one word; None with what a terminal cannot show.
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

/// Three digits are enough for a suggestion.
pub fn rounded(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}
