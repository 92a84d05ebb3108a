//! The one sentence that says the most important thing.

use super::View;
use super::words::{listed, one_line};
use crate::measure::{Check, CheckStatus};

/// A part of the sentence: the same said at length, shorter, and so on. The last may be empty.
pub type Clause = Vec<String>;

/// Failed checks first, then what the verb has to say, the scene's own integrator leading. One
/// sentence, one line.
pub fn verdict(view: &View) -> String {
    within(view, usize::MAX)
}

/// The same in at most `columns` characters where that can be done: the least important groups are
/// counted instead of named, then left out.
pub fn within(view: &View, columns: usize) -> String {
    let failed = failed_checks(&view.header.checks);
    let clauses: Vec<&Clause> = failed.iter().chain(&view.clauses).collect();
    let mut forms = vec![0; clauses.len()];
    loop {
        let texts = clauses
            .iter()
            .zip(&forms)
            .filter_map(|(c, form)| c.get(*form));
        let texts: Vec<&str> = texts
            .map(String::as_str)
            .filter(|t| !t.is_empty())
            .collect();
        let text = match texts.as_slice() {
            [] => "nothing ran.".into(),
            texts => texts.join("; ") + ".",
        };
        let shorter = |i: &usize| forms[*i] + 1 < clauses[*i].len();
        match (0..clauses.len()).rev().find(shorter) {
            Some(i) if text.chars().count() > columns => forms[i] += 1,
            _ => return text,
        }
    }
}

/// The checks that prove rapier's world and the hand-written system are the same scene.
pub fn is_twin(check: &Check) -> bool {
    check.id.starts_with("twin")
}

fn failed_checks(checks: &[Check]) -> Vec<Clause> {
    let said = |twin: bool, lead: &str| {
        let failed = |c: &&Check| c.status == CheckStatus::Fail && is_twin(c) == twin;
        let name = |c: &Check| format!("{} ({})", one_line(&c.id), one_line(&c.subject));
        let names: Vec<String> = checks.iter().filter(failed).map(name).collect();
        (!names.is_empty()).then(|| vec![format!("{lead}: {}", listed(&names))])
    };
    let twins = said(true, "THE TWIN PROOF FAILS, so trust no comparison");
    twins.into_iter().chain(said(false, "failed")).collect()
}
