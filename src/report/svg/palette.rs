//! One look per engine, the same in every figure: colours a colour-blind reader tells apart
//! (Okabe and Ito, without the yellow that white swallows), dashes for rapier.

use super::canvas::{Shape, Stroke};
use crate::outcome::{Cell, CostCurve, EnergyClass, Kind, Outcome, Report, Status};
use std::collections::BTreeSet;

const COLOURS: [&str; 7] = [
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#882255",
];
/// Tells apart the integrators that share a colour.
const ROUNDS: [&str; 3] = ["", "1.5 2", "6 2 1 2"];
/// Tells them apart where points are marked.
const SHAPES: [Shape; 4] = [Shape::Disc, Shape::Square, Shape::Diamond, Shape::Triangle];
/// The second, which mostly lies on the scene's own integrator, is thin enough to leave it in sight.
const RAPIER: [(&str, f64); 3] = [("7 4", 1.6), ("2 4", 1.0), ("9 3 2 3", 1.6)];
const BLACK: &str = "#000000";

/// The truth: a pale band that every other line runs on, or off.
pub const TRUTH: Stroke = Stroke::new("#c4c4c4", "", 6.0);

/// What becomes of a run, from light to dark: told apart in grey and by colour-blind readers alike.
pub const CELLS: [(Cell, &str, &str); 4] = [
    (Cell::Stable, "stable", "#e3eef6"),
    (Cell::Dissipating, "dissipating", "#8fbfe0"),
    (Cell::Growing, "growing", "#d55e00"),
    (Cell::Failed, "failed", "#3b1c32"),
];

/// Where something holds, and where it does not.
pub const HOLDS: [&str; 2] = ["#0072b2", "#f1ece4"];

/// A line over cells of any colour, and the wider one below it that sets it off.
pub const BOUNDARY: [Stroke; 2] = [Stroke::new("#ffffff", "", 3.6), Stroke::new(BLACK, "", 1.6)];

/// The look of the outcome's engine.
pub fn stroke(report: &Report, outcome: &Outcome) -> Stroke {
    let alike = report.outcomes().iter().filter(|o| o.kind == outcome.kind);
    let engines = alike.map(|o| &o.engine);
    let before: BTreeSet<&String> = engines.take_while(|e| **e != outcome.engine).collect();
    let own = outcome.engine == report.header.scene.own_integrator;
    look(outcome.kind, before.len(), own)
}

/// The look of the engine that is number `place` of its kind.
fn look(kind: Kind, place: usize, own: bool) -> Stroke {
    let round = |at: usize| ROUNDS[at % ROUNDS.len()];
    match kind {
        Kind::Rapier => {
            let (dash, width) = RAPIER[place % RAPIER.len()];
            Stroke::new(BLACK, dash, width)
        }
        Kind::External => Stroke::new(BLACK, round(place), 2.4),
        Kind::Integrator => {
            let width = if own { 3.0 } else { 1.5 };
            let dash = round(place / COLOURS.len());
            Stroke::new(COLOURS[place % COLOURS.len()], dash, width)
        }
    }
}

/// Looks of lines whose points are marked: what shares a colour differs in its marks, so that only
/// what is no integrator is dashed.
pub fn marked(report: &Report, curves: &[CostCurve]) -> Vec<(Stroke, Shape)> {
    let look = |(at, curve): (usize, &CostCurve)| {
        let before = curves.iter().take(at);
        let place = before.filter(|other| other.kind == curve.kind).count();
        let own = curve.engine == report.header.scene.own_integrator;
        let mut stroke = look(curve.kind, place, own);
        if curve.kind == Kind::Integrator {
            stroke.dash = "";
            return (stroke, SHAPES[place / COLOURS.len() % SHAPES.len()]);
        }
        (stroke, SHAPES[place % SHAPES.len()])
    };
    curves.iter().enumerate().map(look).collect()
}

/// The look of the n-th timestep, where a panel belongs to one engine.
pub fn timestep(place: usize) -> Stroke {
    look(Kind::Integrator, place, false)
}

/// The truth where lines are to be compared with it one by one.
pub const TRUTH_LINE: Stroke = Stroke::new(BLACK, "", 2.6);

/// An error asked about.
pub const TARGET: Stroke = Stroke::new("#6b6b6b", "5 4", 0.8);

/// Where errors cannot be told from the truth's own.
pub const BELOW_FLOOR: &str = "#efefef";

/// Runs that may leave the picture: unfinished ones and those that gain energy.
pub fn is_wild(outcome: &Outcome) -> bool {
    let class = outcome.energy.as_ref().and_then(|e| e.class);
    outcome.status != Status::Completed || class == Some(EnergyClass::Growing)
}

/// Painted first to last: wild runs below, then the integrators with the scene's own on top, then
/// rapier's dashes, which let what they cover show through.
pub fn layer(report: &Report, outcome: &Outcome) -> u8 {
    match outcome.kind {
        Kind::Rapier => 3,
        _ if is_wild(outcome) => 0,
        _ if outcome.engine == report.header.scene.own_integrator => 2,
        _ => 1,
    }
}
