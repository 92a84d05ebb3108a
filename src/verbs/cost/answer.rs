//! Makes curves and the answer for each target from the points of all runs.

use super::CostChoice;
use super::runs::{Curve, Setup};
use super::settings::Sweep;
use crate::solvers::{Solver, SolverKind};
use crate::verbs::cost::rank;
use crate::verbs::cost::{Cost, CostCurve};

pub fn answer(setup: &Setup, choice: &CostChoice, sweeps: &[Sweep], curves: Vec<Curve>) -> Cost {
    let curve = |(sweep, curve): (&Sweep, Curve)| {
        let points = curve.points;
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
    };
    let curves: Vec<CostCurve> = sweeps.iter().zip(curves).map(curve).collect();
    let floor = setup.floor();
    let target = |&error: &f64| {
        // Why the truth cannot tell which solvers are within this error.
        let open = match floor {
            None => Some(format!(
                "no truth to hold errors against: {}",
                setup.truth.reason
            )),
            Some(floor) if error < floor => {
                Some(format!("below the truth's own floor of {floor:.1e} m"))
            }
            Some(_) => None,
        };
        rank::target(&curves, error, open)
    };
    Cost {
        duration_s: setup.scene.duration,
        horizon_s: floor.map(|_| setup.truth.horizon),
        floor_m: floor,
        targets: choice.targets.iter().map(target).collect(),
        curves,
    }
}

/// Why a reference engine's curve lies where it does: reference engines are explained, not ranked.
fn explanation(solver: &Solver) -> Option<String> {
    let rapier = solver.kind == SolverKind::Rapier;
    rapier.then(|| match (solver.by_design(true), solver.by_design(false), solver.follows) {
        (Some(gains), ..) => format!("it is of order 1: {gains}"),
        (None, None, Some(method)) => format!(
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
