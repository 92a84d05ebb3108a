//! The table of outcomes.

use super::WIDTH;
use super::columns::{Column, fitted, laid_out};
use super::fit::{clip, pad, wrap};
use super::paint::{Tone, mark};
use crate::outcome::{EnergyClass, Outcome, Report, Status};
use crate::report::notes::{references, several_timesteps};
use crate::report::words::{self, NOTHING};
use comfy_table::CellAlignment;

/// The table's lines and its legend.
pub fn table(report: &Report) -> Vec<String> {
    let (columns, left_out) = match fitted(columns(report, ' ')) {
        (columns, left_out) if left_out.is_empty() => (columns, left_out),
        _ => fitted(columns(report, '\n')),
    };
    let mut lines = laid_out(&columns);
    let legend = wrap(&legend(report, &left_out), WIDTH, "");
    lines.extend(legend.iter().map(|line| mark(Tone::Dim, line)));
    lines
}

/// `fold` stands between the parts of a header that may go on two lines.
fn columns(report: &Report, fold: char) -> Vec<Column> {
    use CellAlignment::{Left, Right};
    let outcomes = &report.outcomes;
    let column =
        |header: &str, alignment, spare, cell: &dyn Fn(&Outcome) -> (String, Option<Tone>)| {
            let cells = outcomes.iter().map(cell).collect();
            Column {
                header: header.into(),
                alignment,
                spare,
                cells,
            }
        };
    let mut columns = vec![column("  engine", Left, 0, &|o| engine(report, o))];
    if several_timesteps(report) {
        columns.push(column("h (s)", Right, 0, &|o| {
            (words::short(o.timestep), None)
        }));
    }
    columns.push(column("status", Left, 0, &status));
    let classes = class_width(outcomes);
    columns.push(column("energy", Left, 0, &|o| energy(o, classes)));
    for (rank, reference) in references(report).into_iter().enumerate() {
        let name = clip(&words::one_line(reference), 14);
        let header = match fold {
            '\n' => format!("m from\n{}", name.replace('-', "-\n")),
            _ => format!("m from\n{name}"),
        };
        let cell = |o: &Outcome| (deviation(o, reference), None);
        columns.push(column(&header, Right, rank as u8, &cell));
    }
    if outcomes.iter().any(|o| o.position_error_m.is_some()) {
        columns.push(column("m from\ntruth", Right, 0, &|o| {
            (error(report, o), None)
        }));
    }
    columns.push(column("force\nevals", Right, 2, &|o| (forces(o), None)));
    columns.push(column("time", Right, 0, &|o| (words::wall_time(o), None)));
    // A trajectory from a file has neither.
    columns.retain(|column| !column.is_empty());
    columns
}

fn engine(report: &Report, outcome: &Outcome) -> (String, Option<Tone>) {
    let own = outcome.engine == report.scene.own_method;
    let name = words::one_line(&words::engine(outcome));
    if own {
        (format!("▸ {name}"), Some(Tone::Strong))
    } else {
        (format!("  {name}"), None)
    }
}

fn status(outcome: &Outcome) -> (String, Option<Tone>) {
    let tone = match outcome.status {
        Status::Completed => None,
        Status::Diverged | Status::Failed => Some(Tone::Bad),
        Status::Unsupported => Some(Tone::Dim),
    };
    (words::status(outcome.status).into(), tone)
}

/// Columns of the longest class word, so that the numbers line up.
fn class_width(outcomes: &[Outcome]) -> usize {
    let classes = outcomes.iter().filter_map(|o| o.energy.as_ref()?.class);
    classes.map(|c| words::class(c).len()).max().unwrap_or(0)
}

fn energy(outcome: &Outcome, classes: usize) -> (String, Option<Tone>) {
    let Some(energy) = &outcome.energy else {
        return (NOTHING.into(), None);
    };
    let number = words::energy_error(energy);
    let Some(class) = energy.class else {
        let number = if number.is_empty() { NOTHING } else { &number };
        return (number.into(), None);
    };
    let tone = match class {
        EnergyClass::Bounded => Tone::Good,
        EnergyClass::Drifting => Tone::Warn,
        EnergyClass::Growing => Tone::Bad,
        EnergyClass::Dissipating => Tone::Cool,
    };
    let text = format!("{} {number}", pad(words::class(class), classes));
    (text.trim_end().into(), Some(tone))
}

fn deviation(outcome: &Outcome, reference: &str) -> String {
    if outcome.engine == reference {
        return NOTHING.into();
    }
    let deviation = outcome.deviation_m.get(reference);
    deviation.map_or(NOTHING.into(), |d| words::sci(d.max))
}

fn error(report: &Report, outcome: &Outcome) -> String {
    let error = outcome.position_error_m.as_ref();
    error.map_or(NOTHING.into(), |e| words::truth_error(e.max, &report.truth))
}

fn forces(outcome: &Outcome) -> String {
    outcome
        .work
        .force_evaluations
        .map_or(NOTHING.into(), words::count)
}

fn legend(report: &Report, left_out: &[String]) -> String {
    let scale = match report.scene.energy_scale_j {
        Some(scale) => format!("over S = {} J", words::short(scale)),
        None => "(this scene has no scale)".into(),
    };
    let mut text = format!("▸ own integrator | energy: largest error {scale}");
    if report.outcomes.iter().any(|o| !o.deviation_m.is_empty()) {
        text += " | m from: largest distance of a particle";
    }
    let at_floor = |o: &Outcome| error(report, o) == "floor";
    if report.outcomes.iter().any(at_floor) {
        text += " | floor: below ten times the truth's own error";
    }
    if !left_out.is_empty() {
        text += &format!(" | left out for width: {}", left_out.join(", "));
    }
    text
}
