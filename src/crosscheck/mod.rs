//! The main job: every chosen engine on one scene, side by side, and what came of it.
//!
//! [`Plan`] says what will run, [`Plan::execute`] runs it in parallel and measures it. Results do
//! not depend on the number of threads; only wall times do.

mod execute;
mod figures;
mod ledger;
mod outcome;
mod plan;
mod remarks;

pub use execute::{Host, Quiet, Saver};
pub use plan::{Case, Choice, ChosenEngine, Estimate, Label, Plan};

use crate::engines::Limits;
use crate::measure;
use crate::outcome::{Report, SCHEMA_VERSION, Truth, TruthKind};
use crate::trajectory::SaveError;

/// Why every report has `truth.kind: none` so far.
const NO_TRUTH: &str = "not computed; engines are held against each other and the laws of energy";

impl Plan<'_> {
    /// Runs every case and the twin proof, and measures what they left.
    ///
    /// # Errors
    /// Only when a trajectory file could not be written; whatever an engine does is an outcome.
    pub fn execute(&self, host: &dyn Host) -> Result<Report, SaveError> {
        let scale = measure::energy_scale(self.scene, &self.system);
        let limit = measure::divergence_limit(self.scene, scale);
        let limits = Limits::new(self.system.clone(), limit);
        let (runs, proofs) = rayon::join(
            || execute::all(&self.cases, self.scene, &limits, host),
            || ledger::twin_proof(self.scene),
        );
        let mut runs = runs?;
        execute::time_again(&self.cases, &mut runs, &limits);
        let (outcomes, series) = outcome::all(self, &runs, scale);
        Ok(Report {
            schema_version: SCHEMA_VERSION,
            scene: ledger::scene_facts(self, &runs, scale),
            truth: Truth {
                kind: TruthKind::None,
                method: None,
                error_bound_m: None,
                horizon_s: None,
                reason: Some(NO_TRUTH.to_owned()),
            },
            figures: figures::figures(self, &runs, &series, scale),
            outcomes,
            checks: proofs.into_iter().chain(ledger::no_scale(scale)).collect(),
        })
    }
}
