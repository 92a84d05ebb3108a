//! Checks as JUnit XML: one suite a scene, one case a check.

use super::Header;
use super::words::in_xml;
use crate::measure::{Check, CheckStatus};
use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};

/// The XML of these reports' checks. It has no times, so that two runs give the same bytes.
pub fn render<'a>(headers: impl Iterator<Item = &'a Header>) -> String {
    let mut report = Report::new("springcheck");
    for header in headers {
        let mut suite = TestSuite::new(in_xml(&header.scene.file));
        suite.add_test_cases(
            header
                .checks
                .iter()
                .map(|check| case(check, &header.scene.file)),
        );
        report.add_test_suite(suite);
    }
    let mut text = report.to_string().unwrap_or_default();
    if !text.ends_with('\n') {
        text.push('\n');
    }
    text
}

fn case(check: &Check, file: &str) -> TestCase {
    let mut status = match check.status {
        CheckStatus::Pass => TestCaseStatus::success(),
        CheckStatus::Fail => TestCaseStatus::non_success(NonSuccessKind::Failure),
        CheckStatus::Inconclusive => TestCaseStatus::non_success(NonSuccessKind::Error),
        CheckStatus::Skip => TestCaseStatus::skipped(),
    };
    if check.status != CheckStatus::Pass {
        status.set_message(in_xml(&check.message));
        let mut text = format!("{}\nthe bound: {}", check.message, check.derivation);
        if let Some(first) = check.first_s {
            text += &format!("\nfirst at t = {first} s");
        }
        if let Some(cause) = &check.cause {
            text += &format!("\nlikely: {cause}");
        }
        status.set_description(in_xml(&text));
    }
    let name = format!("{} {}", check.id, check.subject);
    let mut case = TestCase::new(in_xml(name.trim_end()), status);
    case.set_classname(in_xml(file));
    case
}
