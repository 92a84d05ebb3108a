//! The picture of a few steps: each engine has a panel with a line for each timestep and the truth in
//! black; below it the difference to the truth has an axis of its own.

use crate::report::svg::{
    Chart, ChartAxis, LegendEntry, Look, Mark, Panel, Polyline, Stroke, Symbol, TRUTH_NAME,
    heading, padded, palette, panel_title, range, shortened, span, tamed,
};
use crate::report::words;
use crate::solvers::Status;
use crate::verbs::Report;
use crate::verbs::cost::{CostLine, CostPanel, CostPanels};

/// Heights of the panels of curves and of differences, pixels.
const CURVES: f64 = 110.0;
const DIFFERENCES: f64 = 70.0;

pub fn chart(report: &Report) -> Option<Chart> {
    let shown = report.panels()?;
    if lines(shown).all(|line| line.curve.is_empty()) {
        return None;
    }
    let mut timesteps: Vec<f64> = lines(shown).map(|line| line.timestep).collect();
    timesteps.sort_by(|a, b| b.total_cmp(a));
    timesteps.dedup();
    let look = |h: f64| {
        let place = timesteps.iter().position(|other| *other == h);
        palette::timestep(place.unwrap_or(0))
    };
    let key =
        |h: &f64| LegendEntry::new(format!("h = {} s", words::short(*h)), Look::Line(look(*h)));
    let differs = !shown.truth.is_empty();
    let truth = differs.then(|| LegendEntry::new(TRUTH_NAME, Look::Line(palette::TRUTH_LINE)));
    let legend = truth.into_iter().chain(timesteps.iter().map(key));

    let [x, y] = ranges(shown);
    let panels = shown.panels.iter().flat_map(|panel| {
        let draw = |line: &CostLine, points: &[[f64; 2]]| draw(line, points, look(line.timestep));
        let truth = Mark::line(shown.truth.clone(), palette::TRUTH_LINE);
        let curves = panel.lines.iter().map(|line| draw(line, &line.curve));
        let curves = [truth].into_iter().chain(curves).collect();
        let differences = panel.lines.iter().map(|line| draw(line, &line.difference));
        let title = panel_title(&report.header, &panel.engine);
        let [above, below] = [y, difference(panel, y)].map(|y| [x, y].map(ChartAxis::linear));
        let mut above = Panel::new(title, CURVES, above, curves);
        let mut below = Panel::new(String::new(), DIFFERENCES, below, differences.collect());
        (above.width, below.width, below.joined) = (420.0, 420.0, true);
        [above].into_iter().chain(differs.then_some(below))
    });
    let mut y_title = shortened(&shown.label, 40);
    if differs {
        y_title += ", and its difference to the truth";
    }
    Some(Chart {
        title: heading(&report.header, "each step beside the truth"),
        legend: legend.collect(),
        titles: ["time (s)".into(), y_title],
        panels: panels.collect(),
        columns: shown.panels.len().min(3),
        own_y: true,
        ..Chart::default()
    })
}

fn lines(shown: &CostPanels) -> impl Iterator<Item = &CostLine> {
    shown.panels.iter().flat_map(|panel| &panel.lines)
}

/// One line of a run, with a cross where the run ended early.
fn draw(line: &CostLine, points: &[[f64; 2]], stroke: Stroke) -> Mark {
    let early = line.status != Status::Completed;
    Mark::Line(Polyline {
        wild: true,
        end: early.then_some(Symbol::cross(stroke.colour)),
        ..Polyline::new(points.to_vec(), stroke)
    })
}

/// The ranges of time and coordinate of all panels: those of the truth, and a little of what leaves it.
fn ranges(shown: &CostPanels) -> [[f64; 2]; 2] {
    let curves = || lines(shown).map(|line| &line.curve);
    let times = curves()
        .chain([&shown.truth])
        .filter_map(|curve| span(curve, 0));
    let times = range(times.flatten()).unwrap_or([0.0, 1.0]);
    let truth = span(&shown.truth, 1);
    let curves = lines(shown).filter_map(|line| {
        let is_wild = truth.is_some() || line.status != Status::Completed;
        Some((is_wild, span(&line.curve, 1)?))
    });
    let truth = truth.map(|span| (false, span));
    let shown = tamed(truth.into_iter().chain(curves)).unwrap_or([0.0, 1.0]);
    [times, padded(shown, 0.05)]
}

/// The range of the differences of one panel, cut at half of what the curves' axis shows.
fn difference(panel: &CostPanel, shown: [f64; 2]) -> [f64; 2] {
    let most = shown[1] / 2.0 - shown[0] / 2.0;
    let spans = panel.lines.iter().filter_map(|line| {
        let [lo, hi] = span(&line.difference, 1)?;
        let is_calm = line.status == Status::Completed && -most <= lo && hi <= most;
        Some((!is_calm, [lo, hi].map(|end| end.clamp(-most, most))))
    });
    let [lo, hi] = tamed(spans).unwrap_or([0.0, 0.0]);
    padded([lo.min(0.0), hi.max(0.0)], 0.06)
}
