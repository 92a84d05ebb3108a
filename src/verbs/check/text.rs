//! The gate for people: a line a scene, and details only of what needs them.

use super::{Verdict, laws, verdict};
use crate::integrators;
use crate::measure::{Check, CheckStatus};
use crate::report::terminal::{Tone, mark, paint, wrap};
use crate::report::words::{one_line, plural, short};
use crate::verbs::{Report, run};

/// A line for the scene, and below it what failed, what is open, what is skipped though somebody asked for it, and what
/// other programs were found to be, in so many columns.
pub fn human(report: &Report, columns: usize) -> String {
    let checks = &report.header.checks;
    let count = |status| checks.iter().filter(|c| c.status == status).count() as u64;
    let (tone, word) = match verdict(report) {
        Verdict::Passed => (Tone::Good, "pass"),
        Verdict::Failed => (Tone::Bad, "FAIL"),
        Verdict::Inconclusive => (Tone::Warn, "open"),
        Verdict::Skipped => (Tone::Dim, "skip"),
    };
    let made =
        count(CheckStatus::Pass) + count(CheckStatus::Fail) + count(CheckStatus::Inconclusive);
    let wrong = count(CheckStatus::Fail);
    let mut facts = if wrong > 0 {
        format!("{wrong} of {} failed", plural(made, "check"))
    } else {
        plural(made, "check")
    };
    let asked = checks
        .iter()
        .filter(|c| c.status == CheckStatus::Skip && is_asked(c));
    match asked.count() {
        0 => {}
        skipped => facts += &format!(", {skipped} skipped"),
    }
    let mut lines = vec![format!(
        "{}  {}  {facts}",
        mark(tone, word),
        one_line(&report.header.scene.file)
    )];
    let told = |check: &&Check| match check.status {
        CheckStatus::Fail | CheckStatus::Inconclusive => true,
        CheckStatus::Skip => is_asked(check),
        CheckStatus::Pass => is_claim(check),
    };
    let told: Vec<&Check> = checks.iter().filter(told).collect();
    for group in told.chunk_by(|a, b| a.id == b.id && a.derivation == b.derivation) {
        lines.extend(details(group, columns));
    }
    paint(&(lines.join("\n") + "\n"))
}

/// Whether the scene's file or the command line asked for what is skipped.
fn is_asked(check: &Check) -> bool {
    let key = check.key.as_deref();
    let by_file = key.is_some_and(|key| key.starts_with("expect.skip."));
    by_file || check.id == run::expect::ID || is_claim(check)
}

/// Whether it says what another program is.
fn is_claim(check: &Check) -> bool {
    let of_claims = [laws::SCHEME.id, laws::CLAIMED_ORDER.id].contains(&check.id.as_str());
    of_claims && integrators::find(&check.subject).is_none()
}

/// What was measured of each subject, when it broke, and why; then the bound that they share, where it comes from,
/// and what to do.
fn details(group: &[&Check], columns: usize) -> Vec<String> {
    let mut lines = Vec::new();
    let wrong =
        |check: &&&Check| [CheckStatus::Fail, CheckStatus::Inconclusive].contains(&check.status);
    for check in group {
        let word = match check.status {
            CheckStatus::Inconclusive => "not decided: ",
            CheckStatus::Skip => "skipped: ",
            CheckStatus::Fail | CheckStatus::Pass => "",
        };
        let head = format!(
            "      {word}{} {}: ",
            one_line(&check.id),
            one_line(&check.subject)
        );
        let said = one_line(&check.message);
        let own = format!("{}: ", check.subject);
        let said = said.strip_prefix(&own).unwrap_or(&said).to_owned();
        let first = check
            .first_s
            .map(|t| format!(", first at t = {} s", short(t)));
        let text = head + &said + &first.unwrap_or_default();
        lines.extend(wrap(&text, columns, "        "));
        if let Some(cause) = check.cause.as_ref().filter(|_| wrong(&check)) {
            let text = format!("        likely: {}", one_line(cause));
            lines.extend(wrap(&text, columns, "          "));
        }
    }
    let Some(check) = group.iter().find(wrong) else {
        return lines;
    };
    let bound = format!("the bound: {}", one_line(&check.derivation));
    let todo = laws::find(&check.id).map(|row| format!("what to do: {}", one_line(row.remedy)));
    for text in [Some(bound), todo].into_iter().flatten() {
        lines.extend(wrap(&format!("        {text}"), columns, "          "));
    }
    lines
}

/// The closing line: `57 scenes: 56 passed, 1 failed, 0 skipped`.
pub fn closing(reports: &[Report]) -> String {
    let count = |wanted| reports.iter().filter(|r| verdict(r) == wanted).count();
    let open = count(Verdict::Inconclusive);
    let open = if open > 0 {
        format!(", {open} inconclusive")
    } else {
        String::new()
    };
    format!(
        "{}: {} passed, {} failed, {} skipped{open}",
        plural(reports.len() as u64, "scene"),
        count(Verdict::Passed),
        count(Verdict::Failed),
        count(Verdict::Skipped),
    )
}
