//! How a report is written: the formats, one row each, and the figures.

use super::{Body, Report, cost, run, stability};
use crate::report::json::{self, Tool};
use crate::report::svg::{Chart, Figure};
use crate::report::{View, terminal};

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
        render: |_, reports| joined(reports, |report| terminal::render(report.view())),
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
    /// What its files are called, without the dot and what follows: verbs do not write over each
    /// other's.
    pub fn stem(&self) -> &'static str {
        match &self.body {
            Body::Run { .. } | Body::Compare { .. } => "report",
            Body::Stability { .. } => "stability",
            Body::Cost { .. } => "cost",
        }
    }

    /// What the verb has to say of it.
    pub fn view(&self) -> View<'_> {
        match &self.body {
            Body::Run { outcomes } | Body::Compare { outcomes, .. } => run::view(self, outcomes),
            Body::Stability { stability, .. } => stability::view(self, stability),
            Body::Cost { cost, .. } => cost::view(self, cost),
        }
    }

    /// The whole page, with its figures linked as files beside it.
    pub fn markdown(&self) -> String {
        let view = self.view();
        match &self.body {
            Body::Run { .. } | Body::Compare { .. } => run::page(self, &view),
            Body::Stability { stability, .. } => stability::page(self, stability, &view),
            Body::Cost { cost, .. } => cost::page(self, cost, &view),
        }
    }

    /// The figures it has data for, in the order they are shown.
    fn charts(&self) -> impl Iterator<Item = (&'static str, &'static str, Chart)> {
        let figures: &[Figure<Report>] = match &self.body {
            Body::Run { .. } | Body::Compare { .. } => run::FIGURES,
            Body::Stability { .. } => stability::FIGURES,
            Body::Cost { .. } => cost::FIGURES,
        };
        let chart = |(file, about, chart): &Figure<Report>| Some((*file, *about, chart(self)?));
        figures.iter().filter_map(chart)
    }

    /// Those figures as files: name and SVG.
    pub fn svg(&self) -> Vec<(&'static str, String)> {
        let drawn = self.charts().map(|(file, _, chart)| (file, chart.draw()));
        drawn.collect()
    }

    /// Links to those files, for the page.
    pub fn images(&self) -> String {
        let link = |(file, about, _)| format!("![{about}]({file})\n\n");
        self.charts().map(link).collect()
    }
}
