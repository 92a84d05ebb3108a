//! One plain sentence for each row that needs one.

use super::plan::{Case, Plan};
use crate::engines;
use crate::integrators::{EnergyLaw, Method, Stable};
use crate::outcome::{EnergyClass, Kind, Outcome, Status};
use crate::system::System;

pub(super) fn remarks(plan: &Plan, case: &Case, outcome: &Outcome) -> Vec<String> {
    let class = outcome.energy.as_ref().and_then(|energy| energy.class);
    let mut remarks = Vec::new();
    match outcome.status {
        Status::Unsupported | Status::Failed => {
            remarks.extend(outcome.reason.clone());
        }
        Status::Diverged => {
            let cause = outcome.reason.as_deref().unwrap_or_default();
            let time = outcome.stopped_at_s.unwrap_or(0.0);
            let why = case.method.map_or_else(String::new, why_unstable);
            remarks.push(format!("diverged at t = {time:.4} s, {cause}{why}"));
        }
        Status::Completed => {
            remarks.extend(class.and_then(|class| explain(plan, case, class)));
        }
    }
    remarks
}

/// What the method's own facts say of a divergence.
fn why_unstable(method: &'static Method) -> String {
    match method.oscillator.stable {
        Stable::Never => {
            "; it is stable on no undamped spring, whatever the step: a smaller one only delays it"
                .to_owned()
        }
        Stable::Below(limit) => {
            format!("; stable while h ω < {limit:.4} for the stiffest mode: take a smaller step")
        }
        Stable::Always => "; it is always stable on linear springs, but this scene is not linear \
                           at this step"
            .to_owned(),
    }
}

/// Why a completed run's energy did what it did, where that is not simply right.
fn explain(plan: &Plan, case: &Case, class: EnergyClass) -> Option<String> {
    match (case.method, class) {
        (_, EnergyClass::Bounded) => None,
        (Some(method), _) => by_law(method, class, plan.system.is_damped()),
        (None, EnergyClass::Dissipating | EnergyClass::Drifting) if has_joints(plan, case) => {
            Some(format!(
                "rapier's spring joint is linearly implicit Euler at h = dt/{}, which loses energy \
                 by design: distance from it is no error of yours",
                case.substeps
            ))
        }
        (None, _) => None,
    }
}

/// Whether the case is rapier moving springs by its own joints.
fn has_joints(plan: &Plan, case: &Case) -> bool {
    case.kind == Kind::Rapier
        && case.label.engine != engines::rapier::FORCES_ID
        && !plan.scene.springs.is_empty()
}

/// The method's energy law in words.
fn by_law(method: &Method, class: EnergyClass, damped: bool) -> Option<String> {
    let moves = match class {
        EnergyClass::Growing => "gains energy",
        EnergyClass::Dissipating => "loses energy",
        EnergyClass::Drifting | EnergyClass::Bounded => "drifts in energy",
    };
    let undamped = if damped { "undamped " } else { "" };
    match method.oscillator.energy {
        // The law is why, unless it says that nothing happens.
        EnergyLaw::Factor { formula, .. } if formula != "1" => Some(format!(
            "{moves} as its law says: on an {undamped}oscillator by {formula} a step, z = hω"
        )),
        _ if damped => Some(format!(
            "{moves} against the balance E + dissipated - injected: its work integrals are of \
             order {}, a smaller step closes it",
            method.order_damped
        )),
        _ => Some(format!(
            "{moves}: it keeps energy bounded only while every mode is well inside its limit"
        )),
    }
}
