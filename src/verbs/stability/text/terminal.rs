//! The terminal's part of `stability`: the table of limits and a map in characters.

use super::{largest_heading, largest_table, map_heading, table};
use crate::measure::stability::Cell;
use crate::report::terminal::{Tone, clip, mark, pad, width, wrap};
use crate::report::words::{self, digits};
use crate::verbs::Report;
use crate::verbs::stability::{MapPanel, Stability, StabilityMap, StabilityRow};

/// The columns beside a map in characters, which has a column for each value.
const BESIDE: usize = 20;
/// The most timesteps: each takes a line.
const LINES: usize = 40;

/// The lines below the facts.
pub fn lines(report: &Report, stability: &Stability, columns: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    lines.extend(
        table(report, stability).in_terminal(columns, ", ", |left_out| {
            let any = |wanted: fn(&StabilityRow) -> bool| stability.rows.iter().any(wanted);
            let mut legend = vec![
                "▸ own integrator",
                "never, always: no step is stable, every step is",
                "ratio: measured over predicted",
            ];
            let tightest = any(|row| row.tightest.is_some());
            if tightest && !left_out.iter().any(|column| column.starts_with("tightest")) {
                legend.push("predicted: at the start; tightest on the way: where the motion leads");
            }
            if any(|row| row.smooth_below_s.is_some()) {
                legend.push("smooth: decays without changing sign, predicted");
            }
            legend.join(" | ")
        }),
    );
    if let Some(largest) = &stability.largest {
        lines.push(String::new());
        lines.extend(wrap(&largest_heading(largest), columns, "  "));
        lines.extend(largest_table(largest).in_terminal(columns, ", ", |_| String::new()));
    }
    lines.extend(map(report, stability, columns));
    lines.extend(admissible(stability, columns));
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

/// The panel of the scene's own integrator, or the first, where it fits.
fn map(report: &Report, stability: &Stability, columns: usize) -> Vec<String> {
    let (Some(map), Some(heading)) = (&stability.map, map_heading(stability)) else {
        return Vec::new();
    };
    let own = |panel: &&MapPanel| report.header.is_own(&panel.engine);
    let fits = map.values.len() <= columns.saturating_sub(BESIDE) && map.timesteps_s.len() <= LINES;
    let panel = map.engines.iter().find(own).or(map.engines.first());
    let panel = panel.filter(|_| fits);
    let title = match panel.map(|panel| words::one_line(&panel.engine)) {
        Some(name) => format!("map      {name}, {heading}; the report has every engine's"),
        None => format!("map      {heading}"),
    };
    let mut lines = vec![String::new()];
    lines.extend(wrap(&title, columns, "         "));
    lines.extend(
        panel
            .into_iter()
            .flat_map(|panel| drawn(map, panel, columns)),
    );
    lines
}

/// The panel in characters: a line for each timestep, the largest on top, and a column for each value.
fn drawn(map: &StabilityMap, panel: &MapPanel, columns: usize) -> Vec<String> {
    let mut lines = Vec::new();
    let labelled = |at: usize| at == 0 || at + 1 == map.timesteps_s.len();
    for (at, h) in map.timesteps_s.iter().enumerate().rev() {
        let label = labelled(at).then(|| format!("h = {} s", digits(*h)));
        let label = label.unwrap_or_default();
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
    lines.push(clip(&format!("{:>16} {axis}", ""), columns));
    lines.push(mark(
        Tone::Dim,
        &format!("{:>15} · stable  - dissipating  # growing  x failed", ""),
    ));
    lines
}

fn admissible(stability: &Stability, columns: usize) -> Vec<String> {
    let Some(admissible) = &stability.admissible else {
        return Vec::new();
    };
    let mut lines = vec![String::new()];
    let heading = format!(
        "where one step at h = {} s from rest does not enlarge the spring's force, of all places:",
        words::short(admissible.timestep_s)
    );
    lines.extend(wrap(&heading, columns, "  "));
    let stiffnesses = admissible.panels.iter().map(|panel| panel.stiffness_n_m);
    let names: Vec<String> = stiffnesses
        .map(|k| format!("K = {} N/m", words::short(k)))
        .collect();
    let longest = names.iter().map(|name| width(name)).max().unwrap_or(0);
    let shares = names
        .iter()
        .zip(&admissible.panels)
        .map(|(name, panel)| format!("  {}  {:>5.1} %", pad(name, longest), 100.0 * panel.share));
    lines.extend(shares);
    lines
}
