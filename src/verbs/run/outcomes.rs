//! From what a case left to its outcome.

use super::plan::{Case, Plan};
use super::ran::Run;
use super::step_limit::StepLimits;
use super::truths::Truths;
use super::{identity, remarks};
use crate::measure::{self, EnergySeries, TOLERANCE};
use crate::solvers::Status;
use crate::verbs::run::{Outcome, Work};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// One outcome a case, and the energies the figures draw.
pub fn all(
    plan: &Plan,
    runs: &[Run],
    truths: &Truths,
    scale: Option<f64>,
) -> (Vec<Outcome>, Vec<Option<EnergySeries>>) {
    let step = StepLimits::new(plan);
    (0..runs.len())
        .into_par_iter()
        .map(|index| one(plan, runs, index, truths, scale, &step))
        .unzip()
}

fn one(
    plan: &Plan,
    runs: &[Run],
    index: usize,
    truths: &Truths,
    scale: Option<f64>,
    step: &StepLimits,
) -> (Outcome, Option<EnergySeries>) {
    let case = &plan.cases[index];
    let mut outcome = empty(case);
    let mut series = None;
    match &runs[index] {
        Run::Unsupported(unsupported) => {
            outcome.status = Status::Unsupported;
            outcome.reason = Some(unsupported.reason.clone());
        }
        Run::Failed(reason) => {
            outcome.status = Status::Failed;
            outcome.reason = Some(reason.clone());
        }
        Run::Ran(ran) => {
            outcome.status = ran.status;
            outcome.reason.clone_from(&ran.reason);
            if outcome.status != Status::Completed {
                outcome.stopped_at_s = Some(ran.steps as f64 * case.label.timestep);
            }
            series = EnergySeries::new(&plan.system, &ran.trajectory);
            let diverged = outcome.status == Status::Diverged;
            outcome.energy = series
                .as_ref()
                .map(|series| measure::judge(series, scale, diverged));
            outcome.momentum = measure::momentum(plan.scene, &plan.system, &ran.trajectory);
            outcome.deviation_m = deviations(plan, runs, index);
            if plan.identify {
                outcome.identified = identity::of_run(plan, case, ran);
            }
            if let Some(errors) = truths.errors(case.label.timestep, &ran.trajectory) {
                outcome.position_error_m = Some(errors.position);
                outcome.velocity_error_m_s = errors.velocity;
            }
            outcome.work = Work {
                steps: ran.steps,
                force_evaluations: ran.counts.all_force_passes(),
                linear_solves: ran.counts.linear_solves,
                wall_s: ran.wall.clone(),
            };
        }
    }
    outcome.remarks = remarks::remarks(plan, case, &outcome, step);
    if let Run::Ran(ran) = &runs[index] {
        outcome.remarks.extend(ran.remarks.iter().cloned());
    }
    (outcome, series)
}

fn empty(case: &Case) -> Outcome {
    Outcome {
        engine: case.label.engine.clone(),
        kind: case.solver.kind,
        timestep: case.label.timestep,
        substep: case.label.timestep / f64::from(case.solver.substeps),
        status: Status::Completed,
        stopped_at_s: None,
        reason: None,
        position_error_m: None,
        velocity_error_m_s: None,
        deviation_m: BTreeMap::new(),
        energy: None,
        momentum: None,
        work: Work {
            steps: 0,
            force_evaluations: None,
            linear_solves: None,
            wall_s: None,
        },
        identified: None,
        remarks: Vec::new(),
    }
}

/// Distances from every other reference engine that ran at the same timestep.
fn deviations(
    plan: &Plan,
    runs: &[Run],
    index: usize,
) -> BTreeMap<String, crate::measure::Deviation> {
    let own = &plan.cases[index].label;
    let Run::Ran(ours) = &runs[index] else {
        return BTreeMap::new();
    };
    let size = plan.scene.size();
    plan.cases
        .iter()
        .zip(runs)
        .enumerate()
        .filter(|(at, (case, _))| {
            *at != index && case.solver.reference && case.label.timestep == own.timestep
        })
        .filter_map(|(_, (case, run))| {
            let Run::Ran(reference) = run else {
                return None;
            };
            // A lone particle has no size but the way it goes.
            let size = if size > 0.0 {
                size
            } else {
                measure::reach(&reference.trajectory)
            };
            let tolerance = TOLERANCE * size;
            let deviation = measure::deviation(&ours.trajectory, &reference.trajectory, tolerance)?;
            Some((case.label.engine.clone(), deviation))
        })
        .collect()
}
