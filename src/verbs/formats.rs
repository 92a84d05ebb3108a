//! The formats a report is written in: one row each.

use super::Report;
use crate::report::json::{self, Tool};
use crate::report::{Shown, markdown, terminal};

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

/// What a report's files are called, without the dot and what follows.
pub fn stem(report: &Report) -> &'static str {
    report.view().stem()
}
