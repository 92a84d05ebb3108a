//! From points to curves and answers.

use super::CostChoice;
use super::errors::Errors;
use super::sweep::{Sweep, Swept};
use crate::scene::Scene;
use crate::solvers::Kind;
use crate::solvers::Solver;
use crate::truth::TruthKind;
use crate::verbs::cost::rank;
use crate::verbs::cost::{Cost, CostCurve};

pub fn answer(
    scene: &Scene,
    errors: &Errors,
    choice: &CostChoice,
    sweeps: &[Sweep],
    swept: Vec<Swept>,
) -> Cost {
    let curves: Vec<CostCurve> = sweeps
        .iter()
        .zip(swept)
        .map(|(sweep, swept)| curve(sweep, swept))
        .collect();
    let target = |&error: &f64| rank::target(&curves, error, unjudged(errors, error));
    Cost {
        duration_s: scene.duration,
        horizon_s: errors.floor().map(|_| errors.truth.horizon),
        floor_m: errors.floor(),
        targets: choice.targets.iter().map(target).collect(),
        curves,
    }
}

fn curve(sweep: &Sweep, swept: Swept) -> CostCurve {
    let points = swept.points;
    let slope = rank::slope(&points);
    CostCurve {
        engine: sweep.solver.id.to_string(),
        kind: sweep.solver.kind,
        order: sweep.order,
        observed_order: slope.as_ref().map(|slope| slope.order),
        slope_points: slope.map_or_else(Vec::new, |slope| slope.points),
        pareto: rank::pareto(&points),
        points,
        explanation: explanation(&sweep.solver),
    }
}

/// Why a reference engine's line is what it is: it is explained and not ranked.
fn explanation(solver: &Solver) -> Option<String> {
    let rapier = solver.kind == Kind::Rapier;
    rapier.then(|| match (solver.dissipates(), solver.follows) {
        (None, Some(method)) => format!(
            "it moves its bodies by {} under the forces computed here, so its errors are that method's, \
             and what it takes longer is the engine around it",
            method.id
        ),
        _ => "its spring joints are linearly implicit Euler at h = dt over its iterations, a method of \
              order 1: a tenth of the error takes ten times the steps, each a solve of all joints among \
              bodies; distance from the truth at its usual steps is a choice (stability at any stiffness, \
              a world that also has contacts), not a fault"
            .to_owned(),
    })
}

/// Why the truth cannot tell who is within this error, m.
fn unjudged(errors: &Errors, error: f64) -> Option<String> {
    match errors.floor() {
        None if errors.truth.kind == TruthKind::None => Some(format!(
            "no truth to hold errors against: {}",
            errors.truth.reason
        )),
        Some(floor) if error < floor => {
            Some(format!("below the truth's own floor of {floor:.1e} m"))
        }
        _ => None,
    }
}
