//! The table of outcomes: columns are built whole, the least telling ones left out where the width
//! does not hold them, and the engine's name is cut last.

use super::WIDTH;
use super::fit::{clip, pad, width, wrap};
use super::paint::{Tone, mark};
use crate::outcome::{EnergyClass, Outcome, Report, Status};
use crate::report::notes::{references, several_timesteps};
use crate::report::words::{self, NOTHING};
use comfy_table::{Cell, CellAlignment, ContentArrangement, LineStyle, Table, TableStyle};

const STYLE: TableStyle = TableStyle::new().header_separator(LineStyle::none().fill('─'));
/// Spaces between columns.
const GAP: usize = 2;
/// An engine's name is not cut below this while another column can go.
const NAME: usize = 28;

struct Column {
    /// Lines separated by `\n`.
    header: String,
    alignment: CellAlignment,
    /// Columns with the highest number leave first; 0 stays.
    spare: u8,
    cells: Vec<(String, Option<Tone>)>,
}

impl Column {
    fn width(&self) -> usize {
        let cells = self.cells.iter().map(|(text, _)| width(text));
        let header = self.header.lines().map(width);
        cells.chain(header).max().unwrap_or(0)
    }
}

/// The table's lines and its legend.
pub fn table(report: &Report) -> Vec<String> {
    let (columns, left_out) = match fitted(columns(report, ' ')) {
        (columns, left_out) if left_out.is_empty() => (columns, left_out),
        _ => fitted(columns(report, '\n')),
    };
    let mut lines: Vec<String> = laid_out(&columns)
        .trim_fmt()
        .lines()
        .map(str::to_string)
        .collect();
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
    let empty = |c: &Column| !c.cells.is_empty() && c.cells.iter().all(|(text, _)| text == NOTHING);
    columns.retain(|column| !empty(column));
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

/// What fits, and the headers of what does not.
fn fitted(mut columns: Vec<Column>) -> (Vec<Column>, Vec<String>) {
    let mut left_out = Vec::new();
    loop {
        let rest: usize = columns[1..].iter().map(|c| c.width() + GAP).sum();
        let room = WIDTH.saturating_sub(rest);
        let spare = (1..columns.len()).max_by_key(|&i| columns[i].spare);
        match spare {
            Some(i) if columns[0].width().min(NAME) > room && columns[i].spare > 0 => {
                left_out.push(
                    columns
                        .remove(i)
                        .header
                        .replace("-\n", "-")
                        .replace('\n', " "),
                );
            }
            _ => {
                for (text, _) in &mut columns[0].cells {
                    *text = clip(text, room);
                }
                return (columns, left_out);
            }
        }
    }
}

fn laid_out(columns: &[Column]) -> Table {
    let mut table = Table::new();
    table.load_style(STYLE);
    table.set_content_arrangement(ContentArrangement::Disabled);
    let height = columns
        .iter()
        .map(|c| c.header.lines().count())
        .max()
        .unwrap_or(1);
    table.set_header(columns.iter().map(|column| {
        // Headers stand on the rule: shorter ones start lower.
        let above = "\n".repeat(height - column.header.lines().count());
        Cell::new(above + &column.header).set_alignment(column.alignment)
    }));
    for row in 0..columns[0].cells.len() {
        table.add_row(columns.iter().map(|column| {
            let (text, tone) = &column.cells[row];
            let text = tone.map_or_else(|| text.clone(), |tone| mark(tone, text));
            Cell::new(text).set_alignment(column.alignment)
        }));
    }
    let last = columns.len() - 1;
    for (i, column) in table.column_iter_mut().enumerate() {
        column.set_padding((0, if i == last { 0 } else { GAP as u16 }));
    }
    table
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
