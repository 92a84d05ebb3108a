//! The terminal's report: what ran, what holds of the whole scene, the verb's own part, what is notable
//! about single engines, and whether the harness proved itself. No line exceeds [`WIDTH`] columns.

pub(in crate::report) mod columns;
pub(in crate::report) mod fit;
pub(in crate::report) mod paint;

use super::notes::Note;
use super::{verdict, view, words};
use crate::outcome::{Check, CheckStatus, Report};
use fit::{clip, pad, width, wrap};
use paint::{Tone, mark, paint};

/// Visible columns no line exceeds.
pub const WIDTH: usize = 100;

/// The report with ANSI colours, which the caller's stream strips where they are not wanted. Ends
/// with the verdict and a newline.
pub fn render(report: &Report) -> String {
    let view = view(report);
    let mut lines = scene(report);
    let facts = view.facts(report).into_iter();
    let facts = facts.map(|(label, text)| (label, words::one_line(&text)));
    lines.extend(labelled(facts.collect()));
    lines.extend(view.lines(report));
    lines.extend(apart(notes(&view.notes(report))));
    lines.extend(apart(checks(&report.header.checks)));
    lines.extend(apart(labelled(view.last(report))));
    lines.push(String::new());
    let verdict = wrap(&verdict::within(report, WIDTH), WIDTH, "");
    lines.extend(verdict.iter().map(|line| mark(Tone::Strong, line)));
    let mut text = paint(&lines.join("\n"));
    text.push('\n');
    text
}

/// The lines below an empty one, if there are any.
fn apart(mut lines: Vec<String>) -> Vec<String> {
    if !lines.is_empty() {
        lines.insert(0, String::new());
    }
    lines
}

/// Its name and size, and what its file says of it.
fn scene(report: &Report) -> Vec<String> {
    let scene = &report.header.scene;
    let facts = format!(
        "  {}, {}, {} s at h = {}, {}",
        words::plural(scene.particles, "particle"),
        words::plural(scene.springs, "spring"),
        words::short(scene.duration),
        words::timestep(report),
        clip(&words::one_line(&scene.own_integrator), 28),
    );
    let room = WIDTH.saturating_sub(width(&facts)).max(12);
    let name = clip(&words::one_line(&scene.name), room);
    let mut lines = wrap(&(mark(Tone::Strong, &name) + &facts), WIDTH, "");
    if let Some(description) = &scene.description {
        lines.extend(wrap(&words::one_line(description), WIDTH, ""));
    }
    lines
}

/// Texts beside their labels.
fn labelled(facts: Vec<(&str, String)>) -> Vec<String> {
    let line = |(label, text)| wrap(&format!("{label:<9}{text}"), WIDTH, "         ");
    facts.into_iter().flat_map(line).collect()
}

fn notes(notes: &[Note]) -> Vec<String> {
    let note = |Note { subject, sentence }: &Note| {
        let text = if sentence.starts_with(subject.as_str()) {
            sentence.clone()
        } else {
            format!("{subject}: {sentence}")
        };
        wrap(&format!("- {text}"), WIDTH, "  ")
    };
    notes.iter().flat_map(note).collect()
}

fn checks(checks: &[Check]) -> Vec<String> {
    let ids = checks.iter().map(|c| width(&words::one_line(&c.id))).max();
    let ids = ids.unwrap_or(0).min(24);
    let mut groups: Vec<Vec<&Check>> = Vec::new();
    for check in checks {
        let alike = |group: &&mut Vec<&Check>| {
            let first = group[0];
            let pass = check.status == CheckStatus::Pass;
            first.id == check.id
                && first.status == check.status
                && (pass || reason(first) == reason(check))
        };
        match groups.iter_mut().find(alike) {
            Some(group) => group.push(check),
            None => groups.push(vec![check]),
        }
    }
    let mut lines = Vec::new();
    for group in &groups {
        match group.as_slice() {
            met if is_met(met[0]) => lines.extend(counted(met, ids)),
            [check] => lines.extend(alone(check, ids)),
            several => lines.extend(together(several, ids)),
        }
    }
    lines
}

/// An expectation of the scene that is met.
fn is_met(check: &Check) -> bool {
    check.id == "expect" && check.status == CheckStatus::Pass
}

/// How many of each engine's keys are as expected: `symplectic_euler 3, explicit_euler 1`.
fn counted(checks: &[&Check], ids: usize) -> Vec<String> {
    let mut counts: Vec<(&str, usize)> = Vec::new();
    for check in checks {
        let engine = check.subject.split(' ').next().unwrap_or_default();
        match counts.iter_mut().find(|(known, _)| *known == engine) {
            Some((_, count)) => *count += 1,
            None => counts.push((engine, 1)),
        }
    }
    let texts: Vec<String> = counts
        .iter()
        .map(|(engine, count)| format!("{} {count}", words::one_line(engine)))
        .collect();
    let line = format!("{}  {}", head(checks[0], ids), texts.join(", "));
    wrap(&line, WIDTH, &" ".repeat(8 + ids))
}

/// What a check says, without whom it is about.
fn reason(check: &Check) -> &str {
    let said = check.message.strip_prefix(check.subject.as_str());
    said.and_then(|said| said.strip_prefix(": "))
        .unwrap_or(&check.message)
}

/// `pass  order`
fn head(check: &Check, ids: usize) -> String {
    let (tone, word) = match check.status {
        CheckStatus::Pass => (Tone::Good, "pass"),
        CheckStatus::Fail => (Tone::Bad, "FAIL"),
        CheckStatus::Skip => (Tone::Dim, "skip"),
        CheckStatus::Inconclusive => (Tone::Warn, "open"),
    };
    let id = pad(&clip(&words::one_line(&check.id), ids), ids);
    format!("{}  {id}", mark(tone, word))
}

fn alone(check: &Check, ids: usize) -> Vec<String> {
    let measured = words::measured(check);
    let room = WIDTH - 4 - ids - width(&measured) - 6;
    let subject = clip(&words::one_line(&check.subject), room);
    let mut lines = vec![format!("{}  {subject}  {measured}", head(check, ids))];
    if check.status != CheckStatus::Pass && !check.message.is_empty() {
        let message = format!("      {}", words::one_line(&check.message));
        lines.extend(wrap(&message, WIDTH, "      "));
    }
    lines
}

/// Several with the same result: whom it is about, what was measured, and what there is to say.
fn together(checks: &[&Check], ids: usize) -> Vec<String> {
    let first = checks[0];
    let texts: Vec<String> = checks
        .iter()
        .map(|check| {
            let measured = check.measured.map(words::quantity).unwrap_or_default();
            let text = format!("{} {measured}", words::one_line(&check.subject));
            text.trim_end().to_owned()
        })
        .collect();
    let line = format!("{}  {}", head(first, ids), texts.join(", "));
    let mut lines = wrap(&line, WIDTH, &" ".repeat(8 + ids));
    if first.status != CheckStatus::Pass {
        let message = format!("      {}", words::one_line(reason(first)));
        lines.extend(wrap(&message, WIDTH, "      "));
    }
    lines
}
