//! Tables by column: the least telling ones are left out where the width does not hold them, and the
//! first, the engine's name, is cut last.

use super::WIDTH;
use super::fit::{clip, width};
use super::paint::{Tone, mark};
use crate::report::words::NOTHING;
use comfy_table::{Cell, CellAlignment, ContentArrangement, LineStyle, Table, TableStyle};

const STYLE: TableStyle = TableStyle::new().header_separator(LineStyle::none().fill('─'));
/// Spaces between columns.
const GAP: usize = 2;
/// An engine's name is not cut below this while another column can go.
const NAME: usize = 28;

/// One column, built whole.
#[derive(Clone)]
pub struct Column {
    /// Lines separated by `\n`.
    pub header: String,
    pub alignment: CellAlignment,
    /// Columns with the highest number leave first; 0 stays.
    pub spare: u8,
    pub cells: Vec<(String, Option<Tone>)>,
}

impl Column {
    /// Whether no cell of it says anything.
    pub fn is_empty(&self) -> bool {
        !self.cells.is_empty() && self.cells.iter().all(|(text, _)| text == NOTHING)
    }

    fn width(&self) -> usize {
        let cells = self.cells.iter().map(|(text, _)| width(text));
        let header = self.header.lines().map(width);
        cells.chain(header).max().unwrap_or(0)
    }
}

/// What fits, and the headers of what does not.
pub fn fitted(mut columns: Vec<Column>) -> (Vec<Column>, Vec<String>) {
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

/// The table as lines.
pub fn laid_out(columns: &[Column]) -> Vec<String> {
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
    table.trim_fmt().lines().map(str::to_string).collect()
}
