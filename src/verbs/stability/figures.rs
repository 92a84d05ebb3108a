//! The figures of `stability`: the map of how runs end, and the places from where a step does not enlarge
//! the force of a stiff spring.

use crate::measure::stability::Cell;
use crate::report::svg::Figure;
use crate::report::svg::{
    Chart, ChartAxis, LegendEntry, Look, Mark, Panel, Stroke, cells, heading, palette, panel_title,
    shortened,
};
use crate::report::words;
use crate::verbs::Report;
use crate::verbs::stability::{MapPanel, StabilityMap};

/// The line of the places where the spring has its rest length.
const REST: Stroke = Stroke::new("#d55e00", "5 3", 1.4);

/// The stability map: each engine has a panel of timestep against the varied quantity, with the predicted
/// limit over it.
fn map(report: &Report) -> Option<Chart> {
    let map = report.stability()?.map.as_ref()?;
    if map.engines.is_empty() || map.values.is_empty() || map.timesteps_s.is_empty() {
        return None;
    }
    let cells = CELLS.map(|(_, name, colour)| LegendEntry::new(name, Look::Fill(colour)));
    let mut legend = Vec::from(cells);
    let predicts = |engine: &MapPanel| engine.predicted_limit_s.iter().flatten().any(|h| *h > 0.0);
    if map.engines.iter().any(predicts) {
        let line = Look::Line(palette::BOUNDARY[1]);
        legend.push(LegendEntry::new("predicted limit", line));
    }
    let steps = words::count(map.steps_per_cell);
    let remark = format!("at most {steps} steps a cell");
    legend.push(LegendEntry::new(remark, Look::Remark));

    let columns = map.engines.len().min(4);
    // Fewer panels are larger, up to a size that is easy to read.
    let height = f64::min(224.0, 524.0 / columns as f64);
    let panels = map.engines.iter().map(|engine| {
        let axes = [&map.values, &map.timesteps_s].map(|middles| ChartAxis::of_cells(middles));
        let title = panel_title(&report.header, &engine.engine);
        Panel {
            width: 320.0,
            ..Panel::new(title, height, axes, map_marks(map, engine, axes))
        }
    });
    let mut x_title = shortened(&map.vary, 40);
    if !map.unit.is_empty() {
        x_title += &format!(" ({})", map.unit);
    }
    Some(Chart {
        title: heading(&report.header, "stability map"),
        legend,
        titles: [x_title, "timestep h (s)".into()],
        panels: panels.collect(),
        columns,
        ..Chart::default()
    })
}

fn map_marks(map: &StabilityMap, engine: &MapPanel, axes: [ChartAxis; 2]) -> Vec<Mark> {
    let counts = [map.values.len(), map.timesteps_s.len()];
    let at = |i: usize, j: usize| engine.cells.get(i)?.get(j).copied().flatten();
    let areas = CELLS.map(|(cell, _, colour)| {
        let belongs = |i, j| at(i, j) == Some(cell);
        cells(colour, axes, counts, belongs)
    });
    let limits = map.values.iter().zip(&engine.predicted_limit_s);
    let limits: Vec<Option<[f64; 2]>> = limits
        .map(|(value, limit)| limit.filter(|h| *h > 0.0).map(|h| [*value, h]))
        .collect();
    let mut marks: Vec<Mark> = areas.into();
    for stroke in palette::BOUNDARY {
        // The line breaks at values without a limit.
        let stretches = limits.split(Option::is_none);
        let lines = stretches.map(|points| Mark::line(points.iter().copied().flatten(), stroke));
        marks.extend(lines);
    }
    marks
}

/// The admissible region of a stiff spring: each stiffness has a panel of the places from where a step
/// from rest does not enlarge the force.
fn admissible(report: &Report) -> Option<Chart> {
    let admissible = report.stability()?.admissible.as_ref()?;
    if admissible.panels.is_empty() {
        return None;
    }
    let length = admissible.rest_length_m;
    let [m1, m2] = admissible.masses_kg.map(words::short);
    let facts = format!(
        "from rest, h = {} s, m1 = {m1} kg, m2 = {m2} kg, L = {} m",
        words::short(admissible.timestep_s),
        words::short(length)
    );
    let [holds, fails] = palette::HOLDS;
    let axes = [&admissible.x1_m, &admissible.x2_m].map(|middles| ChartAxis::of_cells(middles));
    let counts = [admissible.x1_m.len(), admissible.x2_m.len()];
    let panels = admissible.panels.iter().map(|stiffness| {
        let admitted = |i: usize, j: usize| {
            let line = stiffness.admitted.get(j);
            line.and_then(|line| line.as_bytes().get(i)) == Some(&b'1')
        };
        let rest = [length, -length].map(|apart| {
            let ends = axes[0].range.map(|x1| [x1, x1 + apart]);
            Mark::line(ends, REST)
        });
        let mut marks = vec![
            cells(fails, axes, [1, 1], |_, _| true),
            cells(holds, axes, counts, admitted),
        ];
        marks.extend(rest);
        let stiff = words::short(stiffness.stiffness_n_m);
        let share = 100.0 * stiffness.share;
        let title = format!("K = {stiff} N/m: {share:.1} %");
        Panel {
            equal_scales: true,
            ..Panel::new(title, 380.0, axes, marks)
        }
    });
    Some(Chart {
        title: heading(&report.header, "where a step does not enlarge the force"),
        legend: vec![
            LegendEntry::new("no larger", Look::Fill(holds)),
            LegendEntry::new("larger", Look::Fill(fails)),
            LegendEntry::new("at rest: |x2 − x1| = L", Look::Line(REST)),
            LegendEntry::new(facts, Look::Remark),
        ],
        titles: ["x1 (m)", "x2 (m)"].map(str::to_owned),
        panels: panels.collect(),
        columns: admissible.panels.len().min(3),
        ..Chart::default()
    })
}

/// The kinds of cells with their names and colours, from light to dark: they can be told apart in grey and
/// by colour-blind readers.
const CELLS: [(Cell, &str, &str); 4] = [
    (Cell::Stable, "stable", "#e3eef6"),
    (Cell::Dissipating, "dissipating", "#8fbfe0"),
    (Cell::Growing, "growing", "#d55e00"),
    (Cell::Failed, "failed", "#3b1c32"),
];

/// The figures of `stability`.
pub const FIGURES: &[Figure<Report>] = &[
    (
        "stability_map.svg",
        "what becomes of a run at each timestep, engine by engine",
        map,
    ),
    (
        "admissible.svg",
        "from where a step does not enlarge the spring's force",
        admissible,
    ),
];
