//! Words for a trajectory's identity and its first deviating step.

use super::laws;
use crate::integrators;
use crate::measure::identify::{Explained, Fault, Identity, Quantity, TRUTH, Undecided};
use crate::report::words::{self, listed};
use crate::scene::object::called;
use crate::solvers::SolverKind;
use crate::verbs::run::Outcome;
use crate::verbs::{Body, Report};

/// What is off by less, in parts of what a step moves, is not off at all.
const NOTHING: f64 = 1e-13;
/// The number of equivalent schemes named, at most.
const MAX_NAMED: usize = 6;

/// The scheme that replay found for an outcome, or what it deviates in; None where it found the one that the row
/// states anyway.
pub fn sentence(outcome: &Outcome) -> Option<String> {
    let Some(found) = &outcome.identified else {
        return outcome.explained.as_ref().map(explained);
    };
    let itself = outcome.kind == SolverKind::Integrator
        && found.substeps == 1
        && (found.method == outcome.engine || found.equivalent.contains(&outcome.engine));
    let scheme = scheme(found, outcome.timestep);
    let text = match found.undecided {
        Some(Undecided::Near) if outcome.kind == SolverKind::Rapier => format!(
            "its law is {scheme}, but its sweeps have not converged: a step is off by {}",
            share(found)
        ),
        Some(Undecided::Near) => format!(
            "step by step it is nearly {scheme}: off by {}",
            share(found)
        ),
        None => format!("step by step it is {scheme}"),
        Some(Undecided::DataTooCoarse) => {
            let why = "which at this step and with these digits cannot be told from";
            format!(
                "step by step it is {scheme}, {why} {}",
                listed_names(&found.equivalent)
            )
        }
        Some(Undecided::SameMap) => {
            let why = "which here is the same as";
            format!(
                "step by step it is {scheme}, {why} {}",
                listed_names(&found.equivalent)
            )
        }
    };
    let text = format!("{text}{}", at_contact(found));
    (!itself).then_some(text)
}

/// What it does at contact, as a clause; empty where that is an impulse at the impact.
fn at_contact(found: &Identity) -> String {
    let Some(contact) = &found.contact else {
        return String::new();
    };
    if contact.treatment.is_none() {
        return format!("; {}", words::one_line(&contact.says));
    }
    let mut numbers = Vec::new();
    if let (Some(stiffness), Some(damping)) = (contact.stiffness_n_m, contact.damping_n_s_m) {
        numbers.push(format!("{} N/m", words::short(stiffness)));
        numbers.push(format!("{} N s/m", words::short(damping)));
    }
    // What is less deep is there by rounding.
    if contact.deepest_m > 1e-12 {
        numbers.push(format!("{} m deep", words::short(contact.deepest_m)));
    }
    let numbers = match numbers.is_empty() {
        true => String::new(),
        false => format!(": {}", numbers.join(", ")),
    };
    let others = match contact.equivalent.as_slice() {
        [] => String::new(),
        others => format!(
            " (these steps do not tell it from {})",
            listed_names(others)
        ),
    };
    let says = match contact.says.as_str() {
        "" if others.is_empty() => return String::new(),
        "" => "has an impulse at each impact".to_owned(),
        says => format!("{}{numbers}", words::one_line(says)),
    };
    format!("; at contact it {says}{others}")
}

/// `0.3 % of what a step moves`.
fn share(found: &Identity) -> String {
    let relative = found.relative.unwrap_or(f64::NAN);
    if relative < 1e-6 {
        return format!("{} of what a step moves", words::short_sci(relative));
    }
    if relative > 2.0 {
        return format!("{} times what a step moves", words::short(relative));
    }
    format!("{} % of what a step moves", words::short(100.0 * relative))
}

/// What a trajectory deviates in.
fn explained(explained: &Explained) -> String {
    let says: Vec<&str> = explained
        .deviations
        .iter()
        .map(|d| d.sentence.as_str())
        .collect();
    let says = words::one_line(&says.join(", and "));
    let residual = words::short_sci(explained.residual);
    let Some(scheme) = &explained.scheme else {
        return match says.as_str() {
            "" => "no known scheme explains its steps".to_owned(),
            says => format!(
                "no known scheme explains its steps; least is left if {says}: {residual} of rounding"
            ),
        };
    };
    if scheme == TRUTH {
        return "step by step it is exact to rounding: it steps finer than its rows lie apart, and no scheme can be \
                told from them"
            .to_owned();
    }
    let left = explained.largest_at.map_or(String::new(), |step| {
        format!(" (what is left is {residual} of rounding, and largest at step {step})")
    });
    let others = match explained.equivalent.as_slice() {
        [] => String::new(),
        others => format!(
            "; the data cannot tell the scheme from {}",
            listed_names(others)
        ),
    };
    format!(
        "step by step it is {}, but {says}{left}{others}",
        words::one_line(scheme),
    )
}

/// `implicit_euler at h/4 = 0.000125 s`.
fn scheme(found: &Identity, timestep: f64) -> String {
    let name = words::one_line(&found.method);
    let (n, known) = (found.substeps, integrators::find(&found.method).is_some());
    match (n, known) {
        (1, _) => name,
        (_, true) => {
            let step = words::short(timestep / f64::from(n));
            format!("{name} at h/{n} = {step} s")
        }
        _ if name.starts_with("stopped") => format!("{name} after {n} iterations"),
        _ => format!("{name} in {n} substeps"),
    }
}

fn listed_names(all: &[String]) -> String {
    let names = all.iter().take(MAX_NAMED);
    let mut names: Vec<String> = names.map(|name| words::one_line(name)).collect();
    let more = all.len() - names.len();
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
            "step {step}, from t = {} s: {what} of particle {}",
            words::short(fault.t_s),
            words::one_line(&called(&report.header.scene.objects, *particle))
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
    let fault_says = fault.as_ref().map(|fault| {
        let (step, says) = (fault.step, words::one_line(&fault.explanation));
        format!("{name}, step {step}: {says}")
    });
    let Some(found) = &outcome.identified else {
        if fault_says.is_some() {
            return fault_says;
        }
        let Some(why) = &outcome.explained else {
            return Some(format!("{name} holds too few steps to be replayed"));
        };
        let says = explained(why);
        return Some(match says.strip_prefix("step by step it is ") {
            Some(says) => format!("{name} is {says}"),
            None => says.replacen("its steps", &name, 1),
        });
    };
    let scheme = scheme(found, outcome.timestep);
    let mistake = outcome.explained.is_some() && found.undecided != Some(Undecided::Near);
    let Some(fault) = fault else {
        let says = found
            .says
            .as_ref()
            .map_or(String::new(), |says| format!(": {says}"));
        let contact = at_contact(found);
        let missed = laws::missed(outcome);
        let missed: String = missed
            .iter()
            .map(|missed| format!("; but {missed}"))
            .collect();
        let judged = found
            .contact
            .as_ref()
            .is_none_or(|contact| !contact.unjudged);
        let where_ = match judged && missed.is_empty() {
            true => "throughout",
            false => "away from contact",
        };
        let text = match found.undecided {
            None => format!("{name} follows {scheme} {where_}{says}"),
            Some(Undecided::SameMap) => {
                let same = listed_names(&found.equivalent);
                format!("{name} follows {scheme} {where_}{says}; here it is the same as {same}")
            }
            Some(Undecided::DataTooCoarse) => {
                let others = listed_names(&found.equivalent);
                format!("{name} follows {scheme}{says}; the data cannot tell it from {others}")
            }
            Some(Undecided::Near) if found.relative.is_none_or(|off| off < NOTHING) => {
                format!("{name} follows {scheme} in most steps, and no known scheme in the others")
            }
            Some(Undecided::Near) => format!("{name} is nearly {scheme}: off by {}", share(found)),
        };
        return Some(format!("{text}{contact}{missed}"));
    };
    let (step, says) = (fault.step, words::one_line(&fault.explanation));
    let contact = found.contact.as_ref();
    if let Some(contact) = contact.filter(|contact| !contact.unjudged)
        && (contact.treatment.is_none() || !contact.mistakes.is_empty())
    {
        // The same mistakes in another way or place are no news.
        let own = |label: &&String| {
            let has = |id: &String| label.split('+').any(|part| part == id);
            !contact.mistakes.iter().all(has)
        };
        let others: Vec<String> = contact.equivalent.iter().filter(own).cloned().collect();
        let others = match others.as_slice() {
            [] => String::new(),
            others => format!(
                " (these steps do not tell it from {})",
                listed_names(others)
            ),
        };
        let missed = laws::missed(outcome);
        let missed: String = missed.iter().map(|missed| format!("; {missed}")).collect();
        return Some(format!(
            "{name} follows {scheme} away from contact, but {says}, first in step {step}{others}{missed}"
        ));
    }
    Some(match found.undecided {
        Some(Undecided::Near) => format!("{name}, step {step}: {says}"),
        _ if !mistake => format!("{name} is {scheme} but for step {step}: {says}"),
        // A scheme that remembers the previous step deviates first in the second.
        _ if step < 2 => format!("{name} is {scheme}: {says}"),
        _ => format!("{name} is {scheme} from step {step} on: {says}"),
    })
}
