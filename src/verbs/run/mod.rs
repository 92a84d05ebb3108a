//! The main job: every chosen engine on one scene, side by side, and what came of it.
//!
//! [`Plan`] says what will run, and [`Plan::execute`] runs it in parallel, measures it, and says whether
//! that is what the scene expects ([`Expectations`]). Results do not depend on the number of threads;
//! only wall times do.

mod args;
mod curves;
mod execute;
pub mod expect;
mod figures;
pub mod identity;
pub mod ledger;
mod order;
mod outcomes;
mod plan;
mod program;
mod ran;
mod remarks;
mod result;
mod step_limit;
mod text;
pub mod truths;

pub use args::{Args, run};
pub use expect::names;
pub(super) use figures::FIGURES;
pub use plan::{Case, Choice, Expectations, Orders, Plan};
pub use result::{Curves, Figures, Outcome, PlotAxis, TruthCurves, Work};
pub(super) use text::{page, view};

use crate::measure;
use crate::measure::Check;
use crate::report::Header;
use crate::solvers::Limits;
use crate::trajectory::SaveError;
use crate::truth;
use crate::verbs::host::Host;
use crate::verbs::{Beside, Body, Report, Series};
use truths::Truths;

/// What the runs of a plan left.
pub struct Measured {
    pub header: Header,
    pub outcomes: Vec<Outcome>,
    pub figures: Figures,
}

impl Plan<'_> {
    /// Runs every case, the truth and the twin proof, and measures what they left.
    ///
    /// # Errors
    /// Only when a trajectory file could not be written; whatever an engine does is an outcome.
    pub fn execute(&self, host: &dyn Host) -> Result<Report, SaveError> {
        let Measured {
            header,
            outcomes,
            figures,
        } = self.measured(host)?;
        Ok(Report {
            header,
            body: Body::Run { outcomes },
            beside: Beside::Here(Series::Curves(figures)),
        })
    }

    /// What a report is made of.
    pub fn measured(&self, host: &dyn Host) -> Result<Measured, SaveError> {
        // When a run stops must not depend on whether a truth was asked for.
        let before = measure::energy_scale(self.scene, &self.system, None);
        let limit = measure::divergence_limit(self.scene, before);
        let limits = Limits::new(self.system.clone(), limit);
        let find = || {
            let (scene, system) = (self.scene, &self.system);
            truth::find(scene, system, self.demand, self.until(), host.store())
        };
        let (truth, (runs, proofs)) = rayon::join(find, || {
            rayon::join(|| execute::all(self, &limits, host), || self.proofs())
        });
        let mut runs = runs?;
        let truths = Truths::new(self, &runs, truth);
        let orders = order::checks(self, truths.truth());
        execute::time_again(self, &mut runs, &limits);
        let scale = measure::energy_scale(self.scene, &self.system, truths.peak());
        let (outcomes, series) = outcomes::all(self, &runs, &truths, scale);
        let facts = ledger::scene_facts(self, &runs, scale);
        let stated = truths.facts();
        let found = expect::Found {
            truth: &stated,
            scene: &facts,
            outcomes: &outcomes,
        };
        let expected = self.expectations.checks(self.scene, &found);
        Ok(Measured {
            figures: curves::figures(self, &runs, &series, &truths, scale),
            header: Header {
                checks: proofs
                    .into_iter()
                    .chain(orders)
                    .chain(ledger::no_scale(scale))
                    .chain(expected)
                    .collect(),
                scene: facts,
                truth: stated,
            },
            outcomes,
        })
    }

    /// That rapier's world and ours are the same scene, unless nobody asks or nothing here was computed.
    fn proofs(&self) -> Vec<Check> {
        if !self.prove || self.only_records() {
            Vec::new()
        } else {
            measure::twin::prove(self.scene, self.scene.solver.timestep)
        }
    }
}
