//! Reports: what a run found in, bytes out. Nothing here touches files or the terminal.
//!
//! A format is a row of [`FORMATS`]; the figures beside a report are [`svg::figures`].

mod cost;
mod identity;
pub mod json;
pub mod markdown;
mod notes;
mod stability;
pub mod svg;
pub mod terminal;
mod verdict;
mod words;

#[cfg(test)]
mod tests;

pub use verdict::verdict;

use crate::outcome::Report;

/// One way to write reports down.
pub struct Format {
    /// As `--format` takes it.
    pub id: &'static str,
    /// Of the file it goes to, without the dot.
    pub extension: &'static str,
    /// Written beside the scene's figures in every run that writes files.
    pub file: bool,
    /// One text for all the reports of a run.
    pub render: fn(&[Report]) -> String,
}

/// Every format there is.
pub const FORMATS: &[Format] = &[
    Format {
        id: "human",
        extension: "txt",
        file: false,
        render: |reports| joined(reports, terminal::render),
    },
    Format {
        id: "json",
        extension: "json",
        file: true,
        render: json::render_all,
    },
    Format {
        id: "markdown",
        extension: "md",
        file: true,
        render: |reports| joined(reports, markdown::render),
    },
];

/// What a report's files are called, without the dot and what follows: verbs do not write over each
/// other's.
pub fn stem(report: &Report) -> &'static str {
    if stability::is_alone(report) {
        "stability"
    } else if cost::is_alone(report) {
        "cost"
    } else {
        "report"
    }
}

/// The format with this id.
pub fn format(id: &str) -> Option<&'static Format> {
    FORMATS.iter().find(|format| format.id == id)
}

fn joined(reports: &[Report], render: fn(&Report) -> String) -> String {
    let texts: Vec<String> = reports.iter().map(render).collect();
    texts.join("\n")
}
