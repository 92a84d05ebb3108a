//! How prices are shown: which texts and figures stand where.

use super::text::*;
use crate::report::View;
use crate::report::notes::Note;
use crate::report::svg::Figure;
use crate::report::verdict::Clause;
use crate::verbs::Report;
use crate::verbs::cost::Cost;

impl View<Report> for Cost {
    fn stem(&self) -> &'static str {
        "cost"
    }

    fn figures(&self) -> &'static [Figure<Report>] {
        super::figures::FIGURES
    }

    fn clauses(&self, report: &Report) -> Vec<Clause> {
        verdict::clauses(report, self)
    }

    fn facts(&self, report: &Report) -> Vec<(&'static str, String)> {
        facts(report, self)
    }

    fn lines(&self, report: &Report) -> Vec<String> {
        terminal::lines(report, self)
    }

    fn notes(&self, _report: &Report) -> Vec<Note> {
        notes::notes(self)
    }

    fn markdown(&self, report: &Report) -> String {
        markdown::render(report, self)
    }
}
