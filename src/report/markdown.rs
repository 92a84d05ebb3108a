//! The report in GitHub's Markdown: the parts of a page that all verbs have.

use super::table::Table;
use super::verdict::verdict;
use super::words::{self, escape};
use super::{Note, View};
use crate::measure::{Check, CheckStatus};

/// The beginning of a page: name, description, verdict, and the table of facts about the scene with `more`
/// of them.
pub fn opening(view: &View, more: Vec<(&str, String)>) -> String {
    let scene = &view.header.scene;
    let mut text = format!("# {}\n\n", escape(&scene.name));
    if let Some(description) = &scene.description {
        text += &format!("{}\n\n", escape(description));
    }
    text += &format!("**Verdict:** {}\n\n", escape(&verdict(view)));
    let mut rows = vec![
        ("file", scene.file.clone()),
        ("particles", scene.particles.to_string()),
        ("springs", scene.springs.to_string()),
    ];
    if scene.rods > 0 {
        rows.push(("rods", scene.rods.to_string()));
    }
    rows.extend([("own integrator", scene.own_integrator.clone())]);
    rows.extend(more);
    let rows = rows
        .iter()
        .map(|(label, text)| format!("| {label} | {} |\n", escape(text)));
    text + &format!("| scene |  |\n|---|---|\n{}\n", rows.collect::<String>())
}

/// The remarks on single engines, and the checks of the harness.
pub fn findings(view: &View) -> String {
    let line = |Note { subject, sentence }: &Note| {
        format!("- **{}**: {}\n", escape(subject), escape(sentence))
    };
    let remarks = section("Remarks", view.notes.iter().map(line).collect());
    remarks + &section("Checks", checks(&view.header.checks))
}

/// The text below its title, or nothing where the text is empty.
pub fn section(title: &str, text: String) -> String {
    if text.is_empty() {
        return text;
    }
    format!("## {title}\n\n{text}\n")
}

fn checks(checks: &[Check]) -> String {
    if checks.is_empty() {
        return String::new();
    }
    let mut table = Table::new(checks);
    table.markdown("check", |check| escape(&check.id));
    table.markdown("subject", |check| escape(&check.subject));
    table.markdown("status", |check| match check.status {
        CheckStatus::Fail => "**fail**".to_owned(),
        status => words::id(status),
    });
    table.markdown("measured", |check| check.measured.map(words::quantity));
    table.markdown("bound", |check| check.bound.map(words::quantity));
    table.markdown("bound from", |check| escape(&check.derivation));
    table.markdown("message", |check| escape(&check.message));
    table.in_markdown()
}
