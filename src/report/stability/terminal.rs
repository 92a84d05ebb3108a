//! The table of limits, the reasons, and a map in characters.

use super::{digits, facts, growth, limit, map_heading, measured, notes, place, ratio};
use crate::outcome::{Cell, MapPanel, Report, Stability, StabilityMap, StabilityRow};
use crate::report::terminal::columns::{Column, fitted, laid_out};
use crate::report::terminal::fit::{clip, pad, width, wrap};
use crate::report::terminal::paint::{Tone, mark};
use crate::report::terminal::{WIDTH, finished, scene};
use crate::report::words;
use comfy_table::CellAlignment::{Left, Right};

/// Values a map in characters has room for, one column each and its axis.
const COLUMNS: usize = 80;
/// Lines it may take.
const LINES: usize = 40;

/// The report with ANSI colours. Ends with the verdict and a newline.
pub fn render(report: &Report) -> String {
    let mut lines = scene(report);
    if let Some(stability) = &report.stability {
        for (label, text) in facts(stability) {
            let line = format!("{label:<9}{}", words::one_line(&text));
            lines.extend(wrap(&line, WIDTH, "         "));
        }
        lines.push(String::new());
        lines.extend(table(report, stability));
        lines.extend(map(report, stability));
        lines.extend(admissible(stability));
        lines.extend(reasons(stability));
    }
    finished(report, lines)
}

fn table(report: &Report, stability: &Stability) -> Vec<String> {
    let h = stability.timestep_s;
    let column = |header: &str, alignment, spare, cell: &dyn Fn(&StabilityRow) -> _| Column {
        header: header.into(),
        alignment,
        spare,
        cells: stability.rows.iter().map(cell).collect(),
    };
    let plain = |text: String| (text, None);
    let mut columns = vec![
        column("  engine", Left, 0, &|row| engine(report, row)),
        column("predicted\nlimit (s)", Right, 0, &|row| {
            plain(limit(row.predicted_limit_s, row.unconditional))
        }),
        column("measured\nlimit (s)", Right, 0, &|row| plain(measured(row))),
        column("ratio", Right, 2, &|row| plain(ratio(row))),
        column("smooth\nbelow (s)", Right, 4, &|row| {
            plain(limit(row.smooth_below_s, false))
        }),
        column("growth/s\npredicted", Right, 1, &|row| {
            plain(growth(row.growth_per_s))
        }),
        column("growth/s\nmeasured", Right, 1, &|row| {
            plain(growth(row.measured_growth_per_s))
        }),
        column(&format!("at h =\n{} s", words::short(h)), Left, 0, &|row| {
            let tone = row
                .holds(h)
                .map(|holds| if holds { Tone::Good } else { Tone::Bad });
            (place(row, h), tone)
        }),
    ];
    // Most scenes have no use for some.
    columns.retain(|column| !column.is_empty());
    let (columns, left_out) = fitted(columns);
    let mut lines = laid_out(&columns);
    let mut legend = "▸ own integrator | never, always: no step is stable, every step is | ratio: \
                      measured over predicted"
        .to_owned();
    if stability
        .rows
        .iter()
        .any(|row| row.smooth_below_s.is_some())
    {
        legend += " | smooth: decays without changing sign, predicted";
    }
    if !left_out.is_empty() {
        legend += &format!(" | left out for width: {}", left_out.join(", "));
    }
    let legend = wrap(&legend, WIDTH, "");
    lines.extend(legend.iter().map(|line| mark(Tone::Dim, line)));
    lines
}

fn engine(report: &Report, row: &StabilityRow) -> (String, Option<Tone>) {
    let name = words::one_line(&row.engine);
    if row.engine == report.scene.own_method {
        (format!("▸ {name}"), Some(Tone::Strong))
    } else {
        (format!("  {name}"), None)
    }
}

fn reasons(stability: &Stability) -> Vec<String> {
    let mut lines = Vec::new();
    for (subject, sentence) in notes(stability) {
        lines.extend(wrap(&format!("- {subject}: {sentence}"), WIDTH, "  "));
    }
    if !lines.is_empty() {
        lines.insert(0, String::new());
    }
    lines
}

/// The character of a cell and its tone.
fn cell(cell: Option<Cell>) -> (&'static str, Option<Tone>) {
    match cell {
        Some(Cell::Stable) => ("·", Some(Tone::Good)),
        Some(Cell::Dissipating) => ("-", Some(Tone::Cool)),
        Some(Cell::Growing) => ("#", Some(Tone::Bad)),
        Some(Cell::Failed) => ("x", Some(Tone::Warn)),
        None => (" ", None),
    }
}

/// The scene's own integrator's panel, or the first, where it fits.
fn map(report: &Report, stability: &Stability) -> Vec<String> {
    let (Some(map), Some(heading)) = (&stability.map, map_heading(stability)) else {
        return Vec::new();
    };
    let own = |panel: &&MapPanel| panel.engine == report.scene.own_method;
    let panel = map.engines.iter().find(own).or(map.engines.first());
    let mut lines = vec![String::new()];
    let fits = map.values.len() <= COLUMNS && map.timesteps_s.len() <= LINES;
    let (Some(panel), true) = (panel, fits) else {
        lines.extend(wrap(&format!("map      {heading}"), WIDTH, "         "));
        return lines;
    };
    let name = words::one_line(&panel.engine);
    let title = format!("map      {name}, {heading}; the report has every engine's");
    lines.extend(wrap(&title, WIDTH, "         "));
    lines.extend(drawn(map, panel));
    lines
}

/// One line a timestep, the largest on top, one character a value.
fn drawn(map: &StabilityMap, panel: &MapPanel) -> Vec<String> {
    let mut lines = Vec::new();
    let labelled = |at: usize| at == 0 || at + 1 == map.timesteps_s.len();
    for (at, h) in map.timesteps_s.iter().enumerate().rev() {
        let label = if labelled(at) {
            format!("h = {} s", digits(*h))
        } else {
            String::new()
        };
        let cells = panel.cells.iter().map(|column| {
            let (text, tone) = cell(column.get(at).copied().flatten());
            tone.map_or_else(|| text.to_owned(), |tone| mark(tone, text))
        });
        lines.push(format!("{label:>16} {}", cells.collect::<String>()));
    }
    let ends = [map.values.first(), map.values.last()]
        .map(|v| v.map_or(String::new(), |v| words::short(*v)));
    let vary = clip(&words::one_line(&map.vary), 40);
    let axis = format!("{vary} {} to {} {}", ends[0], ends[1], map.unit);
    lines.push(clip(&format!("{:>16} {axis}", ""), WIDTH));
    lines.push(mark(
        Tone::Dim,
        &format!("{:>16} · stable  - dissipating  # growing  x failed", ""),
    ));
    lines
}

fn admissible(stability: &Stability) -> Vec<String> {
    let Some(admissible) = &stability.admissible else {
        return Vec::new();
    };
    let mut lines = vec![String::new()];
    let heading = format!(
        "where one step at h = {} s from rest does not enlarge the spring's force, of all places:",
        words::short(admissible.timestep_s)
    );
    lines.extend(wrap(&heading, WIDTH, "  "));
    let names: Vec<String> = admissible
        .panels
        .iter()
        .map(|panel| format!("K = {} N/m", words::short(panel.stiffness_n_m)))
        .collect();
    let longest = names.iter().map(|name| width(name)).max().unwrap_or(0);
    for (name, panel) in names.iter().zip(&admissible.panels) {
        lines.push(format!(
            "  {}  {:>5.1} %",
            pad(name, longest),
            100.0 * panel.share
        ));
    }
    lines
}
