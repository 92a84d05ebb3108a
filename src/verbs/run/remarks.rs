//! One plain sentence for each row that needs one.

use super::plan::{Case, Plan};
use super::step_limit::StepLimits;
use crate::integrators::{EnergyLaw, Method, PerStep, Settings, Stable};
use crate::measure::{Energy, EnergyClass};
use crate::physics::System;
use crate::solvers::Status;
use crate::verbs::run::Outcome;

pub fn remarks(plan: &Plan, case: &Case, outcome: &Outcome, step: &StepLimits) -> Vec<String> {
    let class = outcome.energy.as_ref().and_then(|energy| energy.class);
    let warning = step.warning(case);
    let mut remarks = Vec::new();
    match outcome.status {
        Status::Unsupported | Status::Failed => {
            remarks.extend(outcome.reason.clone());
        }
        Status::Diverged => {
            let cause = outcome.reason.as_deref().unwrap_or_default();
            let time = outcome.stopped_at_s.unwrap_or(0.0);
            let damped = plan.system.kinds().depends_on_velocity();
            // The limit of this very scene says it better than a method's facts.
            let why = match (&warning, case.solver.as_method()) {
                (None, Some(method)) => why_unstable(method, damped),
                _ => String::new(),
            };
            remarks.push(format!("diverged at t = {time:.4} s, {cause}{why}"));
        }
        Status::Completed => {
            let lost = outcome.energy.as_ref().is_some_and(Energy::lost);
            remarks.extend(class.and_then(|class| explain(plan, case, class, lost)));
        }
    }
    remarks.extend(warning);
    remarks.extend(loosely_solved(plan, case));
    remarks
}

/// Where the scene asks its implicit steps to be solved to less than the default.
fn loosely_solved(plan: &Plan, case: &Case) -> Option<String> {
    let stated = plan.scene.solver.tolerance?;
    let method = case.solver.as_method()?;
    let iterates = matches!(method.evaluations, PerStep::PerIteration { .. });
    (iterates && stated > Settings::default().tolerance).then(|| {
        format!(
            "its steps are solved to a relative residual of {stated:e} only (`solver.tolerance`): a \
             loose tolerance breaks invariants and step-by-step replay"
        )
    })
}

/// What the method's own facts say of a divergence.
fn why_unstable(method: &Method, damped: bool) -> String {
    if damped && method.oscillator.stable != Stable::Always {
        return "; stiff springs and strong dampers each limit the step: take a smaller one"
            .to_owned();
    }
    match method.oscillator.stable {
        Stable::Never => {
            "; it is stable on no undamped spring, whatever the step: a smaller one only delays it"
                .to_owned()
        }
        Stable::Below(limit) => {
            format!("; stable while h ω < {limit:.4} for the stiffest mode: take a smaller step")
        }
        Stable::AlwaysAlong { across } => format!(
            "; it leaves out the stiffness of turning springs: motion across them is stable while \
             h ω < {across}"
        ),
        Stable::Always => "; it is always stable on linear springs, but this scene is not linear \
                           at this step"
            .to_owned(),
    }
}

/// Why a completed run's energy did what it did, where that is not simply right; `lost`
/// if less of it is left than there was.
fn explain(plan: &Plan, case: &Case, class: EnergyClass, lost: bool) -> Option<String> {
    if class == EnergyClass::Bounded {
        return None;
    }
    let effects = plan.system.effects();
    let has_springs = effects.iter().any(|(row, _)| row.elastic);
    match case.solver.as_method() {
        Some(method) if effects.iter().all(|(row, _)| row.constant) => {
            under_constant_force(method, class)
        }
        Some(method) => {
            let damped = plan.system.kinds().depends_on_velocity();
            let law = by_law(method, class, damped).filter(|_| has_springs);
            law.or_else(|| damped.then(|| by_balance(method, class, lost)))
        }
        None if class != EnergyClass::Growing && has_springs => case.solver.dissipates(),
        None => None,
    }
}

fn moves(class: EnergyClass) -> &'static str {
    match class {
        EnergyClass::Growing => "energy grows",
        EnergyClass::Dissipating => "energy falls",
        EnergyClass::Drifting | EnergyClass::Bounded => "energy drifts",
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

/// What the method does to an oscillator, where that is the cause.
fn by_law(method: &Method, class: EnergyClass, damped: bool) -> Option<String> {
    let moves = moves(class);
    match (method.oscillator.energy, method.oscillator.stable) {
        (EnergyLaw::Factor { factor, formula }, _) => {
            // At small steps: there the formula's sign is its leading term's.
            let law = factor(0.1) - 1.0;
            let agrees = match class {
                EnergyClass::Growing => law > 0.0,
                EnergyClass::Dissipating => law < 0.0,
                EnergyClass::Drifting | EnergyClass::Bounded => law != 0.0,
            };
            let undamped = if damped { "undamped " } else { "" };
            agrees.then(|| {
                format!(
                    "{moves} as its law says: by {formula} a step, z = hω, on an \
                     {undamped}oscillator"
                )
            })
        }
        (_, Stable::Below(limit)) if !damped => Some(format!(
            "{moves}: on an oscillator it is bounded for good while h ω < {limit:.4}; a step at that \
             limit, a force that jumps, or less than a period of its swing all look like a trend"
        )),
        _ => None,
    }
}

/// Where the balance does not close. It may grow while the energy falls: more is booked to dampers
/// than they took.
fn by_balance(method: &Method, class: EnergyClass, lost: bool) -> String {
    let does = match class {
        EnergyClass::Growing if lost => "grows, though E itself falls",
        EnergyClass::Growing => "grows",
        EnergyClass::Dissipating => "falls",
        EnergyClass::Drifting | EnergyClass::Bounded => "drifts",
    };
    format!(
        "the balance E + dissipated - injected {does}: it closes to order {} only, take a smaller \
         step",
        method.order_damped
    )
}
