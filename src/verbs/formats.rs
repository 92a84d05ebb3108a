//! The formats a report is written in, one row each, and its figures.

use super::{Body, Report, check, cost, rest, run, stability};
use crate::report::json::{self, Tool};
use crate::report::page::{self, Article};
use crate::report::svg::{Chart, Figure};
use crate::report::words::one_line;
use crate::report::{Note, View, github, junit, names, terminal, verdict};
use crate::scene;
use schemars::{JsonSchema, Schema};
use serde::Serialize;
use std::borrow::Cow;

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
        render: |_, reports| {
            let texts = reports.iter().map(|report| report.human(terminal::WIDTH));
            together(reports, texts, terminal::WIDTH)
        },
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
        render: |_, reports| {
            reports
                .iter()
                .map(Report::markdown)
                .collect::<Vec<_>>()
                .join("\n")
        },
    },
    Format {
        id: "html",
        extension: "html",
        file: true,
        render: page,
    },
    Format {
        id: "junit",
        extension: "xml",
        file: false,
        render: |_, reports| junit::render(named(reports).iter().map(|report| &report.header)),
    },
    Format {
        id: "github",
        extension: "txt",
        file: false,
        render: |_, reports| {
            github::render(
                named(reports).iter().map(|report| &report.header),
                &scene::place_in,
            )
        },
    },
];

/// The page of these reports, which has everything in it.
pub fn page(tool: &Tool, reports: &[Report]) -> String {
    let articles: Vec<Article> = reports.iter().map(article).collect();
    page::render(tool, &articles)
}

/// A report on a page.
fn article(report: &Report) -> Article {
    Article {
        title: report.header.scene.name.clone(),
        part: report.title(),
        markdown: report.markdown(),
        figures: report.drawn(Chart::draw_linked),
        engines: run::rows(report),
        motion: run::shown(report),
    }
}

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
        let shown = report.named();
        let view = shown.view();
        InWords {
            report,
            verdict: verdict::verdict(&view),
            remarks: view.notes,
        }
    }
    reports.iter().map(one).collect()
}

/// The reports as people read them.
fn named(reports: &[Report]) -> Vec<Cow<'_, Report>> {
    reports.iter().map(Report::named).collect()
}

/// The JSON Schema of the format `json`.
pub fn schema() -> Schema {
    json::schema::<InWords>()
}

/// The format with this id.
pub fn format(id: &str) -> Option<&'static Format> {
    FORMATS.iter().find(|format| format.id == id)
}

/// The `texts` of the reports for people, one after the other, and what closes them. The gate's make one list.
pub fn together(reports: &[Report], texts: impl Iterator<Item = String>, columns: usize) -> String {
    let between = if is_gate(reports) { "" } else { "\n" };
    let texts: Vec<String> = texts.collect();
    texts.join(between) + &closing(reports, columns)
}

/// The end of the text of several reports: the gate's says how many scenes passed, also where there is one; that of
/// others begins with an empty line and repeats the line of each.
pub fn closing(reports: &[Report], columns: usize) -> String {
    if is_gate(reports) {
        return format!("{}\n", check::closing(reports));
    }
    let lines = reports.iter().map(|report| report.line(columns) + "\n");
    match reports.len() {
        0 | 1 => String::new(),
        _ => format!("\n{}", lines.collect::<String>()),
    }
}

/// Whether the gate made all these reports.
pub fn is_gate(reports: &[Report]) -> bool {
    let made = |report: &Report| matches!(report.body, Body::Check { .. });
    !reports.is_empty() && reports.iter().all(made)
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
            Body::Rest { .. } => "rest",
        }
    }

    /// What was done with the scene, as a title.
    pub fn title(&self) -> &'static str {
        match &self.body {
            Body::Run { .. } => "Run",
            Body::Compare { .. } => "Comparison",
            Body::Check { .. } => "Check",
            Body::Stability { .. } => "Stability",
            Body::Cost { .. } => "Cost",
            Body::Rest { .. } => "Rest",
        }
    }

    /// The report as people read it: its sentences say the names of particles that have one, where the data have ids.
    pub fn named(&self) -> Cow<'_, Self> {
        let objects = &self.header.scene.objects;
        let named = || {
            Some(Self {
                header: names::in_sentences(&self.header, objects)?,
                body: names::in_sentences(&self.body, objects)?,
                series: self.series.clone(),
            })
        };
        let named = if objects.is_empty() { None } else { named() };
        named.map_or(Cow::Borrowed(self), Cow::Owned)
    }

    /// The parts that the terminal and the page show, as the verb words them, for a terminal of the usual width. Its
    /// sentences are those of the report: [`named`](Self::named) comes before.
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
            Body::Rest { rest, .. } => rest::view(self, rest, columns),
        }
    }

    /// The text for people, for a terminal of so many columns.
    pub fn human(&self, columns: usize) -> String {
        let shown = self.named();
        match &shown.body {
            Body::Check { .. } => check::human(&shown, columns),
            _ => terminal::render(shown.view_in(columns)),
        }
    }

    /// The scene and its verdict on one line, where the verdict has forms that are short enough of so many columns.
    pub fn line(&self, columns: usize) -> String {
        if let Body::Check { .. } = &self.body {
            let text = self.human(columns);
            return text.lines().next().unwrap_or_default().to_owned();
        }
        let name = one_line(&self.header.scene.file);
        let room = columns.saturating_sub(terminal::width(&name) + ": ".len());
        format!(
            "{name}: {}",
            verdict::within(&self.named().view_in(columns), room)
        )
    }

    /// The whole page. It links its figures, which are files beside it.
    pub fn markdown(&self) -> String {
        let shown = self.named();
        let view = shown.view();
        match &shown.body {
            Body::Run { .. } | Body::Check { .. } | Body::Compare { .. } => {
                run::page(&shown, &view)
            }
            Body::Stability { stability, .. } => stability::page(&shown, stability, &view),
            Body::Cost { cost, .. } => cost::page(&shown, cost, &view),
            Body::Rest { rest, .. } => rest::page(&shown, rest, &view),
        }
    }

    /// The figures it has data for, in the order they are shown: file name, title, chart.
    fn charts(&self) -> impl Iterator<Item = (&'static str, &'static str, Chart)> {
        let figures: &[Figure<Report>] = match &self.body {
            Body::Run { .. } | Body::Check { .. } | Body::Compare { .. } => run::FIGURES,
            Body::Stability { .. } => stability::FIGURES,
            Body::Cost { .. } => cost::FIGURES,
            Body::Rest { .. } => rest::FIGURES,
        };
        let chart = |(file, title, chart): &Figure<Report>| Some((*file, *title, chart(self)?));
        figures.iter().filter_map(chart)
    }

    /// The figures as files: name and SVG.
    pub fn svg(&self) -> Vec<(&'static str, String)> {
        self.drawn(Chart::draw)
    }

    fn drawn(&self, draw: fn(Chart) -> String) -> Vec<(&'static str, String)> {
        let drawn = self.charts().map(|(file, _, chart)| (file, draw(chart)));
        drawn.collect()
    }

    /// The page's links to the figures' files.
    pub fn images(&self) -> String {
        let link = |(file, title, _)| format!("![{title}]({file})\n\n");
        self.charts().map(link).collect()
    }
}
