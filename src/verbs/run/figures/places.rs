//! Figures of places: paths of particles, and a coordinate against its velocity.

use super::panels::{Runs, by_timestep, id, name, stroke};
use crate::report::svg::palette;
use crate::report::svg::{
    Chart, ChartAxis, FAINT, INK, LegendEntry, Look, Mark, Panel, Symbol, SymbolShape, TRUTH_NAME,
    WHITE, heading, padded, range,
};
use crate::solvers::Status;
use crate::verbs::Report;
use crate::verbs::run::Outcome;
use crate::verbs::shape::AXIS_TITLES;

/// The paths of a few particles, projected on the plane that shows most of the motion, with their starts and
/// ends and the particles that never move.
pub fn trajectories(report: &Report) -> Option<Chart> {
    let series = report.run_series();
    let panels = by_timestep(report, |truth| truth.paths.clone(), |run| run.paths.clone())?;
    let titles = series.plane.map(|axis| AXIS_TITLES[axis.min(2)].to_owned());
    let mut chart = traced(report, panels, &series.fixed);
    for panel in &mut chart.panels {
        panel.equal_scales = true;
    }
    Some(Chart {
        title: heading(&report.header, "trajectories"),
        titles,
        ..chart
    })
}

/// One coordinate against its velocity: what gains energy spirals out, what loses it in.
pub fn phase(report: &Report) -> Option<Chart> {
    let series = report.run_series();
    let named = series.phase.as_ref()?;
    let panels = by_timestep(
        report,
        |truth| vec![truth.phase.clone()],
        |run| vec![run.phase.clone()],
    )?;
    Some(Chart {
        title: heading(&report.header, &format!("phase portrait of {named}")),
        titles: [format!("{named} (m)"), "its velocity (m/s)".to_owned()],
        ..traced(report, panels, &[])
    })
}

/// Paths with their starts and ends, and what stays where it is.
fn traced(report: &Report, panels: Vec<Runs>, fixed: &[[f64; 2]]) -> Chart {
    let height = if panels.len() > 1 { 320.0 } else { 460.0 };
    let start = Symbol::new(SymbolShape::Disc, WHITE, INK);
    let end = |colour| Symbol::new(SymbolShape::Disc, colour, WHITE);
    let still = Symbol::new(SymbolShape::Square, INK, INK);
    let panel = |panel: &Runs| {
        let axes = [0, 1].map(|axis| {
            let still = range(fixed.iter().map(|p| p[axis]));
            ChartAxis::linear(padded(panel.shown(axis, still), 0.06))
        });
        let lines = panel.lines(report).into_iter().map(|(outcome, mut line)| {
            let arrived = outcome.map(|_| end(line.stroke.colour));
            line.end = line.end.or(arrived);
            Mark::Line(line)
        });
        let first = panel.runs.first().into_iter().flat_map(|(_, paths)| paths);
        let starts = first.filter_map(|path| path.first().copied()).collect();
        let marks = [(start, starts), (still, fixed.to_vec())];
        let marks = marks.map(|(symbol, points)| Mark::Symbols(symbol, points));

        let look = |o: &Outcome| Look::Line(stroke(report, o));
        let truth = panel.truth.iter().any(|path| !path.is_empty());
        let truth = truth.then(|| {
            LegendEntry::new(TRUTH_NAME, Look::Line(palette::TRUTH)).of(Some(TRUTH_NAME.to_owned()))
        });
        let runs = panel
            .runs
            .iter()
            .map(|(o, _)| LegendEntry::new(name(o), look(o)).of(Some(id(report, o))));
        let mut ends = panel.runs.iter().map(|(o, _)| o.status);
        let early = ends.any(|status| status != Status::Completed);
        let symbols = [
            (true, "start", start),
            (true, "end", end(FAINT)),
            (!fixed.is_empty(), "fixed", still),
            (early, "ended early", Symbol::cross(FAINT)),
        ];
        let symbols = symbols.into_iter().filter(|(shown, ..)| *shown);
        let symbols = symbols.map(|(_, text, symbol)| LegendEntry::new(text, Look::Symbol(symbol)));
        let marks = lines.chain(marks).collect();
        Panel {
            keys: truth.into_iter().chain(runs).chain(symbols).collect(),
            ..Panel::new(panel.title.clone(), height, axes, marks)
        }
    };
    Chart {
        panels: panels.iter().map(panel).collect(),
        ..Chart::default()
    }
}
