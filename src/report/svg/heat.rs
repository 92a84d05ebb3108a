//! The stability map: one panel an engine, timestep against the quantity varied, the predicted limit
//! over it.

use super::canvas::{Anchor, Canvas, FAINT, INK};
use super::grid::{Layout, Panel, Sides, legend};
use super::line;
use super::palette;
use super::scale::Axis;
use super::{WIDTH, heading, shortened};
use crate::outcome::{Cell, MapPanel, Report, StabilityMap};
use crate::report::words;

/// Panels in one row.
const COLUMNS: usize = 4;
/// Pixels: left of the first panel, between panels, of one panel's height, and above it.
const LEFT: f64 = 72.0;
const GAP: f64 = 16.0;
const HEIGHT: f64 = 132.0;
const ABOVE: f64 = 28.0;
/// Above the first row of panels: title and legend.
const TOP: f64 = 62.0;
/// Below the last: ticks and the axis' title.
const BELOW: f64 = 42.0;

/// In the order of the legend.
const CELLS: [(Cell, &str); 4] = [
    (Cell::Stable, "stable"),
    (Cell::Dissipating, "dissipating"),
    (Cell::Growing, "growing"),
    (Cell::Failed, "failed"),
];

/// Whether there is a map.
pub fn wanted(report: &Report) -> bool {
    map(report).is_some()
}

fn map(report: &Report) -> Option<&StabilityMap> {
    let map = report.stability.as_ref()?.map.as_ref()?;
    let any = !map.engines.is_empty() && !map.values.is_empty() && !map.timesteps_s.is_empty();
    any.then_some(map)
}

pub fn draw(report: &Report) -> String {
    let mut canvas = Canvas::default();
    let title = heading(report, "stability map");
    canvas.text([LEFT, 24.0], Anchor::Start, 15.0, INK, &title);
    let Some(map) = map(report) else {
        return canvas.finish(WIDTH, TOP, &title);
    };
    key(&mut canvas, map);
    let count = map.engines.len();
    let columns = count.min(COLUMNS);
    // Few panels are larger, but no larger than legible.
    let wide = Layout::width(columns, LEFT, GAP).min(2.4 * HEIGHT);
    let high = if columns < COLUMNS {
        wide * 0.7
    } else {
        HEIGHT
    };
    let layout = Layout {
        count,
        columns,
        left: LEFT,
        top: TOP,
        above: ABOVE,
        gap: GAP,
        size: [wide, high],
    };
    for (at, engine) in map.engines.iter().enumerate() {
        let panel = Panel {
            window: layout.window(at),
            x: axis(&map.values),
            y: axis(&map.timesteps_s),
        };
        draw_panel(&mut canvas, report, map, engine, &panel, layout.sides(at));
    }
    let bottom = layout.bottom();
    let unit = if map.unit.is_empty() {
        String::new()
    } else {
        format!(" ({})", map.unit)
    };
    let name = shortened(&words::one_line(&map.vary), 40) + &unit;
    canvas.text(
        [layout.middle(), bottom + 34.0],
        Anchor::Middle,
        12.0,
        FAINT,
        &name,
    );
    canvas.text_upward(
        [16.0, TOP + (bottom - TOP) / 2.0],
        12.0,
        FAINT,
        "timestep h (s)",
    );
    canvas.finish(WIDTH, bottom + BELOW, &title)
}

/// What colours and the line mean.
fn key(canvas: &mut Canvas, map: &StabilityMap) {
    let mut x = LEFT;
    let y = 46.0;
    for (cell, name) in CELLS {
        x = legend(canvas, [x, y], palette::cell(cell), name);
    }
    let holds = |engine: &MapPanel| engine.predicted_limit_s.iter().flatten().any(|h| *h > 0.0);
    if map.engines.iter().any(holds) {
        let data = format!("M{x:.1} {y:.1}h24");
        for stroke in palette::BOUNDARY {
            canvas.path(&data, stroke);
        }
        let text = "predicted limit";
        canvas.text([x + 30.0, y + 4.0], Anchor::Start, 12.0, INK, text);
        x += 30.0 + 6.9 * text.len() as f64 + 20.0;
    }
    let steps = format!("at most {} steps a cell", words::count(map.steps_per_cell));
    canvas.text([x, y + 4.0], Anchor::Start, 12.0, FAINT, &steps);
}

/// From the outer edge of the first cell to that of the last.
fn axis(values: &[f64]) -> Axis {
    let [first, last] = [values.first(), values.last()].map(|v| v.copied().unwrap_or(1.0));
    let halves = 2.0 * values.len().saturating_sub(1).max(1) as f64;
    if first > 0.0 && last > first {
        let half = (last.ln() - first.ln()) / halves;
        Axis::logarithmic([(first.ln() - half).exp(), (last.ln() + half).exp()])
    } else {
        let half = (last - first) / halves;
        Axis::linear([first - half, last + half])
    }
}

fn draw_panel(
    canvas: &mut Canvas,
    report: &Report,
    map: &StabilityMap,
    engine: &MapPanel,
    panel: &Panel,
    sides: Sides,
) {
    let counts = [map.values.len(), map.timesteps_s.len()];
    let at = |i: usize, j: usize| engine.cells.get(i)?.get(j).copied().flatten();
    for (cell, _) in CELLS {
        let data = panel.cells(counts, |i, j| at(i, j) == Some(cell));
        canvas.area(&data, palette::cell(cell));
    }
    let limits = map.values.iter().zip(&engine.predicted_limit_s);
    // A stretch between two values without a limit is no line.
    let mut stretches: Vec<Vec<[f64; 2]>> = vec![Vec::new()];
    for (value, limit) in limits {
        match (limit.filter(|h| *h > 0.0), stretches.last_mut()) {
            (Some(h), Some(stretch)) => stretch.push(panel.place([*value, h])),
            _ => stretches.push(Vec::new()),
        }
    }
    for stroke in palette::BOUNDARY {
        for stretch in &stretches {
            canvas.path(&line::draw(stretch, panel.window).data, stroke);
        }
    }
    let own = engine.engine == report.scene.own_method;
    let name = shortened(&words::one_line(&engine.engine), 30);
    let name = if own { format!("▸ {name}") } else { name };
    panel.frame(canvas, &name, sides);
}
