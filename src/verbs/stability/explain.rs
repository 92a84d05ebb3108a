//! The remarks of a row: what prediction and measurement say, and why they differ.

use super::Shared;
use crate::integrators::{Amplification, Stage};
use crate::measure::stability::{Limit, MeasuredLimit, Prediction};
use crate::report::words::digits;
use crate::solvers::Solver;
use crate::verbs::stability::StabilityRow;

/// The relative resolution of limits.
const RESOLUTION: f64 = 1e-3;

/// The remarks of one row, sentence by sentence.
pub fn remarks(
    shared: &Shared,
    solver: &Solver,
    row: &StabilityRow,
    predicted: Option<&Prediction>,
    measured: &MeasuredLimit,
) -> Vec<String> {
    let mut remarks = Vec::new();
    match predicted.map(|predicted| (&predicted.limit, &predicted.reason)) {
        Some((Limit::Unknown(why), _)) => remarks.push(format!("not predicted: {why}")),
        Some((_, reason)) => remarks.extend(reason.clone()),
        None => {}
    }
    if let Limit::Unknown(why) = &measured.limit {
        remarks.push(format!("not measured: {why}"));
    }
    remarks.extend(measured.reason.clone());
    remarks.extend(tightest(shared, row));
    remarks.extend(predicted.and_then(|predicted| {
        let (from, to) = (&predicted.limit, &measured.limit);
        let amplification = solver.follows.map(|method| method.amplification);
        if shared.bounces() {
            differ(from, to).then(|| CONTACT.to_owned())
        } else if !shared.linear {
            difference(from, to)
        } else if !differ(from, to) {
            None
        } else if !measured.linear {
            Some(turning(amplification))
        } else if undoes(shared, amplification, to) {
            Some(BACKWARD.to_owned())
        } else {
            Some(FAULT.to_owned())
        }
    }));
    remarks
}

/// The tightest predicted limit along the trajectory, where it is below that of the start.
fn tightest(shared: &Shared, row: &StabilityRow) -> Option<String> {
    let tightest = row.tightest.as_ref()?;
    let method = shared.path.method?;
    let start = match row.predicted_limit_s {
        Some(limit) => limit,
        None if row.unconditional => f64::INFINITY,
        None => return None,
    };
    (tightest.limit_s < start * (1.0 - RESOLUTION)).then(|| {
        format!(
            "along the trajectory of {} the predicted limit is tightest at t = {} s: {} s",
            method.id,
            digits(tightest.t_s),
            digits(tightest.limit_s)
        )
    })
}

/// Whether the measured limit, or its whole bracket, is below the predicted one.
fn lower(predicted: &Limit, measured: &Limit) -> bool {
    match (predicted, measured) {
        (Limit::At(p), Limit::At(m)) => *m < p * (1.0 - RESOLUTION),
        (Limit::At(p), Limit::Between(_, high)) => high < p,
        _ => false,
    }
}

/// How the limits differ because the state moves away from where it was linearised.
fn difference(predicted: &Limit, measured: &Limit) -> Option<String> {
    let text = match (predicted, measured) {
        _ if lower(predicted, measured) => {
            "the measured limit is lower: forces are not linear, and predicted is small motion about the \
             start; farther from it they may be stiffer, or a step may fail"
        }
        (Limit::At(p), Limit::At(m)) if m > &(p * (1.0 + RESOLUTION)) => {
            "the measured limit is higher: forces are not linear, and growth ends where they no \
             longer are what they were at the start"
        }
        (Limit::Never, Limit::At(_) | Limit::Between(..) | Limit::Unconditional) => {
            "predicted to grow at every step, but forces are not linear: growth ends, or is too slow \
             to show over the steps taken"
        }
        (Limit::Unconditional, Limit::At(_) | Limit::Between(..) | Limit::Never) => {
            "predicted stable at every step: so it is on the forces as they are at the start, but these are \
             not linear"
        }
        (Limit::At(_), Limit::Unconditional) => {
            "beyond the predicted limit growth ends, since forces are not linear: bounded, but wrong"
        }
        (Limit::At(_), Limit::Never) => {
            "predicted stable where it was linearised, but unstable where the motion leads"
        }
        _ => return None,
    };
    Some(text.to_owned())
}

/// Whether the limits differ by more than twice the resolution: the search's own on top of one to be shown.
fn differ(predicted: &Limit, measured: &Limit) -> bool {
    match (predicted, measured) {
        (Limit::At(p), Limit::At(m)) => (m / p - 1.0).abs() > 2.0 * RESOLUTION,
        (Limit::At(p), Limit::Between(low, high)) => p < low || p > high,
        (Limit::Unknown(_), _) | (_, Limit::Unknown(_)) => false,
        (p, m) => p != m,
    }
}

/// The remark where obstacles give impulses.
const CONTACT: &str = "limits are predicted without contact, and measured with it";

/// The remark where the limits differ although a step is a linear map.
const FAULT: &str = "prediction and measurement disagree although a step here is a linear map: one of \
                     them is wrong";

/// The remark on linear forces for a method whose step is no linear map.
fn turning(amplification: Option<Amplification>) -> String {
    let why = match amplification {
        Some(Amplification::MaterialImplicit) => {
            ": it leaves out the stiffness across a spring, and which way that is turns with the \
             spring. Predicted for small motion about a spring that keeps its direction"
        }
        _ => ". Predicted for small motion about the start",
    };
    format!("its step is not linear, though every force is{why}")
}

/// A backward substep multiplies damped velocities by e to at most this: beyond, the rounding that forward
/// substeps leave grows as large as what they started from.
const MAX_UNDONE_DAMPING: f64 = 36.0;

const BACKWARD: &str = "beyond the measured limit its substeps backward in time undo more damping than \
                        doubles hold: they multiply what rounding left of the forward ones, which \
                        theory in exact arithmetic does not see";

fn undoes(shared: &Shared, amplification: Option<Amplification>, measured: &Limit) -> bool {
    let Some(Amplification::Composition(stages, _)) = amplification else {
        return false;
    };
    let backward = stages.iter().map(|stage| match stage {
        Stage::Kick(part) => -part,
        Stage::Drift(_) => 0.0,
    });
    let most = backward.fold(0.0, f64::max);
    let (Limit::At(h) | Limit::Between(_, h)) = measured else {
        return false;
    };
    most * h * shared.linearised.damping_max() > MAX_UNDONE_DAMPING
}
