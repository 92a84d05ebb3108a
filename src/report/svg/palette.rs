//! One look per engine, the same in every figure: colours a colour-blind reader tells apart
//! (Okabe and Ito, without the yellow, which is too pale on white), dashes for rapier.

use super::canvas::{Stroke, SymbolShape};
use crate::solvers::SolverKind;

pub const COLOURS: [&str; 7] = [
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#882255",
];
/// The dashes that tell apart integrators of one colour.
const ROUNDS: [&str; 3] = ["", "1.5 2", "6 2 1 2"];
/// The symbols that tell them apart where points are marked.
pub const SHAPES: [SymbolShape; 4] = [
    SymbolShape::Disc,
    SymbolShape::Square,
    SymbolShape::Diamond,
    SymbolShape::Triangle,
];
/// The dashes and widths of rapier's lines. The second mostly lies on the scene's own integrator, so it is
/// thin enough to leave that in sight.
const RAPIER: [(&str, f64); 3] = [("7 4", 1.6), ("2 4", 1.0), ("9 3 2 3", 1.6)];
const BLACK: &str = "#000000";

/// The truth as a pale band, below every other line.
pub const TRUTH: Stroke = Stroke::new("#c4c4c4", "", 6.0);

/// The colours of where something holds, and where it does not.
pub const HOLDS: [&str; 2] = ["#0072b2", "#f1ece4"];

/// A line over cells of any colour: first the wider pale stroke that sets it off, then the line itself.
pub const BOUNDARY: [Stroke; 2] = [Stroke::new("#ffffff", "", 3.6), Stroke::new(BLACK, "", 1.6)];

/// The look of an engine; `place` is its index among those of its kind.
pub fn look(kind: SolverKind, place: usize, own: bool) -> Stroke {
    let round = |at: usize| ROUNDS[at % ROUNDS.len()];
    match kind {
        SolverKind::Rapier => {
            let (dash, width) = RAPIER[place % RAPIER.len()];
            Stroke::new(BLACK, dash, width)
        }
        SolverKind::External => Stroke::new(BLACK, round(place), 2.4),
        SolverKind::Integrator => {
            let width = if own { 3.0 } else { 1.5 };
            let dash = round(place / COLOURS.len());
            Stroke::new(COLOURS[place % COLOURS.len()], dash, width)
        }
    }
}

/// The look of the timestep at this index, where a panel belongs to one engine.
pub fn timestep(place: usize) -> Stroke {
    look(SolverKind::Integrator, place, false)
}

/// The truth as a line, where others are compared with it one by one.
pub const TRUTH_LINE: Stroke = Stroke::new(BLACK, "", 2.6);

/// The line of a target.
pub const TARGET: Stroke = Stroke::new("#6b6b6b", "5 4", 0.8);

/// The colour of the area where errors cannot be told from the truth's own.
pub const BELOW_FLOOR: &str = "#efefef";
