//! The verb `run`: every chosen engine on one scene, side by side, and their outcomes.
//!
//! [`Plan`] says what will run, and [`Plan::execute`] runs it in parallel, measures the outcomes, and
//! checks whether they are as the scene expects ([`Expectations`]). Results do not depend on the number of threads;
//! only wall times do.

mod args;
mod beside;
mod budget;
mod checks;
mod curves;
mod differs;
mod execute;
pub mod expect;
mod figures;
pub mod identity;
mod outcomes;
mod plan;
mod playback;
mod program;
mod record;
mod remarks;
mod result;
mod text;
mod truths;

pub use args::{Args, run};
pub use expect::names;
pub(super) use figures::FIGURES;
pub use plan::{Case, Choice, Expectations, Orders, Plan};
pub(super) use playback::{rows, shown};
pub use result::{Curves, Outcome, PlotAxis, RunSeries, TruthCurves, WorkSummary};
pub use text::missed;
pub(super) use text::{page, view};

use crate::measure::stability::Linearised;
use crate::report::Header;
use crate::solvers::SolverKind;
use crate::trajectory::SaveError;
use crate::truth;
use crate::verbs::session::Session;
use crate::verbs::{Body, Report, Series, SeriesState, facts};
use truths::Truths;

pub(in crate::verbs) use record::Record;

/// What the twin proof of a plan may take, in steps of one particle.
pub(in crate::verbs) fn effort_of_proofs(plan: &Plan) -> u64 {
    budget::of_proofs(plan)
}

/// The scene of a plan linearised about its start, as far as judging may take; None beyond.
pub(in crate::verbs) fn linearised(plan: &Plan) -> Option<Linearised> {
    remarks::linearised(plan, budget::of_limits(plan)).0
}

impl Plan<'_> {
    /// Runs every case, the truth and the twin proof, and measures the records.
    ///
    /// # Errors
    /// Fails only when a trajectory file could not be written; whatever an engine does is an outcome.
    pub fn execute(&self, session: &dyn Session) -> Result<Report, SaveError> {
        self.recorded(session).map(|(report, _)| report)
    }

    /// The same, with the record of each case.
    pub(in crate::verbs) fn recorded(
        &self,
        session: &dyn Session,
    ) -> Result<(Report, Vec<Record>), SaveError> {
        let (scene, system) = (self.scene, &self.system);
        let limits = facts::limits(scene, system);
        let ends = self.cases.iter().map(|case| case.label.end());
        let until = ends.fold(0.0, f64::max);
        let find = || {
            let truth = truth::find(scene, system, self.choice.truth, until, session.store());
            session.progress(self.beside.truth);
            truth
        };
        let (truth, (records, proofs)) = rayon::join(find, || {
            rayon::join(
                || execute::all(self, &limits, session),
                || {
                    let proofs = checks::proofs(self);
                    session.progress(self.beside.proofs);
                    proofs
                },
            )
        });
        let mut records = records?;
        let truths = Truths::new(self, &records, &truth);
        let orders = checks::orders(self, &truth);
        session.progress(self.beside.orders);
        execute::time_again(self, &mut records, &limits);
        let scale = facts::energy_scale(scene, system, &truth);
        let (outcomes, energies, left_out) = outcomes::all(self, &records, &truths, scale);
        session.progress(self.beside.judging);
        let mut evaluations = [0, 0];
        for (case, record) in self.cases.iter().zip(&records) {
            if case.solver.kind == SolverKind::Integrator {
                evaluations[0] += record.counts.force_evaluations.unwrap_or(0);
                evaluations[1] += record.counts.damping_evaluations.unwrap_or(0);
            }
        }
        let header = Header {
            scene: facts::scene(scene, system, evaluations, scale),
            truth: facts::truth(&truth),
            checks: proofs
                .into_iter()
                .chain(orders)
                .chain(budget::left_out(left_out))
                .chain(facts::no_scale(scale))
                .collect(),
            advice: Vec::new(),
        };
        let series = curves::series(self, &records, &energies, &truths, scale);
        let mut report = Report {
            header,
            body: Body::Run { outcomes },
            series: SeriesState::Loaded(Series::Curves(series)),
        };
        let expected = self.choice.expectations.checks(scene, &report);
        report.header.checks.extend(expected);
        Ok((report, records))
    }
}
