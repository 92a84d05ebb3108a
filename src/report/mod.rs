//! Reports: what a verb found in, bytes out. Nothing here touches files or the terminal, and nothing
//! but the report decides what is shown.
//!
//! A format is a row of [`FORMATS`]; the figures beside a report are [`svg::figures`]. What is particular
//! to one verb's reports is its `View`.

mod cost;
pub mod json;
pub mod markdown;
mod notes;
mod run;
pub mod series;
mod stability;
pub mod svg;
mod table;
pub mod terminal;
mod verdict;
mod words;

#[cfg(test)]
mod tests;

pub use verdict::verdict;

use crate::outcome::{Body, Report};
use json::Tool;
use notes::Note;
use svg::Figure;
use verdict::Clause;

/// One way to write reports down.
pub struct Format {
    /// As `--format` takes it.
    pub id: &'static str,
    /// Of the file it goes to, without the dot.
    pub extension: &'static str,
    /// Written beside the scene's figures in every run that writes files.
    pub file: bool,
    /// One text for all the reports of a command, and for the program that made them.
    pub render: fn(&Tool, &[Report]) -> String,
}

/// Every format there is.
pub const FORMATS: &[Format] = &[
    Format {
        id: "human",
        extension: "txt",
        file: false,
        render: |_, reports| joined(reports, terminal::render),
    },
    Format {
        id: "json",
        extension: "json",
        file: true,
        render: json::render,
    },
    Format {
        id: "markdown",
        extension: "md",
        file: true,
        render: |_, reports| joined(reports, markdown::render),
    },
];

/// The format with this id.
pub fn format(id: &str) -> Option<&'static Format> {
    FORMATS.iter().find(|format| format.id == id)
}

fn joined(reports: &[Report], render: fn(&Report) -> String) -> String {
    let texts: Vec<String> = reports.iter().map(render).collect();
    texts.join("\n")
}

/// How what one verb found is shown: the findings themselves know.
trait View {
    /// What its files are called, without the dot and what follows: verbs do not write over each
    /// other's.
    fn stem(&self) -> &'static str;

    /// The figures it may have, in the order they are shown.
    fn figures(&self) -> &'static [Figure];

    /// The verdict, but for failed checks, which come first: in the order they are said, which is mostly
    /// that of their importance.
    fn clauses(&self, report: &Report) -> Vec<Clause>;

    /// What holds of the whole scene: label and text.
    fn facts(&self, report: &Report) -> Vec<(&'static str, String)>;

    /// In the terminal: what stands between the facts and the notes.
    fn lines(&self, report: &Report) -> Vec<String>;

    /// What there is to say of single engines.
    fn notes(&self, report: &Report) -> Vec<Note>;

    /// In the terminal: what follows the checks, label and text.
    fn last(&self, _report: &Report) -> Vec<(&'static str, String)> {
        Vec::new()
    }

    /// The whole page, with its figures linked as files beside it.
    fn markdown(&self, report: &Report) -> String;
}

/// The one place that tells verbs apart.
fn view(report: &Report) -> &dyn View {
    match &report.body {
        Body::Run { outcomes } | Body::Compare { outcomes, .. } => outcomes,
        Body::Stability { stability, .. } => stability,
        Body::Cost { cost, .. } => cost,
    }
}

/// What a report's files are called, without the dot and what follows.
pub fn stem(report: &Report) -> &'static str {
    view(report).stem()
}
