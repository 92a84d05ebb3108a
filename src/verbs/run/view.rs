//! How outcomes are shown: which texts and figures stand where.

use super::text::*;
use crate::report::notes::{Note, notes};
use crate::report::svg::Figure;
use crate::report::verdict::Clause;
use crate::report::{View, words};
use crate::verbs::run::Outcome;
use crate::verbs::{Body, Report};

impl View<Report> for Vec<Outcome> {
    fn stem(&self) -> &'static str {
        "report"
    }

    fn timesteps(&self) -> Vec<f64> {
        self.iter().map(|outcome| outcome.timestep).collect()
    }

    fn figures(&self) -> &'static [Figure<Report>] {
        super::figures::FIGURES
    }

    fn clauses(&self, report: &Report) -> Vec<Clause> {
        verdict::clauses(report)
    }

    fn facts(&self, report: &Report) -> Vec<(&'static str, String)> {
        vec![("truth", words::truth(&report.header.truth))]
    }

    fn lines(&self, report: &Report) -> Vec<String> {
        let mut lines = Vec::new();
        // Of a comparison only what judging it evaluated would be counted.
        if let Body::Run { .. } = report.body {
            lines.extend(ledger::lines(&report.header.scene.effects));
        }
        lines.push(String::new());
        lines.extend(table::lines(report));
        lines
    }

    fn notes(&self, report: &Report) -> Vec<Note> {
        let said = self.iter().flat_map(|outcome| {
            let sentences = sentences(outcome).into_iter();
            sentences.map(move |sentence| (outcome, sentence))
        });
        notes(said, |outcomes| subjects(report, outcomes, usize::MAX))
    }

    fn last(&self, report: &Report) -> Vec<(&'static str, String)> {
        let lines = identity::fault(report).into_iter().enumerate();
        let label = |at: usize| if at == 0 { "fault" } else { "" };
        lines.map(|(at, line)| (label(at), line)).collect()
    }

    fn markdown(&self, report: &Report) -> String {
        markdown::render(report)
    }
}
