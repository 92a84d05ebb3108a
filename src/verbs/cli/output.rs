//! The output of verbs: `--format` and `--output`, and what is printed.

use super::place::Place;
use crate::report::json::Tool;
use crate::report::terminal::{self, width};
use crate::scene::words::{acts, aside, in_line, visible};
use crate::verbs::{Report, formats};
use anyhow::{Context, bail};
use clap::builder::PossibleValuesParser;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// The format of tables for people, with files beside them.
const HUMAN: &str = "human";
/// The format that has its figures in it.
const PAGE: &str = "html";
/// The format of a line a report.
const LINES: &str = "jsonl";

#[derive(Debug, clap::Args)]
pub struct Output {
    /// What goes to stdout.
    #[arg(long, default_value = HUMAN, value_parser = format_ids())]
    format: String,

    /// Where reports go [default: reports; with a --format other than human, nowhere].
    #[arg(long, value_name = "DIR|none")]
    output: Option<PathBuf>,

    /// Write no files, as `--output none` does.
    #[arg(long, conflicts_with = "output")]
    no_files: bool,
}

/// The `--output` that writes nothing. A folder of this name is `./none`.
const NOWHERE: &str = "none";

pub fn format_ids() -> PossibleValuesParser {
    PossibleValuesParser::new(formats::FORMATS.iter().map(|format| format.id))
}

impl Output {
    /// Whether stdout has the format for people.
    pub fn is_human(&self) -> bool {
        self.format == HUMAN
    }

    /// Whether the format has a line for each report, which can be printed before the next is there.
    pub fn is_by_line(&self) -> bool {
        self.format == LINES
    }

    /// Whether figures are wanted: in files, or as links.
    pub fn draws(&self) -> bool {
        self.stated().is_some() || ["markdown", PAGE].contains(&self.format.as_str())
    }

    /// The folder that `--output` states.
    fn stated(&self) -> Option<&Path> {
        let stated = self.output.as_deref()?;
        (stated != Path::new(NOWHERE)).then_some(stated)
    }

    /// The folder of this file's report, where `--output` is stated.
    pub fn stated_place(&self, file: &Path) -> Option<Place> {
        Some(Place::new(self.stated()?, file))
    }

    /// The same; without `--output` a folder in `reports`, where the format is for people.
    pub fn place(&self, scene: &Path) -> Option<Place> {
        let by_default = self.output.is_none() && !self.no_files && self.is_human();
        let default = by_default.then_some(Path::new("reports"));
        Some(Place::new(self.stated().or(default)?, scene))
    }

    /// Prints the reports to stdout, as [`print()`].
    pub fn print(&self, tool: &Tool, reports: &[Report]) -> anyhow::Result<bool> {
        print(&rendered(&self.format, tool, reports)?)
    }

    /// Whether a page is made: among the files of a folder, or on stdout.
    pub fn plays(&self, place: Option<&Place>) -> bool {
        place.is_some() || self.format == PAGE
    }

    /// Writes the report to its folder, and returns it with the result of that: where writing fails, the report is not
    /// lost. Without a folder or a page there are no figures, so the report loses its series and nothing links to them.
    pub fn written(&self, report: Report, place: Option<&Place>) -> (Report, anyhow::Result<()>) {
        let report = match self.plays(place) {
            true => report,
            false => report.without_series(),
        };
        let written = place.map_or(Ok(()), |place| place.write(&Tool::this(), &report));
        (report, written)
    }

    /// Writes the report to its folder and prints it, also where it could not be written.
    ///
    /// # Errors
    /// Fails where the report could not be written or printed.
    pub fn finish(
        &self,
        report: Report,
        place: Option<Place>,
        otherwise: &str,
        quiet: bool,
    ) -> anyhow::Result<Report> {
        let (report, saved) = self.written(report, place.as_ref());
        // The path of a report is not shown where the report could not be written.
        let place = place.filter(|_| saved.is_ok());
        self.print_one(&report, place.as_ref(), otherwise, quiet)?;
        saved?;
        Ok(report)
    }

    /// Prints one report to stdout; for people the text of [`human`], or where it is to be quiet the [`summary`].
    /// Returns what [`print()`] does.
    pub fn print_one(
        &self,
        report: &Report,
        place: Option<&Place>,
        otherwise: &str,
        quiet: bool,
    ) -> anyhow::Result<bool> {
        match (self.is_human(), quiet) {
            (true, true) => print(&summary(report)),
            (true, false) => print(&human(report, place, otherwise)),
            (false, _) => self.print(&Tool::this(), std::slice::from_ref(report)),
        }
    }
}

/// Refuses an id that is no format's.
pub fn known(id: &str) -> anyhow::Result<()> {
    let known: Vec<&str> = formats::FORMATS.iter().map(|format| format.id).collect();
    if !known.contains(&id) {
        let (aside, known) = (aside(id, &known), known.join(", "));
        bail!("unknown format `{id}`{aside}; known: {known}");
    }
    Ok(())
}

/// Reports made by `tool`, in the format of this id.
pub fn rendered(format: &str, tool: &Tool, reports: &[Report]) -> anyhow::Result<String> {
    let format = formats::format(format).context("a format without a row")?;
    Ok((format.render)(tool, reports))
}

/// The same for stdout: text for people is as wide as the terminal.
pub fn shown(format: &str, tool: &Tool, reports: &[Report]) -> anyhow::Result<String> {
    if format != HUMAN {
        return rendered(format, tool, reports);
    }
    let texts = reports.iter().map(|report| report.human(columns()));
    Ok(formats::together(reports, texts, columns()))
}

/// Writes to stdout, and returns whether anybody reads it: a reader that has closed the pipe (`| head`) is not an error.
pub fn print(text: &str) -> anyhow::Result<bool> {
    let mut out = anstream::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(false),
        other => other.context("cannot write to stdout").map(|()| true),
    }
}

/// The table and its verdict, then the report's path if it has a folder.
pub fn table(report: &Report, place: Option<&Place>) -> String {
    let table = report.human(columns());
    let written = place.map_or_else(String::new, |place| {
        let file = place.report(report).display().to_string();
        format!("report: {}\n", in_line(&file))
    });
    format!("{table}{written}")
}

/// The same with the first command of the report's advice as the last line, or `otherwise` where there is none that
/// fits the line.
pub fn human(report: &Report, place: Option<&Place>, otherwise: &str) -> String {
    let fits = |next: &&String| width(next) + "next: ".len() <= columns();
    let next = report.header.advice.first().filter(fits);
    let next = next.map_or(otherwise, String::as_str);
    format!("{}next: {}\n", table(report, place), visible(next))
}

/// The report's scene and its verdict on one line, which is cut where a terminal would break it.
pub fn summary(report: &Report) -> String {
    cut(&format!("{}\n", report.line(columns())))
}

/// What stands below the texts of several reports; below their summaries, only what those do not say.
pub fn closing(reports: &[Report], quiet: bool) -> String {
    match quiet && !formats::is_gate(reports) {
        true => String::new(),
        false => cut(&formats::closing(reports, columns())),
    }
}

/// The lines, each cut at the width of the terminal, if there is one.
fn cut(lines: &str) -> String {
    if terminal_size::terminal_size_of(std::io::stdout()).is_none() {
        return lines.to_owned();
    }
    let cut = |line| terminal::clip(line, columns()) + "\n";
    lines.lines().map(cut).collect()
}

/// The columns of a line on stdout: those of the terminal, and a fixed number where there is none.
pub fn columns() -> usize {
    let terminal = terminal_size::terminal_size_of(std::io::stdout());
    let columns = terminal.map_or(terminal::WIDTH, |(columns, _)| usize::from(columns.0));
    columns.max(terminal::MIN_WIDTH)
}

/// The path quoted as one word for a POSIX shell; None where a terminal cannot show it.
pub fn quoted(path: &Path) -> Option<String> {
    let text = path.to_str().filter(|text| !text.contains(acts))?;
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
