//! From points to curves and answers.

use super::CostChoice;
use super::entrant::Entrant;
use super::lane::Lane;
use super::sweep::Swept;
use super::witness::Witness;
use crate::measure::cost::{self, Judged};
use crate::outcome::{Cost, CostCurve, CostPanels, TruthKind};
use crate::scene::Scene;

pub(super) fn answer(
    scene: &Scene,
    witness: &Witness,
    choice: &CostChoice,
    lanes: &[Lane],
    swept: Vec<Swept>,
    panels: Option<CostPanels>,
) -> Cost {
    let curves: Vec<CostCurve> = lanes
        .iter()
        .zip(swept)
        .map(|(lane, swept)| curve(&lane.entrant, swept))
        .collect();
    let target = |&error: &f64| cost::target(&curves, error, &judged(witness, error));
    Cost {
        duration_s: scene.duration,
        horizon_s: witness.floor().map(|_| witness.truth.horizon),
        floor_m: witness.floor(),
        targets: choice.targets.iter().map(target).collect(),
        panels,
        remarks: Vec::new(),
        curves,
    }
}

fn curve(entrant: &Entrant, swept: Swept) -> CostCurve {
    let points = swept.points;
    let slope = cost::slope(&points);
    CostCurve {
        engine: entrant.id.clone(),
        kind: entrant.kind,
        order: entrant.order,
        observed_order: slope.as_ref().map(|slope| slope.order),
        slope_points: slope.map_or_else(Vec::new, |slope| slope.points),
        pareto: cost::pareto(&points),
        points,
        explanation: entrant.explanation.clone(),
    }
}

/// Whether the truth can tell who is within this error, m.
fn judged(witness: &Witness, error: f64) -> Judged {
    match witness.floor() {
        None if witness.truth.kind == TruthKind::None => Judged::No(format!(
            "no truth to hold errors against: {}",
            witness.truth.reason
        )),
        Some(floor) if error < floor => {
            Judged::No(format!("below the truth's own floor of {floor:.1e} m"))
        }
        _ => Judged::Yes,
    }
}
