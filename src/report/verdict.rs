//! The one sentence that says the most important thing.

use super::notes::listed;
use super::{Shown, words};
use crate::measure::{Check, CheckStatus};

/// A part of the sentence: the same said at length, shorter, and so on. The last may be empty.
pub type Clause = Vec<String>;

/// Failed checks first, then what the verb has to say, the scene's own integrator leading. One
/// sentence, one line.
pub fn verdict<R: Shown>(report: &R) -> String {
    sentence(&clauses(report), &[])
}

/// The same in at most `columns` characters where that can be done: the least important groups are
/// counted instead of named, then left out.
pub fn within<R: Shown>(report: &R, columns: usize) -> String {
    let clauses = clauses(report);
    let mut forms = vec![0; clauses.len()];
    loop {
        let text = sentence(&clauses, &forms);
        let shorter = |i: &usize| forms[*i] + 1 < clauses[*i].len();
        match (0..clauses.len()).rev().find(shorter) {
            Some(i) if text.chars().count() > columns => forms[i] += 1,
            _ => return text,
        }
    }
}

fn clauses<R: Shown>(report: &R) -> Vec<Clause> {
    let failed = failed_checks(&report.header().checks);
    let mut clauses: Vec<Clause> = failed.into_iter().map(|text| vec![text]).collect();
    clauses.extend(report.view().clauses(report));
    clauses
}

/// The clauses, each in the form asked for (the longest if none is), and a full stop.
fn sentence(clauses: &[Clause], forms: &[usize]) -> String {
    let form = |i: usize| forms.get(i).copied().unwrap_or(0);
    let texts = clauses
        .iter()
        .enumerate()
        .filter_map(|(i, c)| c.get(form(i)));
    let texts: Vec<&str> = texts
        .map(String::as_str)
        .filter(|text| !text.is_empty())
        .collect();
    match texts.as_slice() {
        [] => "nothing ran.".into(),
        texts => texts.join("; ") + ".",
    }
}

/// The checks that prove rapier's world and the hand-written system are the same scene.
pub fn is_twin(check: &Check) -> bool {
    check.id.starts_with("twin")
}

fn failed_checks(checks: &[Check]) -> Option<String> {
    let failed = |twin: bool| -> Vec<String> {
        checks
            .iter()
            .filter(|c| c.status == CheckStatus::Fail && is_twin(c) == twin)
            .map(|c| {
                format!(
                    "{} ({})",
                    words::one_line(&c.id),
                    words::one_line(&c.subject)
                )
            })
            .collect()
    };
    let (twins, others) = (failed(true), failed(false));
    let mut clauses = Vec::new();
    if !twins.is_empty() {
        clauses.push(format!(
            "THE TWIN PROOF FAILS, so trust no comparison: {}",
            listed(&twins)
        ));
    }
    if !others.is_empty() {
        clauses.push(format!("failed: {}", listed(&others)));
    }
    (!clauses.is_empty()).then(|| clauses.join("; "))
}
