//! The report as GitHub shows it: what the pages of all verbs have.

use super::notes::Note;
use super::table::Table;
use super::{verdict, view, words};
use crate::outcome::{Check, CheckStatus, Report};
use words::NOTHING;

/// One report, with its figures linked as files beside it.
pub fn render(report: &Report) -> String {
    view(report).markdown(report)
}

/// Name, description and verdict.
pub(super) fn heading(report: &Report) -> String {
    let scene = &report.header.scene;
    let mut text = format!("# {}\n\n", escape(&scene.name));
    if let Some(description) = &scene.description {
        text += &format!("{}\n\n", escape(description));
    }
    text + &format!("**Verdict:** {}\n\n", escape(&verdict(report)))
}

/// The table of what the scene is, and `more` of it.
pub(super) fn scene(report: &Report, more: Vec<(&str, String)>) -> String {
    let scene = &report.header.scene;
    let mut rows = vec![
        ("file", scene.file.clone()),
        ("particles", scene.particles.to_string()),
        ("springs", scene.springs.to_string()),
        ("own integrator", scene.own_integrator.clone()),
    ];
    rows.extend(more);
    let rows = rows
        .iter()
        .map(|(label, text)| format!("| {label} | {} |\n", escape(text)));
    format!("| scene |  |\n|---|---|\n{}\n", rows.collect::<String>())
}

pub(super) fn images(report: &Report) -> String {
    super::svg::wanted(report)
        .map(|figure| format!("![{}]({})\n\n", figure.description, figure.file))
        .collect()
}

pub(super) fn remarks(notes: &[Note]) -> String {
    let line = |note: &Note| {
        let [subject, sentence] = [&note.subject, &note.sentence].map(|text| escape(text));
        format!("- **{subject}**: {sentence}\n")
    };
    section("Remarks", notes.iter().map(line).collect())
}

/// The text below its title; nothing where it is empty.
pub(super) fn section(title: &str, text: String) -> String {
    if text.is_empty() {
        return text;
    }
    format!("## {title}\n\n{text}\n")
}

pub(super) fn checks(checks: &[Check]) -> String {
    if checks.is_empty() {
        return String::new();
    }
    let number = |n: Option<f64>| n.map_or(NOTHING.into(), words::quantity);
    let mut table = Table::new(checks);
    table.markdown("check", |check| escape(&check.id));
    table.markdown("subject", |check| escape(&check.subject));
    table.markdown("status", |check| {
        let status = match check.status {
            CheckStatus::Pass => "pass",
            CheckStatus::Fail => "**fail**",
            CheckStatus::Skip => "skip",
            CheckStatus::Inconclusive => "inconclusive",
        };
        status.into()
    });
    table.markdown("measured", |check| number(check.measured));
    table.markdown("bound", |check| number(check.bound));
    table.markdown("bound from", |check| escape(&check.derivation));
    table.markdown("message", |check| escape(&check.message));
    format!("## Checks\n\n{}", table.in_markdown())
}

/// Text with nothing left that Markdown or HTML would read as its own, on one line.
pub(super) fn escape(text: &str) -> String {
    let text = words::one_line(text);
    let mut escaped = String::with_capacity(text.len());
    let mut before = ' ';
    let mut rest = text.chars().peekable();
    while let Some(c) = rest.next() {
        let after = rest.peek().copied().unwrap_or(' ');
        match c {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '\\' | '`' | '*' | '[' | ']' | '|' | '~' | '#' | '$' => escaped.extend(['\\', c]),
            // Inside a word an underscore is itself: ids stay legible in the source.
            '_' if !(before.is_alphanumeric() && after.is_alphanumeric()) => escaped += "\\_",
            '+' | '-' if escaped.is_empty() && after == ' ' => escaped.extend(['\\', c]),
            c => escaped.push(c),
        }
        before = c;
    }
    escaped
}
