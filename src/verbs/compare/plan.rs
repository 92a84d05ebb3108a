//! One trajectory that somebody else computed, against the truth and the laws.

use crate::scene::Scene;
use crate::solvers::Solver;
use crate::solvers::external::{Failure, Program, Recording, Task};
use crate::trajectory::{Rows, SaveError};
use crate::truth::Demand;
use crate::verbs::host::Host;
use crate::verbs::run::Outcome;
use crate::verbs::run::{Choice, Expectations, Measured, Orders, Plan, identity};
use crate::verbs::{Beside, Body, Report, Series};
use std::sync::Arc;

/// A trajectory and the scene it simulates, whose duration is the trajectory's.
#[derive(Debug, Clone)]
pub struct Comparison<'a> {
    pub scene: &'a Scene,
    pub rows: Arc<Rows>,
    /// What the report calls it.
    pub name: String,
    /// What errors are measured against.
    pub demand: Demand,
}

/// Rows that are there already.
struct Recorded(Arc<Rows>);

impl Program for Recorded {
    fn record(&self, _task: &Task) -> Result<Recording, Failure> {
        Ok(Recording {
            rows: Rows::clone(&self.0),
            seconds: None,
        })
    }
}

impl Comparison<'_> {
    /// Errors, energy, identity over every step, and the first fault: a report with one outcome.
    ///
    /// # Errors
    /// Only when the host cannot write a trajectory it wants saved.
    pub fn execute(&self, host: &dyn Host) -> Result<Report, SaveError> {
        let choice = Choice {
            solvers: vec![Solver::program(
                &self.name,
                Arc::new(Recorded(Arc::clone(&self.rows))),
            )],
            timesteps: vec![self.rows.timestep],
            truth: self.demand,
            order: Orders::Never,
            // Every step of the rows is replayed below, not some of those recorded.
            identify: false,
            prove: false,
            expectations: Expectations::Ignored,
        };
        let plan = Plan::new(self.scene, &choice);
        let Measured {
            header,
            outcomes,
            figures,
        } = plan.measured(host)?;
        let (identified, fault) = identity::of_rows(&plan, &self.rows);
        let named = outcomes.into_iter().map(|outcome| Outcome {
            identified: identified.clone(),
            ..outcome
        });
        Ok(Report {
            header,
            body: Body::Compare {
                outcomes: named.collect(),
                fault,
            },
            beside: Beside::Here(Series::Curves(figures)),
        })
    }
}
