//! What verbs print and where they write: formats, the report's place, the last lines.

use super::output::Place;
use crate::report;
use crate::report::json::Tool;
use crate::verbs::{Report, formats};
use anyhow::Context;
use clap::builder::PossibleValuesParser;
use std::path::Path;

/// The format whose texts are tables for people, with files beside them.
pub const HUMAN: &str = "human";

pub fn format_ids() -> PossibleValuesParser {
    PossibleValuesParser::new(formats::FORMATS.iter().map(|format| format.id))
}

/// Reports are files only where somebody asked for them or looks at the table.
pub fn place(output: Option<&Path>, format: &str, scene: &Path) -> Option<Place> {
    match output {
        Some(output) => Some(Place::new(output, scene)),
        None if format == HUMAN => Some(Place::new("reports".as_ref(), scene)),
        None => None,
    }
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

/// The reports on stdout.
pub fn print(format: &str, tool: &Tool, reports: &[Report]) -> anyhow::Result<()> {
    let format = formats::format(format).context("a format without a row")?;
    super::print(&(format.render)(tool, reports))
}

/// One report on stdout; for people with a command to try next, as in [`human`].
pub fn print_one(
    format: &str,
    report: &Report,
    place: Option<&Place>,
    next: Option<String>,
    otherwise: &str,
) -> anyhow::Result<()> {
    if format == HUMAN {
        super::print(&human(report, place, next, otherwise))
    } else {
        print(format, &Tool::this(), std::slice::from_ref(report))
    }
}

/// The table and its verdict, then the report's path if there is one.
pub fn table(report: &Report, place: Option<&Place>) -> String {
    let table = report::terminal::render(report.view());
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
        .filter(|next| next.chars().count() + "next: ".len() <= report::terminal::WIDTH)
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
