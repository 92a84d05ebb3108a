//! The report as GitHub shows it: what the pages of all verbs have.

use super::notes::Note;
use super::table::Table;
use super::verdict::verdict;
use super::{Shown, words};
use crate::measure::{Check, CheckStatus};
use words::{NOTHING, escape};

/// One report, with its figures linked as files beside it.
pub fn render<R: Shown>(report: &R) -> String {
    report.view().markdown(report)
}

/// Name, description and verdict.
pub fn heading<R: Shown>(report: &R) -> String {
    let scene = &report.header().scene;
    let mut text = format!("# {}\n\n", escape(&scene.name));
    if let Some(description) = &scene.description {
        text += &format!("{}\n\n", escape(description));
    }
    text + &format!("**Verdict:** {}\n\n", escape(&verdict(report)))
}

/// The table of what the scene is, and `more` of it.
pub fn scene<R: Shown>(report: &R, more: Vec<(&str, String)>) -> String {
    let scene = &report.header().scene;
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

pub fn images<R: Shown>(report: &R) -> String {
    super::svg::wanted(report)
        .map(|figure| format!("![{}]({})\n\n", figure.description, figure.file))
        .collect()
}

pub fn remarks(notes: &[Note]) -> String {
    let line = |note: &Note| {
        let [subject, sentence] = [&note.subject, &note.sentence].map(|text| escape(text));
        format!("- **{subject}**: {sentence}\n")
    };
    section("Remarks", notes.iter().map(line).collect())
}

/// The text below its title; nothing where it is empty.
pub fn section(title: &str, text: String) -> String {
    if text.is_empty() {
        return text;
    }
    format!("## {title}\n\n{text}\n")
}

pub fn checks(checks: &[Check]) -> String {
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
