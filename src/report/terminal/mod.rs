//! The terminal's report: the scene, the verdict, the verb's own part, the first notes on single engines,
//! the checks of the harness, and facts about the scene. No line exceeds the columns of
//! the [`View`].

mod fit;
mod paint;

pub use fit::{clip, pad, width, wrap};
pub use paint::{Tone, mark, paint};

use super::words::{self, grouped, one_line};
use super::{Note, View, verdict};
use crate::measure::{Check, CheckStatus};

/// The most remarks the terminal shows.
const MAX_NOTES: usize = 5;

/// The columns of a line where there is no terminal that states its own.
pub const WIDTH: usize = 100;
/// The fewest columns that a report is laid out for.
pub const MIN_WIDTH: usize = 60;

/// The report with ANSI colours, which the caller's stream strips where they are not wanted: the
/// verdict below the scene's name, then the verb's own part. Ends with a newline.
pub fn render(view: View) -> String {
    let columns = view.columns;
    let verdict = wrap(&verdict::within(&view, columns), columns, "");
    let verdict = verdict.iter().map(|line| mark(Tone::Strong, line));
    let mut lines = scene(&view);
    lines.extend(after_blank_line(verdict.collect()));
    let table = view.lines.into_iter().skip_while(String::is_empty);
    lines.extend(after_blank_line(table.collect()));
    lines.extend(after_blank_line(notes(&view.notes, columns)));
    lines.extend(after_blank_line(checks(&view.header.checks, columns)));
    lines.extend(after_blank_line(labelled(view.last.into_iter(), columns)));
    let facts = view.facts.into_iter();
    let facts = facts.map(|(label, text)| (label, one_line(&text)));
    lines.extend(after_blank_line(labelled(facts, columns)));
    paint(&(lines.join("\n") + "\n"))
}

/// The lines after an empty one, if there are any.
fn after_blank_line(mut lines: Vec<String>) -> Vec<String> {
    if !lines.is_empty() {
        lines.insert(0, String::new());
    }
    lines
}

/// The scene's name and size, and the description in its file.
fn scene(view: &View) -> Vec<String> {
    let scene = &view.header.scene;
    let mut members = vec![
        words::plural(scene.particles as u64, "particle"),
        words::plural(scene.springs as u64, "spring"),
    ];
    if scene.rods > 0 {
        members.push(words::plural(scene.rods as u64, "rod"));
    }
    let facts = format!(
        "  {}, {} s at h = {}, {}",
        members.join(", "),
        words::short(scene.duration),
        words::timestep(scene.timestep, &view.timesteps),
        clip(&one_line(&scene.own_integrator), 28),
    );
    let room = view.columns.saturating_sub(width(&facts)).max(12);
    let name = clip(&one_line(&scene.name), room);
    let mut lines = wrap(&(mark(Tone::Strong, &name) + &facts), view.columns, "");
    if let Some(description) = &scene.description {
        lines.extend(wrap(&one_line(description), view.columns, ""));
    }
    lines
}

/// Lines of texts after their labels.
fn labelled<'a>(facts: impl Iterator<Item = (&'a str, String)>, columns: usize) -> Vec<String> {
    let line = |(label, text)| wrap(&format!("{label:<9}{text}"), columns, "         ");
    facts.flat_map(line).collect()
}

fn notes(notes: &[Note], columns: usize) -> Vec<String> {
    let note = |Note { subject, sentence }: &Note| {
        let text = if sentence.starts_with(subject.as_str()) {
            sentence.clone()
        } else {
            format!("{subject}: {sentence}")
        };
        wrap(&format!("- {text}"), columns, "  ")
    };
    let shown = notes.iter().take(MAX_NOTES);
    let more = notes.len().saturating_sub(MAX_NOTES) as u64;
    let more = (more > 0).then(|| {
        let more = words::plural(more, "more remark");
        format!("- {more} in the report, and with --format markdown")
    });
    shown.flat_map(note).chain(more).collect()
}

fn checks(checks: &[Check], columns: usize) -> Vec<String> {
    let ids = checks.iter().map(|c| width(&one_line(&c.id))).max();
    let ids = ids.unwrap_or(0).min(24);
    let groups = grouped(checks.iter().map(|check| {
        let why = (check.status != CheckStatus::Pass).then(|| reason(check));
        (check, (&check.id, check.status, why))
    }));
    let mut lines = Vec::new();
    for ((id, status, why), group) in groups {
        let (tone, word) = match status {
            CheckStatus::Pass => (Tone::Good, "pass"),
            CheckStatus::Fail => (Tone::Bad, "FAIL"),
            CheckStatus::Skip => (Tone::Dim, "skip"),
            CheckStatus::Inconclusive => (Tone::Warn, "open"),
        };
        let head = mark(tone, word) + "  " + &pad(&clip(&one_line(id), ids), ids);
        let wrapped = |texts: Vec<String>| {
            let line = format!("{head}  {}", texts.join(", "));
            wrap(&line, columns, &" ".repeat(8 + ids))
        };
        lines.extend(match group.as_slice() {
            // Expectations that are met are counted.
            met if id == "expect" && why.is_none() => wrapped(counted(met)),
            [check] => vec![format!(
                "{head}  {}",
                alone(check, columns.saturating_sub(10 + ids))
            )],
            several => wrapped(several.iter().map(|check| measured(check)).collect()),
        });
        let message = match group.as_slice() {
            [check] => why.map(|_| check.message.as_str()),
            _ => why,
        };
        if let Some(message) = message.filter(|message| !message.is_empty()) {
            let message = format!("      {}", one_line(message));
            lines.extend(wrap(&message, columns, "      "));
        }
    }
    lines
}

/// How many of each engine's keys are as expected: `symplectic_euler 3`, `explicit_euler 1`.
fn counted(checks: &[&Check]) -> Vec<String> {
    let engine = |check: &&Check| check.subject.split(' ').next().map(one_line);
    let counts = grouped(checks.iter().map(|check| ((), engine(check)))).into_iter();
    let count = |(engine, keys): (Option<String>, Vec<()>)| {
        format!("{} {}", engine.unwrap_or_default(), keys.len())
    };
    counts.map(count).collect()
}

/// A check's message, without its subject.
fn reason(check: &Check) -> &str {
    let said = check.message.strip_prefix(check.subject.as_str());
    said.and_then(|said| said.strip_prefix(": "))
        .unwrap_or(&check.message)
}

/// The subject of a check, its measured value and its bound, in at most `columns` and two spaces.
fn alone(check: &Check, columns: usize) -> String {
    let measured = words::measured(check);
    let subject = clip(
        &one_line(&check.subject),
        columns.saturating_sub(width(&measured)),
    );
    format!("{subject}  {measured}")
}

/// The subject and the measured value of one check among several with the same result.
fn measured(check: &Check) -> String {
    let measured = check.measured.map(words::quantity).unwrap_or_default();
    let text = format!("{} {measured}", one_line(&check.subject));
    text.trim_end().to_owned()
}
