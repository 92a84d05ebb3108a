//! One look per engine, the same in every figure: colours a colour-blind reader tells apart
//! (Okabe and Ito, without the yellow that white swallows), dashes for rapier.

use super::canvas::{Mark, Stroke};
use crate::outcome::{Cell, CostCurve, EnergyClass, Kind, Outcome, Report, Status};

const COLOURS: [&str; 7] = [
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#882255",
];
/// Tells apart the integrators that share a colour.
const ROUNDS: [&str; 3] = ["", "1.5 2", "6 2 1 2"];
/// Tells them apart where points are marked.
const MARKS: [Mark; 4] = [Mark::Disc, Mark::Square, Mark::Diamond, Mark::Triangle];
/// The second, which mostly lies on the scene's own integrator, is thin enough to leave it in sight.
const RAPIER: [(&str, &str, f64); 3] = [
    ("#000000", "7 4", 1.6),
    ("#000000", "2 4", 1.0),
    ("#000000", "9 3 2 3", 1.6),
];

/// The truth: a pale band that every other line runs on, or off.
pub const TRUTH: Stroke = Stroke {
    colour: "#c4c4c4",
    dash: "",
    width: 6.0,
};

/// What becomes of a run, from light to dark: told apart in grey and by colour-blind readers alike.
pub fn cell(cell: Cell) -> &'static str {
    match cell {
        Cell::Stable => "#e3eef6",
        Cell::Dissipating => "#8fbfe0",
        Cell::Growing => "#d55e00",
        Cell::Failed => "#3b1c32",
    }
}

/// Where something holds, and where it does not.
pub const HOLDS: [&str; 2] = ["#0072b2", "#f1ece4"];

/// A line over cells of any colour, and the wider one below it that sets it off.
pub const BOUNDARY: [Stroke; 2] = [
    Stroke {
        colour: "#ffffff",
        dash: "",
        width: 3.6,
    },
    Stroke {
        colour: "#000000",
        dash: "",
        width: 1.6,
    },
];

/// The look of the outcome's engine.
pub fn stroke(report: &Report, outcome: &Outcome) -> Stroke {
    let mut seen: Vec<&str> = Vec::new();
    for other in report.outcomes.iter().filter(|o| o.kind == outcome.kind) {
        if other.engine == outcome.engine {
            break;
        }
        if !seen.contains(&other.engine.as_str()) {
            seen.push(&other.engine);
        }
    }
    let own = outcome.engine == report.scene.own_method;
    look(outcome.kind, seen.len(), own)
}

/// The look of the engine that is number `place` of its kind.
fn look(kind: Kind, place: usize, own: bool) -> Stroke {
    match kind {
        Kind::Rapier => {
            let (colour, dash, width) = RAPIER[place % RAPIER.len()];
            Stroke {
                colour,
                dash,
                width,
            }
        }
        Kind::External => Stroke {
            colour: "#000000",
            dash: ROUNDS[place % ROUNDS.len()],
            width: 2.4,
        },
        Kind::Integrator => Stroke {
            colour: COLOURS[place % COLOURS.len()],
            dash: ROUNDS[place / COLOURS.len() % ROUNDS.len()],
            width: if own { 3.0 } else { 1.5 },
        },
    }
}

/// Looks of lines whose points are marked: what shares a colour differs in its marks, so that only
/// what is no integrator is dashed.
pub fn marked(report: &Report, curves: &[CostCurve]) -> Vec<(Stroke, Mark)> {
    let look = |(at, curve): (usize, &CostCurve)| {
        let before = curves.iter().take(at);
        let place = before.filter(|other| other.kind == curve.kind).count();
        let own = curve.engine == report.scene.own_method;
        let mut stroke = look(curve.kind, place, own);
        if curve.kind == Kind::Integrator {
            stroke.dash = "";
            return (stroke, MARKS[place / COLOURS.len() % MARKS.len()]);
        }
        (stroke, MARKS[place % MARKS.len()])
    };
    curves.iter().enumerate().map(look).collect()
}

/// The look of the n-th timestep, where a panel belongs to one engine.
pub fn timestep(place: usize) -> Stroke {
    look(Kind::Integrator, place, false)
}

/// The truth where lines are to be compared with it one by one.
pub const TRUTH_LINE: Stroke = Stroke {
    colour: "#000000",
    dash: "",
    width: 2.6,
};

/// An error asked about.
pub const TARGET: Stroke = Stroke {
    colour: "#6b6b6b",
    dash: "5 4",
    width: 0.8,
};

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
        _ if outcome.engine == report.scene.own_method => 2,
        _ => 1,
    }
}
