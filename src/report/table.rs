//! Tables: each column is declared once, with its headers in the terminal and in Markdown. Where the
//! terminal is too narrow, the least important columns are left out first; the engine's name, in the first
//! column, is cut last.

use super::OWN;
use super::terminal::{Tone, clip, mark, width, wrap};
use super::words::{NOTHING, escape, one_line};
use comfy_table::{Cell, CellAlignment, ContentArrangement, LineStyle, TableStyle};

const STYLE: TableStyle = TableStyle::new().header_separator(LineStyle::none().fill('─'));
/// Spaces between columns.
const GAP: usize = 2;
/// An engine's name is not cut below this width while another column can be left out.
const MIN_NAME_WIDTH: usize = 28;
/// Nor below this width while there is any other column but one.
const LEAST_NAME_WIDTH: usize = 12;

/// Rows, and the columns declared over them.
pub struct Table<'a, R> {
    rows: &'a [R],
    columns: Vec<Column>,
}

/// One column with its cells.
struct Column {
    /// The header in the terminal, where `\n` folds it, and in Markdown. An empty one hides the column there.
    headers: [String; 2],
    alignment: CellAlignment,
    /// Columns with the highest number are left out of the terminal first; 0 always stays.
    drop_order: u8,
    /// The texts, escaped for Markdown where they are not numbers.
    cells: Vec<(String, Option<Tone>)>,
}

impl<'a, R> Table<'a, R> {
    pub fn new(rows: &'a [R]) -> Self {
        let columns = Vec::new();
        Self { rows, columns }
    }

    /// The column of names, each with its mark: [`OWN`], [`UNRANKED`](super::UNRANKED) or a space.
    pub fn engines(&mut self, name: impl Fn(&R) -> (String, char)) {
        self.left("  engine", "", |row| {
            let (name, mark) = name(row);
            let tone = (mark == OWN).then_some(Tone::Strong);
            (format!("{mark} {}", one_line(&name)), tone)
        });
        self.markdown("engine", |row| match name(row) {
            (name, OWN) => format!("**{}**", escape(&name)),
            (name, _) => escape(&name),
        });
    }

    /// A column of words, which the terminal leaves out last.
    pub fn left(
        &mut self,
        terminal: &str,
        markdown: &str,
        cell: impl Fn(&R) -> (String, Option<Tone>),
    ) {
        self.add([terminal, markdown], CellAlignment::Left, 0, cell);
    }

    /// A column of numbers. The terminal leaves out columns with the highest `drop_order` first, and one
    /// with 0 only where names would be cut to nothing, the rightmost first.
    pub fn right<C: Into<Option<String>>>(
        &mut self,
        terminal: &str,
        markdown: &str,
        drop_order: u8,
        cell: impl Fn(&R) -> C,
    ) {
        let cell = |row: &R| (cell(row).into().unwrap_or(NOTHING.into()), None);
        self.add([terminal, markdown], CellAlignment::Right, drop_order, cell);
    }

    /// A column of numbers for the terminal alone, with tones.
    pub fn toned(
        &mut self,
        header: &str,
        drop_order: u8,
        cell: impl Fn(&R) -> (String, Option<Tone>),
    ) {
        self.add([header, ""], CellAlignment::Right, drop_order, cell);
    }

    /// A column for Markdown alone.
    pub fn markdown<C: Into<Option<String>>>(&mut self, header: &str, cell: impl Fn(&R) -> C) {
        self.right("", header, 0, cell);
    }

    fn add(
        &mut self,
        headers: [&str; 2],
        alignment: CellAlignment,
        drop_order: u8,
        cell: impl Fn(&R) -> (String, Option<Tone>),
    ) {
        self.columns.push(Column {
            headers: headers.map(str::to_owned),
            alignment,
            drop_order,
            cells: self.rows.iter().map(cell).collect(),
        });
    }

    /// Whether a terminal of this width has room for all columns.
    pub fn fits(&self, width: usize) -> bool {
        self.fitted(width).1.is_empty()
    }

    /// The lines of the table and its legend, in a terminal of this width. `legend` is given the headers of the columns left out for width;
    /// the same headers are appended to it, separated by `between`.
    pub fn in_terminal(
        &self,
        width: usize,
        between: &str,
        legend: impl FnOnce(&[String]) -> String,
    ) -> Vec<String> {
        let (columns, left_out) = self.fitted(width);
        let mut legend = legend(&left_out);
        if !left_out.is_empty() {
            legend += &format!(" | left out for width: {}", left_out.join(between));
        }
        let mut lines = laid_out(&columns, width);
        let legend = wrap(&legend, width, "");
        lines.extend(legend.iter().map(|line| mark(Tone::Dim, line)));
        lines
    }

    /// The columns the terminal shows, and the headers of those that do not fit.
    fn fitted(&self, width: usize) -> (Vec<&Column>, Vec<String>) {
        let mut columns: Vec<&Column> = self.columns.iter().filter(|c| c.is_shown()).collect();
        let mut left_out = Vec::new();
        // Of equal ones the last.
        while let Some(i) = (1..columns.len()).max_by_key(|&i| columns[i].drop_order)
            && let least = match columns[i].drop_order {
                0 if columns.len() > 2 => LEAST_NAME_WIDTH,
                0 => 0,
                _ => MIN_NAME_WIDTH,
            }
            && room(&columns, width) < columns[0].width().min(least)
        {
            let [header, _] = &columns.remove(i).headers;
            left_out.push(header.replace("-\n", "-").replace('\n', " "));
        }
        (columns, left_out)
    }

    pub fn in_markdown(&self) -> String {
        let columns = self.columns.iter().filter(|c| !c.headers[1].is_empty());
        let line = |cells: Vec<&str>| format!("| {} |\n", cells.join(" | "));
        let header = line(columns.clone().map(|c| c.headers[1].as_str()).collect());
        let rule = "---|".repeat(columns.clone().count());
        let row = |at: usize| line(columns.clone().map(|c| c.cells[at].0.as_str()).collect());
        let rows: String = (0..self.rows.len()).map(row).collect();
        format!("{header}|{rule}\n{rows}")
    }
}

impl Column {
    /// Whether the terminal shows the column: it has a header, and not every cell is empty.
    fn is_shown(&self) -> bool {
        let silent = !self.cells.is_empty() && self.cells.iter().all(|(text, _)| text == NOTHING);
        !self.headers[0].is_empty() && !silent
    }

    fn width(&self) -> usize {
        let cells = self.cells.iter().map(|(text, _)| text.as_str());
        let texts = cells.chain(self.headers[0].lines());
        texts.map(width).max().unwrap_or(0)
    }
}

/// The width the other columns leave to the first.
fn room(columns: &[&Column], width: usize) -> usize {
    let others: usize = columns[1..].iter().map(|c| c.width() + GAP).sum();
    width.saturating_sub(others)
}

/// The table as lines.
fn laid_out(columns: &[&Column], width: usize) -> Vec<String> {
    let mut table = comfy_table::Table::new();
    table.load_style(STYLE);
    table.set_content_arrangement(ContentArrangement::Disabled);
    let lines = |column: &Column| column.headers[0].lines().count();
    let height = columns.iter().map(|c| lines(c)).max().unwrap_or(1);
    table.set_header(columns.iter().map(|column| {
        // Headers are aligned at their last line, so shorter ones start lower.
        let above = "\n".repeat(height - lines(column));
        Cell::new(above + &column.headers[0]).set_alignment(column.alignment)
    }));
    let room = room(columns, width);
    for row in 0..columns[0].cells.len() {
        table.add_row(columns.iter().enumerate().map(|(i, column)| {
            let (text, tone) = &column.cells[row];
            let text = clip(text, if i == 0 { room } else { usize::MAX });
            let text = tone.map_or_else(|| text.clone(), |tone| mark(tone, &text));
            Cell::new(text).set_alignment(column.alignment)
        }));
    }
    let last = columns.len() - 1;
    for (i, column) in table.column_iter_mut().enumerate() {
        column.set_padding((0, if i == last { 0 } else { GAP as u16 }));
    }
    table.trim_fmt().lines().map(str::to_string).collect()
}
