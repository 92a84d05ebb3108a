//! Measures the record of each case and makes its outcome.

use super::plan::Plan;
use super::record::Record;
use super::truths::Truths;
use super::{budget, differs, identity, remarks};
use crate::measure::{self, Contact, Deviation, Energy, EnergySeries, Statics, Strain, TOLERANCE};
use crate::solvers::{SolverKind, Status};
use crate::trajectory::Trajectory;
use crate::verbs::run::{Outcome, WorkSummary};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// One outcome for each case, its energies over time for the figures, and what was left out since it would have
/// taken longer than the runs.
pub fn all(
    plan: &Plan,
    records: &[Record],
    truths: &Truths,
    scale: Option<f64>,
) -> (Vec<Outcome>, Vec<Option<EnergySeries>>, Vec<String>) {
    let (limits, limits_left_out) = remarks::linearised(plan, budget::of_limits(plan));
    let statics = plan.loads.then(|| Statics::new(plan.scene));
    let one = |index: usize| {
        let (case, record) = (&plan.cases[index], &records[index]);
        let timestep = case.label.timestep;
        let trajectory = record.trajectory.as_ref();
        let series = trajectory.and_then(|run| EnergySeries::new(&plan.system, run));
        let errors = trajectory.and_then(|run| truths.errors(timestep, run));
        let diverged = record.status == Status::Diverged;
        let early = trajectory.is_some() && record.status != Status::Completed;
        // Programs and engines do not say what their strain limit or their contact takes out.
        let counted = record.counts.corrections.is_some();
        let judged = |series| {
            let energy = measure::judge(series, scale, diverged);
            Energy {
                limited_j: energy.limited_j.filter(|_| counted),
                impacts_j: energy.impacts_j.filter(|_| counted),
                friction_j: energy.friction_j.filter(|_| counted),
                ..energy
            }
        };
        let replayed = trajectory.filter(|_| plan.choice.identify);
        let found = replayed.map(|run| identity::of_run(plan, case, run));
        let unknown = found.as_ref().is_some_and(Option::is_none);
        let found = found.flatten().unwrap_or_default();
        let mut outcome = Outcome {
            engine: case.label.engine.clone(),
            kind: case.solver.kind,
            timestep,
            substep: timestep / f64::from(case.solver.substeps),
            status: record.status,
            stopped_at_s: early.then_some(record.steps as f64 * timestep),
            reason: record.reason.clone(),
            position_error_m: errors.as_ref().map(|errors| errors.position.clone()),
            velocity_error_m_s: errors.and_then(|errors| errors.velocity),
            deviation_m: deviations(plan, records, index),
            energy: series.as_ref().map(judged),
            rods: trajectory.and_then(|run| measure::constrained(&plan.system, run)),
            momentum: trajectory.and_then(|run| measure::momentum(plan.scene, &plan.system, run)),
            contact: trajectory.and_then(|run| {
                let corrected = record.counts.corrections;
                let contact = Contact::of(&plan.system, run, corrected)?;
                let rapier = case.solver.kind == SolverKind::Rapier;
                let substep = timestep / f64::from(case.solver.substeps);
                let own = rapier.then(|| differs::differs(plan.scene, &plan.system, run, substep));
                Some(Contact {
                    differs: own.unwrap_or_default(),
                    ..contact
                })
            }),
            strain: trajectory
                .and_then(|run| Strain::of(plan.scene, run, record.counts.corrections)),
            loads: statics
                .as_ref()
                .zip(trajectory)
                .and_then(|(statics, run)| statics.loads(run)),
            work: WorkSummary {
                steps: record.steps,
                force_evaluations: record.counts.all_force_passes(),
                linear_solves: record.counts.linear_solves,
                world: record.counts.world,
                wall_s: record.wall.clone(),
            },
            identified: found.identity,
            explained: found.explained,
            remarks: Vec::new(),
        };
        outcome.remarks = remarks::remarks(plan, case, &outcome, limits.as_ref());
        outcome.remarks.extend(record.remarks.iter().cloned());
        (outcome, (series, unknown))
    };
    let (outcomes, rest): (Vec<_>, Vec<_>) = (0..records.len()).into_par_iter().map(one).unzip();
    let (energies, unknown): (Vec<_>, Vec<bool>) = rest.into_iter().unzip();
    let mut left_out = Vec::new();
    left_out.extend(limits_left_out.then(|| "predicted limits".to_owned()));
    for (case, _) in plan
        .cases
        .iter()
        .zip(unknown)
        .filter(|(_, unknown)| *unknown)
    {
        let what = format!("replays of {}", case.label.engine);
        if !left_out.contains(&what) {
            left_out.push(what);
        }
    }
    (outcomes, energies, left_out)
}

/// The deviations from every other reference engine that ran at the same timestep.
fn deviations(plan: &Plan, records: &[Record], index: usize) -> BTreeMap<String, Deviation> {
    let timestep = plan.cases[index].label.timestep;
    let from = |at: usize, ours: &Trajectory| {
        let (case, reference) = (&plan.cases[at], records[at].trajectory.as_ref()?);
        if at == index || !case.solver.reference || case.label.timestep != timestep {
            return None;
        }
        // A lone particle has no size; its reach stands in.
        let size = Some(plan.scene.size()).filter(|size| *size > 0.0);
        let size = size.unwrap_or_else(|| measure::reach(reference));
        let deviation = measure::deviation(ours, reference, TOLERANCE * size)?;
        Some((case.label.engine.clone(), deviation))
    };
    let ours = records[index].trajectory.iter();
    ours.flat_map(|ours| (0..records.len()).filter_map(move |at| from(at, ours)))
        .collect()
}
