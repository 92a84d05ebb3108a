//! One look per engine, the same in every figure of every scene: colours a colour-blind reader tells apart
//! (Okabe and Ito, without the yellow, which is too pale on white), dashes for rapier.

use super::canvas::{Stroke, SymbolShape};
use crate::integrators::{REGISTRY, USUAL};
use crate::solvers::{SolverKind, rapier};

pub const COLOURS: [&str; 7] = [
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#882255",
];
/// The dashes that tell apart integrators of one colour.
const ROUNDS: [&str; 4] = ["", "1.5 2", "6 2 1 2", "10 2"];
/// The symbols that tell them apart where points are marked.
pub const SHAPES: [SymbolShape; 4] = [
    SymbolShape::Disc,
    SymbolShape::Square,
    SymbolShape::Diamond,
    SymbolShape::Triangle,
];
/// The dashes and widths of rapier's lines. The second mostly lies on the scene's own integrator, so it is
/// thin enough to leave that in sight.
const RAPIER: [(&str, f64); 5] = [
    ("7 4", 1.6),
    ("2 4", 1.0),
    ("9 3 2 3", 1.6),
    ("2 2", 1.6),
    ("12 3", 1.0),
];
const BLACK: &str = "#000000";

/// The truth as a pale band, below every other line.
pub const TRUTH: Stroke = Stroke::new("#c4c4c4", "", 6.0);

/// The colours of where something holds, and where it does not.
pub const HOLDS: [&str; 2] = ["#0072b2", "#f1ece4"];

/// A spring and a rod of a shape, and the colour of a shape that another lies over.
pub const SPRING: Stroke = Stroke::new("#0072b2", "", 1.2);
pub const ROD: Stroke = Stroke::new("#4d4d4d", "", 2.4);
pub const BELOW: &str = "#b4b4b4";

/// The ring of a hinge, the dashes of an attraction, and the filling of triangles, light enough for springs on it.
pub const HINGE: &str = "#e69f00";
pub const ATTRACTION: Stroke = Stroke::new("#cc79a7", "6 4", 1.2);
pub const TRIANGLES: &str = "#e3eef6";

/// A line over cells of any colour: first the wider pale stroke that sets it off, then the line itself.
pub const BOUNDARY: [Stroke; 2] = [Stroke::new("#ffffff", "", 3.6), Stroke::new(BLACK, "", 1.6)];

/// The place of an engine's look among those of its kind. That of a method of the registry, and of rapier as it
/// ships, is its own wherever it stands; the usual methods come first, so that each of these has a colour to itself.
/// Any other engine takes its index `among` those of its kind in a report.
pub fn place(kind: SolverKind, engine: &str, among: usize) -> usize {
    let usual = USUAL.iter().copied();
    let others = REGISTRY.iter().map(|method| method.id);
    let others = others.filter(|id| !USUAL.contains(id));
    match kind {
        SolverKind::Integrator => usual
            .chain(others)
            .position(|id| id == engine)
            .unwrap_or(REGISTRY.len() + among),
        SolverKind::Rapier => {
            let known = rapier::IDS.iter().position(|id| *id == engine);
            known.unwrap_or(rapier::IDS.len() + among)
        }
        SolverKind::External => among,
    }
}

/// The look of an engine at this [`place`].
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Every method has a line and a symbol of its own, and the usual ones a colour of their own.
    #[test]
    fn no_two_methods_look_alike() {
        let places: Vec<usize> = REGISTRY
            .iter()
            .map(|method| place(SolverKind::Integrator, method.id, 99))
            .collect();
        let looks: Vec<_> = places
            .iter()
            .map(|&at| {
                let stroke = look(SolverKind::Integrator, at, false);
                let shape = SHAPES[at / COLOURS.len() % SHAPES.len()];
                (stroke.colour, stroke.dash, format!("{shape:?}"))
            })
            .collect();
        for (at, (colour, dash, shape)) in looks.iter().enumerate() {
            for (other, (colour2, dash2, shape2)) in looks.iter().enumerate().take(at) {
                let names = (REGISTRY[at].id, REGISTRY[other].id);
                assert!((colour, dash) != (colour2, dash2), "{names:?}");
                assert!((colour, shape) != (colour2, shape2), "{names:?}");
                let usual = |id| USUAL.contains(&id);
                assert!(
                    !(usual(names.0) && usual(names.1) && colour == colour2),
                    "{names:?}"
                );
            }
        }
    }
}
