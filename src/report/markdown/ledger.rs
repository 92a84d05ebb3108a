//! The two ledgers: where the energy ended up, and which effects ran.

use super::super::words::{self, NOTHING};
use super::{engine, escape, table};
use crate::outcome::{Energy, Outcome, Report};

/// Where the energy is at the end, by effect, what left and entered, and the momenta.
pub(super) fn energies(report: &Report) -> String {
    let effects: Vec<&str> = report
        .outcomes
        .iter()
        .find_map(|outcome| outcome.energy.as_ref())
        .map_or_else(Vec::new, with_potential);
    let mut header = vec!["engine".to_owned(), "kinetic".to_owned()];
    header.extend(effects.iter().map(|id| escape(id)));
    header.extend(["dissipated", "injected", "E final - E initial"].map(String::from));
    let momentum = report.outcomes.iter().any(|o| o.momentum.is_some());
    if momentum {
        header.extend(["momentum off by", "angular momentum off by"].map(String::from));
    }
    let rows: Vec<Vec<String>> = report
        .outcomes
        .iter()
        .filter_map(|outcome| Some((outcome, outcome.energy.as_ref()?)))
        .map(|(outcome, energy)| {
            let mut row = vec![engine(report, outcome), number(energy.kinetic_final_j)];
            row.extend(
                effects
                    .iter()
                    .map(|id| number(energy.potential_final_j.get(id).copied())),
            );
            let change = energy.final_j.zip(energy.initial_j);
            row.push(number(energy.dissipated_j));
            row.push(number(energy.injected_j));
            row.push(number(change.map(|(end, start)| end - start)));
            if momentum {
                row.extend(momenta(outcome));
            }
            row
        })
        .collect();
    if rows.is_empty() {
        return String::new();
    }
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    let intro = "Joules at the last recorded instant; momenta in kg m/s and kg m²/s, where the scene \
                 conserves them.";
    format!(
        "## Where the energy is at the end\n\n{intro}\n\n{}",
        table(&header, &rows)
    )
}

/// Effects that hold potential energy: the others' columns would be zeros.
fn with_potential(energy: &Energy) -> Vec<&'static str> {
    let ids = energy.potential_final_j.iter();
    ids.filter(|(_, joules)| **joules != 0.0)
        .map(|(id, _)| *id)
        .collect()
}

fn momenta(outcome: &Outcome) -> [String; 2] {
    let momentum = outcome.momentum.as_ref();
    [
        number(momentum.and_then(|m| m.linear_error_max)),
        number(momentum.and_then(|m| m.angular_error_max)),
    ]
}

fn number(value: Option<f64>) -> String {
    value.map_or(NOTHING.into(), words::short)
}

/// The ledger: what ran, how often, at what cost.
pub(super) fn effects(report: &Report) -> String {
    if report.scene.effects.is_empty() {
        return String::new();
    }
    let rows: Vec<Vec<String>> = report
        .scene
        .effects
        .iter()
        .map(|effect| {
            let cost = effect.nanoseconds.map(|ns| words::seconds(ns * 1e-9));
            vec![
                escape(effect.id),
                effect.members.to_string(),
                words::count(effect.evaluations),
                cost.unwrap_or(NOTHING.into()),
            ]
        })
        .collect();
    let header = ["effect", "acts on", "evaluations", "time each"];
    format!("## Effects that ran\n\n{}", table(&header, &rows))
}
