//! The truth at the instants the runs recorded.

use super::plan::Plan;
use super::ran::Run;
use crate::measure::{self, Errors, Known};
use crate::physics::{ParticleSystem, System};
use crate::report::TruthFacts;
use crate::trajectory::Trajectory;
use crate::truth::Truth;
use crate::truth::TruthKind;
use rayon::prelude::*;

/// One truth, sampled once for all the runs of a timestep.
pub struct Truths {
    truth: Truth,
    /// By timestep.
    known: Vec<(f64, Known)>,
    peak: Option<f64>,
}

impl Truths {
    pub fn new(plan: &Plan, runs: &[Run], truth: Truth) -> Self {
        let mut timesteps: Vec<f64> = Vec::new();
        for case in &plan.cases {
            if !timesteps.contains(&case.label.timestep) {
                timesteps.push(case.label.timestep);
            }
        }
        let known = timesteps
            .into_par_iter()
            .map(|timestep| (timestep, known(plan, runs, &truth, timestep)))
            .collect();
        let peak = peak(&plan.system, &truth);
        Self { truth, known, peak }
    }

    pub fn truth(&self) -> &Truth {
        &self.truth
    }

    /// The largest kinetic energy of the truth up to its horizon, J.
    pub fn peak(&self) -> Option<f64> {
        self.peak
    }

    /// How far a run at this timestep is from the truth.
    pub fn errors(&self, timestep: f64, run: &Trajectory) -> Option<Errors> {
        measure::errors(run, self.at(timestep)?)
    }

    /// What is known at the instants of this timestep; None where nothing is.
    pub fn at(&self, timestep: f64) -> Option<&Known> {
        let (_, known) = self.known.iter().find(|(h, _)| *h == timestep)?;
        (!known.steps.is_empty()).then_some(known)
    }

    /// As the report states it.
    pub fn facts(&self) -> TruthFacts {
        facts(&self.truth)
    }
}

/// A truth as reports state it.
pub fn facts(truth: &Truth) -> TruthFacts {
    let there = truth.kind != TruthKind::None;
    TruthFacts {
        kind: truth.kind,
        method: truth.method.clone(),
        error_bound_m: there.then_some(truth.error_bound),
        horizon_s: there.then_some(truth.horizon),
        reason: Some(truth.reason.clone()),
    }
}

/// The truth at every instant up to the horizon that any run of this timestep recorded.
fn known(plan: &Plan, runs: &[Run], truth: &Truth, timestep: f64) -> Known {
    let Some(motion) = truth.motion() else {
        return Known::default();
    };
    let mut steps: Vec<u64> = Vec::new();
    for (case, run) in plan.cases.iter().zip(runs) {
        if let Run::Ran(ran) = run
            && case.label.timestep == timestep
        {
            let run = &ran.trajectory;
            steps.extend((0..run.len()).map(|k| run.step(k)));
            steps.sort_unstable();
            steps.dedup();
        }
    }
    let time = |step: &u64| *step as f64 * timestep;
    // A run ends at n h, which may round to just past where the truth was asked for.
    let last = truth.horizon * (1.0 + 4.0 * f64::EPSILON);
    steps.retain(|step| time(step) <= last);
    let times: Vec<f64> = steps.iter().map(|s| time(s).min(truth.horizon)).collect();
    Known {
        states: motion.states(&times),
        steps,
    }
}

/// The largest kinetic energy of a truth up to its horizon, J.
pub fn peak(system: &ParticleSystem, truth: &Truth) -> Option<f64> {
    let motion = truth.motion()?;
    let times = motion.landmarks(truth.horizon);
    let states = motion.states(&times);
    let kinetic = (0..times.len()).map(|k| system.kinetic(states.v(k)));
    let peak = kinetic.fold(0.0, f64::max);
    peak.is_finite().then_some(peak)
}
