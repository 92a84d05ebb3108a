//! The terminal's report: what ran, a table of outcomes that fits [`WIDTH`] columns, what is
//! notable about them, and whether the harness proved itself.

pub(in crate::report) mod columns;
pub(in crate::report) mod fit;
pub(in crate::report) mod paint;
mod table;

use super::cost;
use super::identity;
use super::notes::notes;
use super::stability;
use super::verdict;
use super::words;
use crate::outcome::{Check, CheckStatus, EffectUse, Report};
use fit::{clip, pad, width, wrap};
use paint::{Tone, mark, paint};

/// Visible columns no line exceeds.
pub const WIDTH: usize = 100;

/// The report with ANSI colours, which the caller's stream strips where they are not wanted. Ends
/// with the verdict and a newline.
pub fn render(report: &Report) -> String {
    if stability::is_alone(report) {
        return stability::terminal::render(report);
    }
    if cost::is_alone(report) {
        return cost::terminal::render(report);
    }
    let mut lines = scene(report);
    let truth = words::one_line(&words::truth(&report.truth));
    lines.extend(wrap(&format!("truth    {truth}"), WIDTH, "         "));
    if report.fault.is_none() {
        lines.extend(ledger(&report.scene.effects));
    }
    lines.push(String::new());
    lines.extend(table::table(report));
    lines.extend(remarks(report));
    lines.extend(checks(&report.checks));
    lines.extend(fault(report));
    finished(report, lines)
}

/// The lines and the verdict, painted.
pub(in crate::report) fn finished(report: &Report, mut lines: Vec<String>) -> String {
    lines.push(String::new());
    let verdict = wrap(&verdict::within(report, WIDTH), WIDTH, "");
    lines.extend(verdict.iter().map(|line| mark(Tone::Strong, line)));
    let mut text = paint(&lines.join("\n"));
    text.push('\n');
    text
}

/// Its name and size, and what its file says of it.
pub(in crate::report) fn scene(report: &Report) -> Vec<String> {
    let scene = &report.scene;
    let facts = format!(
        "  {}, {}, {} s at h = {}, {}",
        words::plural(scene.particles, "particle"),
        words::plural(scene.springs, "spring"),
        words::short(scene.duration),
        words::timestep(report),
        clip(&words::one_line(&scene.own_method), 28),
    );
    let room = WIDTH.saturating_sub(width(&facts)).max(12);
    let name = clip(&words::one_line(&scene.name), room);
    let mut lines = wrap(&(mark(Tone::Strong, &name) + &facts), WIDTH, "");
    if let Some(description) = &scene.description {
        lines.extend(wrap(&words::one_line(description), WIDTH, ""));
    }
    lines
}

/// One line an effect: whom it acts on, how often it ran, what one evaluation costs.
fn ledger(effects: &[EffectUse]) -> Vec<String> {
    let longest = effects
        .iter()
        .map(|e| width(e.id))
        .max()
        .unwrap_or(0)
        .min(24);
    let lines = effects.iter().enumerate().map(|(i, effect)| {
        let label = if i == 0 { "effects" } else { "" };
        let id = pad(&clip(effect.id, longest), longest);
        let on = format!("on {}", words::count(effect.members as u64));
        let evaluations = words::count(effect.evaluations);
        let cost = effect
            .nanoseconds
            .map(|ns| format!(", {} each", words::seconds(ns * 1e-9)))
            .unwrap_or_default();
        format!("{label:<7}  {id}  {on:<8}  {evaluations} evaluations{cost}")
    });
    lines.collect()
}

fn remarks(report: &Report) -> Vec<String> {
    let mut lines = Vec::new();
    for note in notes(report) {
        let text = if note.sentence.starts_with(&note.subject) {
            note.sentence
        } else {
            format!("{}: {}", note.subject, note.sentence)
        };
        lines.extend(wrap(&format!("- {text}"), WIDTH, "  "));
    }
    if !lines.is_empty() {
        lines.insert(0, String::new());
    }
    lines
}

fn fault(report: &Report) -> Vec<String> {
    let mut lines = Vec::new();
    for (at, line) in identity::fault(report).iter().enumerate() {
        let label = if at == 0 { "fault    " } else { "         " };
        lines.extend(wrap(&format!("{label}{line}"), WIDTH, "         "));
    }
    if !lines.is_empty() {
        lines.insert(0, String::new());
    }
    lines
}

pub(in crate::report) fn checks(checks: &[Check]) -> Vec<String> {
    if checks.is_empty() {
        return Vec::new();
    }
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
    let mut lines = vec![String::new()];
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
