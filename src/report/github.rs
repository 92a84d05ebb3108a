//! Checks as annotations that GitHub shows beside the scene's own line.

use super::Header;
use crate::measure::{Check, CheckStatus};

/// The most annotations of one kind that GitHub shows of a step.
const SHOWN: usize = 10;

/// The line and column, from 1, of a key of a scene's file.
pub type Place<'a> = &'a dyn Fn(&str, &str) -> Option<(u32, u32)>;

/// The worst annotations, a line each: what failed, those that are farthest beyond their bound first, then what is
/// open. `place` finds a key in a file.
pub fn render<'a>(headers: impl Iterator<Item = &'a Header>, place: Place) -> String {
    let told = told(headers);
    let shown = told.iter().take(SHOWN);
    let mut text: String = shown
        .map(|(header, check)| annotation(header, check, place))
        .collect();
    if told.len() > SHOWN {
        text += &format!(
            "::notice::{} more checks failed or are open\n",
            told.len() - SHOWN
        );
    }
    text
}

/// All of them as a table for the step's summary; empty where nothing failed and nothing is open.
pub fn summary<'a>(headers: impl Iterator<Item = &'a Header>) -> String {
    let told = told(headers);
    if told.is_empty() {
        return String::new();
    }
    let cell = |text: &str| super::words::escape(&super::words::one_line(text));
    let row = |(header, check): &(&Header, &Check)| {
        let found = match &check.cause {
            Some(cause) => format!("{}; likely: {cause}", check.message),
            None => check.message.clone(),
        };
        let [file, id, subject, message] =
            [&header.scene.file, &check.id, &check.subject, &found].map(|text| cell(text));
        format!("| {file} | {id} | {subject} | {message} |\n")
    };
    let rows: String = told.iter().map(row).collect();
    format!("| scene | check | of | what was found |\n|---|---|---|---|\n{rows}")
}

fn told<'a>(headers: impl Iterator<Item = &'a Header>) -> Vec<(&'a Header, &'a Check)> {
    let each = headers.flat_map(|header| header.checks.iter().map(move |check| (header, check)));
    let rank = |check: &Check| match check.status {
        CheckStatus::Fail => Some(0),
        CheckStatus::Inconclusive => Some(1),
        CheckStatus::Pass | CheckStatus::Skip => None,
    };
    let mut told: Vec<_> = each.filter(|(_, check)| rank(check).is_some()).collect();
    let beyond = |check: &Check| match (check.measured, check.bound) {
        (Some(found), Some(bound)) if bound != 0.0 => (found / bound).abs(),
        _ => f64::INFINITY,
    };
    told.sort_by(|(_, a), (_, b)| rank(a).cmp(&rank(b)).then(beyond(b).total_cmp(&beyond(a))));
    told
}

fn annotation(header: &Header, check: &Check, place: Place) -> String {
    let kind = match check.status {
        CheckStatus::Fail => "error",
        _ => "warning",
    };
    let file = &header.scene.file;
    let key = check.key.as_deref().unwrap_or("solver.type");
    let at = place(file, key).or_else(|| place(file, "solver"));
    let at = at.map_or_else(String::new, |(line, col)| format!(",line={line},col={col}"));
    let title = property(&format!("{} {}", check.id, check.subject));
    let mut message = format!("{} (the bound: {})", check.message, check.derivation);
    if let Some(first) = check.first_s {
        message += &format!("; first at t = {first} s");
    }
    if let Some(cause) = &check.cause {
        message += &format!("; likely: {cause}");
    }
    format!(
        "::{kind} file={}{at},title={title}::{}\n",
        property(file),
        data(&message)
    )
}

/// Escapes a message, as GitHub's workflow commands ask for.
fn data(text: &str) -> String {
    text.replace('%', "%25")
        .replace('\r', "%0D")
        .replace('\n', "%0A")
}

/// Escapes the value of a property.
fn property(text: &str) -> String {
    data(text).replace(':', "%3A").replace(',', "%2C")
}
