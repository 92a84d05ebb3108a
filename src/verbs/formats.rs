//! The formats a report is written in, one row each, and its figures.

use super::{Body, Report, check, cost, run, stability};
use crate::report::json::{self, Tool};
use crate::report::svg::{Chart, Figure};
use crate::report::{View, github, junit, terminal};
use crate::scene;

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
        render: |_, reports| joined(reports, Report::human),
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

    /// The parts that the terminal and the page show, as the verb words them.
    pub fn view(&self) -> View<'_> {
        match &self.body {
            Body::Run { outcomes } | Body::Check { outcomes } | Body::Compare { outcomes, .. } => {
                run::view(self, outcomes)
            }
            Body::Stability { stability, .. } => stability::view(self, stability),
            Body::Cost { cost, .. } => cost::view(self, cost),
        }
    }

    /// The text for people, as the terminal shows it.
    pub fn human(&self) -> String {
        match &self.body {
            Body::Check { .. } => check::human(self),
            _ => terminal::render(self.view()),
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
