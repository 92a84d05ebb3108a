//! The truth at the instants the runs recorded.

use super::plan::Plan;
use super::record::Record;
use crate::measure::{self, Errors, TrueStates};
use crate::trajectory::Trajectory;
use crate::truth::Truth;
use rayon::prelude::*;

/// One truth, sampled once for all runs of a timestep.
pub struct Truths {
    /// The samples by timestep, s.
    known: Vec<(f64, TrueStates)>,
}

impl Truths {
    pub fn new(plan: &Plan, records: &[Record], truth: &Truth) -> Self {
        let mut timesteps: Vec<f64> = Vec::new();
        for case in &plan.cases {
            if !timesteps.contains(&case.label.timestep) {
                timesteps.push(case.label.timestep);
            }
        }
        let sample = |h| (h, sample(plan, records, truth, h));
        Self {
            known: timesteps.into_par_iter().map(sample).collect(),
        }
    }

    /// The errors of a run at this timestep against the truth.
    pub fn errors(&self, timestep: f64, run: &Trajectory) -> Option<Errors> {
        measure::errors(run, self.at(timestep)?)
    }

    /// The truth at the instants of this timestep; None where it is unknown.
    pub fn at(&self, timestep: f64) -> Option<&TrueStates> {
        let (_, known) = self.known.iter().find(|(h, _)| *h == timestep)?;
        (!known.steps.is_empty()).then_some(known)
    }
}

/// Samples the truth at every instant up to the horizon that any run of this timestep recorded.
fn sample(plan: &Plan, records: &[Record], truth: &Truth, timestep: f64) -> TrueStates {
    let Some(motion) = truth.motion() else {
        return TrueStates::default();
    };
    let mut steps: Vec<u64> = Vec::new();
    for (case, record) in plan.cases.iter().zip(records) {
        if let Some(run) = &record.trajectory
            && case.label.timestep == timestep
        {
            steps.extend((0..run.len()).map(|k| run.step(k)));
            steps.sort_unstable();
            steps.dedup();
        }
    }
    let time = |step: &u64| *step as f64 * timestep;
    // A run ends at n h, which may round to just past the truth's horizon.
    let last = truth.horizon * (1.0 + 4.0 * f64::EPSILON);
    steps.retain(|step| time(step) <= last);
    let times: Vec<f64> = steps.iter().map(|s| time(s).min(truth.horizon)).collect();
    TrueStates {
        states: motion.states(&times),
        steps,
    }
}
