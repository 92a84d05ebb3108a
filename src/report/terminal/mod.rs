//! The terminal's report: what ran, what holds of the whole scene, the verb's own part, what is notable
//! about single engines, and whether the harness proved itself. No line exceeds [`WIDTH`] columns.

pub mod columns;
pub mod fit;
pub mod paint;

use super::notes::{Note, grouped};
use super::{Shown, verdict, words};
use crate::measure::{Check, CheckStatus};
use fit::{clip, pad, width, wrap};
use paint::{Tone, mark, paint};

/// Visible columns no line exceeds.
pub const WIDTH: usize = 100;

/// The report with ANSI colours, which the caller's stream strips where they are not wanted. Ends
/// with the verdict and a newline.
pub fn render<R: Shown>(report: &R) -> String {
    let view = report.view();
    let mut lines = scene(report);
    let facts = view.facts(report).into_iter();
    let facts = facts.map(|(label, text)| (label, words::one_line(&text)));
    lines.extend(labelled(facts.collect()));
    lines.extend(view.lines(report));
    lines.extend(apart(notes(&view.notes(report))));
    lines.extend(apart(checks(&report.header().checks)));
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
fn scene<R: Shown>(report: &R) -> Vec<String> {
    let scene = &report.header().scene;
    let facts = format!(
        "  {}, {}, {} s at h = {}, {}",
        words::plural(scene.particles, "particle"),
        words::plural(scene.springs, "spring"),
        words::short(scene.duration),
        words::timestep(scene.timestep, &report.view().timesteps()),
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
    let groups = grouped(checks.iter().map(|check| {
        let why = (check.status != CheckStatus::Pass).then(|| reason(check));
        (check, (&check.id, check.status, why))
    }));
    let lines = groups.iter().flat_map(|((id, _, why), group)| {
        let head = head(group[0], ids);
        let mut lines = match group.as_slice() {
            // An expectation that is met.
            met if *id == "expect" && why.is_none() => together(&head, counted(met), ids),
            [check] => alone(&head, check, ids),
            several => together(&head, several.iter().map(measured), ids),
        };
        let message = match group.as_slice() {
            [check] => why.map(|_| check.message.as_str()),
            _ => *why,
        };
        if let Some(message) = message.filter(|message| !message.is_empty()) {
            let message = format!("      {}", words::one_line(message));
            lines.extend(wrap(&message, WIDTH, "      "));
        }
        lines
    });
    lines.collect()
}

/// How many of each engine's keys are as expected: `symplectic_euler 3`, `explicit_euler 1`.
fn counted(checks: &[&Check]) -> impl Iterator<Item = String> {
    let engine = |check: &&Check| check.subject.split(' ').next().map(words::one_line);
    let counts = grouped(checks.iter().map(|check| ((), engine(check)))).into_iter();
    counts.map(|(engine, keys)| format!("{} {}", engine.unwrap_or_default(), keys.len()))
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

/// What was measured beside its bound.
fn alone(head: &str, check: &Check, ids: usize) -> Vec<String> {
    let measured = words::measured(check);
    let room = WIDTH - 4 - ids - width(&measured) - 6;
    let subject = clip(&words::one_line(&check.subject), room);
    vec![format!("{head}  {subject}  {measured}")]
}

/// Of one check among several with the same result: whom it is about and what was measured.
fn measured(check: &&Check) -> String {
    let measured = check.measured.map(words::quantity).unwrap_or_default();
    let text = format!("{} {measured}", words::one_line(&check.subject));
    text.trim_end().to_owned()
}

/// Several texts after their head.
fn together(head: &str, texts: impl Iterator<Item = String>, ids: usize) -> Vec<String> {
    let texts: Vec<String> = texts.collect();
    let line = format!("{head}  {}", texts.join(", "));
    wrap(&line, WIDTH, &" ".repeat(8 + ids))
}
