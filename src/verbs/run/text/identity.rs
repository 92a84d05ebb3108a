//! Words for a trajectory's identity and its first deviating step.

use crate::integrators;
use crate::measure::identify::{Fault, Identified, Quantity, Undecided};
use crate::report::words::{self, listed};
use crate::solvers::SolverKind;
use crate::verbs::run::Outcome;
use crate::verbs::{Body, Report};

/// The number of equivalent schemes named, at most.
const MAX_NAMED: usize = 6;

/// The identity that replay found for an outcome; None where it found none, or the one that the row states anyway.
pub fn sentence(outcome: &Outcome) -> Option<String> {
    let found = outcome.identified.as_ref()?;
    let itself = outcome.kind == SolverKind::Integrator
        && found.substeps == 1
        && (found.method == outcome.engine || found.equivalent.contains(&outcome.engine));
    let scheme = scheme(found, outcome.timestep);
    let defect = format!("defect {} of rounding", words::short_sci(found.defect));
    let next = found.runner_up.as_ref().zip(found.runner_up_defect);
    let next = next.map_or(String::new(), |(other, defect)| {
        format!(
            "; next {}: {}",
            words::one_line(other),
            words::short_sci(defect)
        )
    });
    let is = format!("step by step it is {scheme} ({defect}");
    let text = match found.undecided {
        _ if found.decisive => format!("{is}{next})"),
        Some(Undecided::NothingFits) => {
            let nearest = format!("the nearest is {scheme} ({defect}{next})");
            format!("no known scheme explains its steps; {nearest}")
        }
        Some(Undecided::DataTooCoarse) => {
            let why = "which at this step and with these digits cannot be told from";
            format!("{is}), {why} {}", equivalent(found))
        }
        _ => format!("{is}), which here is the same as {}", equivalent(found)),
    };
    (!itself).then_some(text)
}

/// `implicit_euler at h/4 = 0.000125 s`.
fn scheme(found: &Identified, timestep: f64) -> String {
    let name = words::one_line(&found.method);
    if found.substeps == 1 {
        return name;
    }
    let n = found.substeps;
    let step = words::short(timestep / f64::from(n));
    format!("{name} at h/{n} = {step} s")
}

fn equivalent(found: &Identified) -> String {
    let names = found.equivalent.iter().take(MAX_NAMED);
    let mut names: Vec<String> = names.map(|name| words::one_line(name)).collect();
    let more = found.equivalent.len() - names.len();
    if more > 0 {
        names.push(format!("{more} more"));
    }
    listed(&names)
}

/// The first deviating step of a trajectory, in lines; empty where there is none.
pub fn fault(report: &Report) -> Vec<String> {
    let Body::Compare {
        fault: Some(fault), ..
    } = &report.body
    else {
        return Vec::new();
    };
    let Fault { step, particle, .. } = fault;
    let (what, unit) = match fault.quantity {
        Quantity::Position => ("position", "m"),
        Quantity::Velocity => ("velocity", "m/s"),
    };
    vec![
        format!(
            "step {step}, from t = {} s: {what} of particle {particle}",
            words::short(fault.t_s)
        ),
        format!("expected {} {unit}", vector(fault.expected.map(Some))),
        format!("found    {} {unit}", vector(fault.found)),
        words::one_line(&fault.explanation),
    ]
}

/// A vector with enough digits to show a difference of rounding.
fn vector(value: [Option<f64>; 3]) -> String {
    let [x, y, z] = value.map(|c| c.map_or_else(|| "?".into(), |c| format!("{c:?}")));
    format!("({x}, {y}, {z})")
}

/// The verdict of a comparison in one clause; None in a report without one.
pub fn verdict(report: &Report) -> Option<String> {
    let Body::Compare { outcomes, fault } = &report.body else {
        return None;
    };
    let outcome = outcomes.first()?;
    let name = words::one_line(&outcome.engine);
    let Some(found) = &outcome.identified else {
        return Some(format!("{name} holds too few steps to be replayed"));
    };
    let scheme = scheme(found, outcome.timestep);
    let known = integrators::find(&found.method).is_some();
    let Some(fault) = fault else {
        return Some(match found.undecided {
            None => format!("{name} follows {scheme} throughout"),
            Some(Undecided::SameMap) => {
                format!("{name} follows {scheme} throughout, here the same as others")
            }
            Some(Undecided::DataTooCoarse) => format!("{name} does not tell {scheme} from others"),
            Some(Undecided::NothingFits) => format!("{name} follows no known scheme"),
        });
    };
    let (step, says) = (fault.step, words::one_line(&fault.explanation));
    Some(match found.undecided {
        Some(Undecided::NothingFits) => format!("{name}, step {step}: {says}"),
        _ if known => format!("{name} is {scheme} but for step {step}: {says}"),
        // A scheme that remembers the previous step deviates first in the second.
        _ if step < 2 => format!("{name} is {scheme}: {says}"),
        _ => format!("{name} is {scheme} from step {step} on: {says}"),
    })
}
