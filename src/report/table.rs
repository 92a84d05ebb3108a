//! Tables: each column is declared once, with its headers in the terminal and in Markdown.

use super::terminal::WIDTH;
use super::terminal::columns::{Column, fitted, laid_out};
use super::terminal::fit::wrap;
use super::terminal::paint::{Tone, mark};
use super::words;
use super::words::escape;
use comfy_table::CellAlignment;

/// What sets an engine apart from the others of its table.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    Plain,
    /// The integrator the scene names.
    Own,
    /// Explained, not ranked.
    Unranked,
}

impl Mark {
    /// Of an engine that is ranked.
    pub fn of(engine: &str, own: &str) -> Self {
        if engine == own {
            Self::Own
        } else {
            Self::Plain
        }
    }
}

/// One line a row, and columns over them.
pub struct Table<'a, R> {
    rows: &'a [R],
    /// In the terminal; an empty header keeps the column out of it.
    terminal: Vec<Column>,
    /// Header and cells, escaped where they are not numbers; likewise.
    markdown: Vec<(String, Vec<String>)>,
}

impl<'a, R> Table<'a, R> {
    pub fn new(rows: &'a [R]) -> Self {
        Self {
            rows,
            terminal: Vec::new(),
            markdown: Vec::new(),
        }
    }

    /// The column of names.
    pub fn engines(&mut self, name: impl Fn(&R) -> (String, Mark)) {
        let shown = |row: &R| {
            let (name, mark) = name(row);
            let name = words::one_line(&name);
            match mark {
                Mark::Plain => (format!("  {name}"), None),
                Mark::Own => (format!("▸ {name}"), Some(Tone::Strong)),
                Mark::Unranked => (format!("† {name}"), None),
            }
        };
        self.left("  engine", "", shown);
        self.markdown("engine", |row| match name(row) {
            (name, Mark::Own) => format!("**{}**", escape(&name)),
            (name, _) => escape(&name),
        });
    }

    /// A column of words, which the terminal never leaves out.
    pub fn left(
        &mut self,
        terminal: &str,
        markdown: &str,
        cell: impl Fn(&R) -> (String, Option<Tone>),
    ) {
        let cells: Vec<_> = self.rows.iter().map(cell).collect();
        self.add(terminal, markdown, CellAlignment::Left, 0, cells);
    }

    /// A column of numbers. The terminal leaves out those with the highest `spare` first, and never one
    /// with 0.
    pub fn right(
        &mut self,
        terminal: &str,
        markdown: &str,
        spare: u8,
        cell: impl Fn(&R) -> String,
    ) {
        let cells = self.rows.iter().map(|row| (cell(row), None)).collect();
        self.add(terminal, markdown, CellAlignment::Right, spare, cells);
    }

    /// The same for the terminal alone, with tones.
    pub fn toned(&mut self, header: &str, spare: u8, cell: impl Fn(&R) -> (String, Option<Tone>)) {
        let cells = self.rows.iter().map(cell).collect();
        self.add(header, "", CellAlignment::Right, spare, cells);
    }

    /// A column of Markdown alone.
    pub fn markdown(&mut self, header: &str, cell: impl Fn(&R) -> String) {
        self.right("", header, 0, cell);
    }

    fn add(
        &mut self,
        terminal: &str,
        markdown: &str,
        alignment: CellAlignment,
        spare: u8,
        cells: Vec<(String, Option<Tone>)>,
    ) {
        if !markdown.is_empty() {
            let texts = cells.iter().map(|(text, _)| text.clone());
            self.markdown.push((markdown.to_owned(), texts.collect()));
        }
        if !terminal.is_empty() {
            self.terminal.push(Column {
                header: terminal.to_owned(),
                alignment,
                spare,
                cells,
            });
        }
    }

    /// Whether the terminal has room for all columns.
    pub fn fits(&self) -> bool {
        fitted(self.told()).1.is_empty()
    }

    /// The lines and their legend, which is told the headers of the columns left out for width and to
    /// which these are added, separated by `between`.
    pub fn in_terminal(
        &self,
        between: &str,
        legend: impl FnOnce(&[String]) -> String,
    ) -> Vec<String> {
        let (columns, left_out) = fitted(self.told());
        let mut legend = legend(&left_out);
        if !left_out.is_empty() {
            legend += &format!(" | left out for width: {}", left_out.join(between));
        }
        let mut lines = laid_out(&columns);
        let legend = wrap(&legend, WIDTH, "");
        lines.extend(legend.iter().map(|line| mark(Tone::Dim, line)));
        lines
    }

    /// The terminal's columns without those that say nothing.
    fn told(&self) -> Vec<Column> {
        let told = self.terminal.iter().filter(|column| !column.is_empty());
        told.cloned().collect()
    }

    pub fn in_markdown(&self) -> String {
        let line = |cells: Vec<&str>| format!("| {} |\n", cells.join(" | "));
        let header = line(
            self.markdown
                .iter()
                .map(|(header, _)| header.as_str())
                .collect(),
        );
        let rule = "---|".repeat(self.markdown.len());
        let row = |at: usize| {
            let cells = self.markdown.iter().filter_map(|(_, cells)| cells.get(at));
            line(cells.map(String::as_str).collect())
        };
        let rows: String = (0..self.rows.len()).map(row).collect();
        format!("{header}|{rule}\n{rows}\n")
    }
}
