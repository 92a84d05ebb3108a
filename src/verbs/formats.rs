//! The formats a report is written in, one row each, and its figures.

use super::{Body, Report, check, cost, run, stability};
use crate::report::json::{self, Tool};
use crate::report::svg::{Chart, Figure};
use crate::report::{Note, View, github, junit, terminal, verdict};
use crate::scene;
use schemars::{JsonSchema, Schema};
use serde::Serialize;

/// One format of reports.
pub struct Format {
    /// The name that `--format` takes.
    pub id: &'static str,
    /// The extension of its file, without the dot.
    pub extension: &'static str,
    /// Whether every run that writes files writes it, beside the figures.
    pub file: bool,
    /// Renders all the reports of one command, made by this program, as one text.
    pub render: fn(&Tool, &[Report]) -> String,
}

/// All formats.
pub const FORMATS: &[Format] = &[
    Format {
        id: "human",
        extension: "txt",
        file: false,
        render: |_, reports| joined(reports, |report| report.human(terminal::WIDTH)),
    },
    Format {
        id: "json",
        extension: "json",
        file: true,
        render: |tool, reports| json::render(tool, &in_words(reports)),
    },
    Format {
        id: "jsonl",
        extension: "jsonl",
        file: false,
        render: |tool, reports| {
            let words = in_words(reports);
            let line = |report| json::line(tool, std::slice::from_ref(report));
            words.iter().map(line).collect()
        },
    },
    Format {
        id: "markdown",
        extension: "md",
        file: true,
        render: |_, reports| joined(reports, Report::markdown),
    },
    Format {
        id: "junit",
        extension: "xml",
        file: false,
        render: |_, reports| junit::render(reports.iter().map(|report| &report.header)),
    },
    Format {
        id: "github",
        extension: "txt",
        file: false,
        render: |_, reports| {
            github::render(
                reports.iter().map(|report| &report.header),
                &scene::place_in,
            )
        },
    },
];

/// A report in JSON, with what the texts say beside the numbers. It reads back as the report alone.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "Report")]
struct InWords<'a> {
    #[serde(flatten)]
    report: &'a Report,
    /// The verdict in one sentence, as the terminal and the page begin with it.
    verdict: String,
    /// All remarks of the page, each with the engines it is about.
    remarks: Vec<Note>,
}

fn in_words(reports: &[Report]) -> Vec<InWords<'_>> {
    fn one(report: &Report) -> InWords<'_> {
        let view = report.view();
        InWords {
            report,
            verdict: verdict::verdict(&view),
            remarks: view.notes,
        }
    }
    reports.iter().map(one).collect()
}

/// The JSON Schema of the format `json`.
pub fn schema() -> Schema {
    json::schema::<InWords>()
}

/// The format with this id.
pub fn format(id: &str) -> Option<&'static Format> {
    FORMATS.iter().find(|format| format.id == id)
}

fn joined(reports: &[Report], render: fn(&Report) -> String) -> String {
    let texts: Vec<String> = reports.iter().map(render).collect();
    texts.join("\n")
}

impl Report {
    /// The name of its files without their extension. Verbs have different ones, so that they do not overwrite
    /// each other's files.
    pub fn stem(&self) -> &'static str {
        match &self.body {
            Body::Run { .. } | Body::Compare { .. } => "report",
            Body::Check { .. } => "check",
            Body::Stability { .. } => "stability",
            Body::Cost { .. } => "cost",
        }
    }

    /// The parts that the terminal and the page show, as the verb words them, for a terminal of the usual width.
    pub fn view(&self) -> View<'_> {
        self.view_in(terminal::WIDTH)
    }

    /// The same for a terminal of so many columns, at least [`terminal::MIN_WIDTH`].
    pub fn view_in(&self, columns: usize) -> View<'_> {
        let columns = columns.max(terminal::MIN_WIDTH);
        match &self.body {
            Body::Run { outcomes } | Body::Check { outcomes } | Body::Compare { outcomes, .. } => {
                run::view(self, outcomes, columns)
            }
            Body::Stability { stability, .. } => stability::view(self, stability, columns),
            Body::Cost { cost, .. } => cost::view(self, cost, columns),
        }
    }

    /// The text for people, for a terminal of so many columns.
    pub fn human(&self, columns: usize) -> String {
        match &self.body {
            Body::Check { .. } => check::human(self, columns),
            _ => terminal::render(self.view_in(columns)),
        }
    }

    /// The whole page. It links its figures, which are files beside it.
    pub fn markdown(&self) -> String {
        let view = self.view();
        match &self.body {
            Body::Run { .. } | Body::Check { .. } | Body::Compare { .. } => run::page(self, &view),
            Body::Stability { stability, .. } => stability::page(self, stability, &view),
            Body::Cost { cost, .. } => cost::page(self, cost, &view),
        }
    }

    /// The figures it has data for, in the order they are shown: file name, title, chart.
    fn charts(&self) -> impl Iterator<Item = (&'static str, &'static str, Chart)> {
        let figures: &[Figure<Report>] = match &self.body {
            Body::Run { .. } | Body::Check { .. } | Body::Compare { .. } => run::FIGURES,
            Body::Stability { .. } => stability::FIGURES,
            Body::Cost { .. } => cost::FIGURES,
        };
        let chart = |(file, title, chart): &Figure<Report>| Some((*file, *title, chart(self)?));
        figures.iter().filter_map(chart)
    }

    /// The figures as files: name and SVG.
    pub fn svg(&self) -> Vec<(&'static str, String)> {
        let drawn = self.charts().map(|(file, _, chart)| (file, chart.draw()));
        drawn.collect()
    }

    /// The page's links to the figures' files.
    pub fn images(&self) -> String {
        let link = |(file, title, _)| format!("![{title}]({file})\n\n");
        self.charts().map(link).collect()
    }
}
