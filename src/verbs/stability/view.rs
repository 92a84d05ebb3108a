//! How limits are shown: which texts and figures stand where.

use super::text::*;
use crate::report::View;
use crate::report::notes::{Note, listed, notes};
use crate::report::svg::Figure;
use crate::report::verdict::Clause;
use crate::report::words::{self};
use crate::verbs::Report;
use crate::verbs::stability::Stability;

impl View<Report> for Stability {
    fn stem(&self) -> &'static str {
        "stability"
    }

    fn figures(&self) -> &'static [Figure<Report>] {
        super::figures::FIGURES
    }

    fn clauses(&self, report: &Report) -> Vec<Clause> {
        verdict::clauses(report, self)
    }

    fn facts(&self, _report: &Report) -> Vec<(&'static str, String)> {
        facts(self)
    }

    fn lines(&self, report: &Report) -> Vec<String> {
        terminal::lines(report, self)
    }

    fn notes(&self, _report: &Report) -> Vec<Note> {
        let all = self.rows.len();
        let said = self.rows.iter().flat_map(|row| {
            let engine = words::one_line(&row.engine);
            let remarks = row.remarks.iter();
            remarks.map(move |remark| (engine.clone(), words::one_line(remark)))
        });
        notes(said, |engines| {
            if engines.len() == all && all > 2 {
                "all".to_owned()
            } else {
                listed(engines)
            }
        })
    }

    fn markdown(&self, report: &Report) -> String {
        markdown::render(report, self)
    }
}
