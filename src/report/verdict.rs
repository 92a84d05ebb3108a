//! The verdict: one sentence with the most important findings.

use super::View;
use super::words::{listed, one_line};
use crate::measure::{Check, CheckStatus};

/// A part of the verdict in several forms, from the longest to the shortest. The last may be empty.
pub type Clause = Vec<String>;

/// The verdict on one line: failed checks first, then the verb's clauses, the scene's own integrator
/// first.
pub fn verdict(view: &View) -> String {
    within(view, usize::MAX)
}

/// The verdict in at most `columns` characters where that is possible: the least important clauses take
/// their shorter forms first.
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

/// Whether a check belongs to the twin proof: rapier's world and the hand-written system are one scene.
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
