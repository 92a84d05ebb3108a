//! One plain sentence for each row that needs one.

use super::plan::{Case, Plan};
use crate::integrators::{EnergyLaw, Method, Stable};
use crate::outcome::{EnergyClass, Outcome, Status};
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
    if class == EnergyClass::Bounded {
        return None;
    }
    let effects = plan.system.effects();
    match case.method {
        Some(method) if effects.iter().all(|(row, _)| row.constant) => {
            under_constant_force(method, class)
        }
        Some(method) => by_law(method, class, plan.system.is_damped()),
        None if class != EnergyClass::Growing && effects.iter().any(|(row, _)| row.elastic) => {
            case.dissipates.clone()
        }
        None => None,
    }
}

fn moves(class: EnergyClass) -> &'static str {
    match class {
        EnergyClass::Growing => "gains energy",
        EnergyClass::Dissipating => "loses energy",
        EnergyClass::Drifting | EnergyClass::Bounded => "drifts in energy",
    }
}

/// No oscillator, no law of one: under a constant acceleration a the error is that of the drift.
fn under_constant_force(method: &Method, class: EnergyClass) -> Option<String> {
    (method.order == 1).then(|| {
        format!(
            "{}: under a constant acceleration a its position is off by a h t/2, which grows for \
             as long as the fall lasts",
            moves(class)
        )
    })
}

/// The method's energy law in words, where it is the cause.
fn by_law(method: &Method, class: EnergyClass, damped: bool) -> Option<String> {
    let moves = moves(class);
    if let EnergyLaw::Factor { factor, formula } = method.oscillator.energy {
        let grows = factor(0.1) > 1.0;
        let agrees = match class {
            EnergyClass::Growing => grows,
            EnergyClass::Dissipating => factor(0.1) < 1.0,
            EnergyClass::Drifting | EnergyClass::Bounded => factor(0.1) != 1.0,
        };
        if agrees {
            let undamped = if damped { "undamped " } else { "" };
            return Some(format!(
                "{moves} as its law says: on an {undamped}oscillator by {formula} a step, z = hω"
            ));
        }
    }
    Some(if damped {
        format!(
            "{moves} against the balance E + dissipated - injected, which closes to order {} only: \
             take a smaller step",
            method.order_damped
        )
    } else {
        format!("{moves}: its law holds only while every mode is well inside the limit")
    })
}
