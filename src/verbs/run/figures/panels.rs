//! The runs of a report as panels of lines: each timestep has its own panel, so that lines of one colour never mix.

use crate::measure::EnergyClass;
use crate::report::svg::palette::{self, look};
use crate::report::svg::{
    self, Chart, ChartAxis, LegendEntry, Look, Mark, Panel, Polyline, Stroke, Symbol, TRUTH_NAME,
    heading, range, tamed,
};
use crate::report::words;
use crate::solvers::{SolverKind, Status};
use crate::verbs::Report;
use crate::verbs::run::text::{engine, several_timesteps};
use crate::verbs::run::{Curves, Outcome, TruthCurves};
use std::collections::BTreeSet;

/// The number of panels, at most; the table has every timestep.
const MAX_PANELS: usize = 6;

/// The lines drawn for one run, as points.
pub type Paths = Vec<Vec<[f64; 2]>>;

/// The runs one panel shows.
pub struct Runs<'a> {
    /// Such as `h = 0.05 s`; empty where the report has one timestep only.
    pub title: String,
    pub truth: Paths,
    pub runs: Vec<(&'a Outcome, Paths)>,
}

/// The recorded runs by timestep, in the order they first occur. Beside other solvers, a rapier run at a
/// timestep of its own joins the first panel. None where no run has anything to draw.
pub fn by_timestep(
    report: &Report,
    truth: impl Fn(&TruthCurves) -> Paths,
    paths: impl Fn(&Curves) -> Paths,
) -> Option<Vec<Runs<'_>>> {
    let series = report.run_series();
    let runs = series.curves.iter();
    let runs = runs.filter_map(|c| Some((report.outcomes().get(c.outcome)?, paths(c))));
    let runs: Vec<(&Outcome, Paths)> = runs.collect();
    let mut drawn = runs.iter().flat_map(|(_, paths)| paths);
    drawn.find(|path| !path.is_empty())?;
    let mut timesteps: Vec<f64> = Vec::new();
    let all_rapier = runs.iter().all(|(o, _)| o.kind == SolverKind::Rapier);
    for (outcome, _) in &runs {
        let counts = all_rapier || outcome.kind != SolverKind::Rapier;
        if counts && !timesteps.contains(&outcome.timestep) {
            timesteps.push(outcome.timestep);
        }
    }
    let titled = several_timesteps(report);
    let shown = timesteps.iter().take(MAX_PANELS).enumerate();
    let panels = shown.map(|(at, &h)| {
        let here = |o: &Outcome| o.timestep == h || (at == 0 && !timesteps.contains(&o.timestep));
        let runs = runs.iter().filter(|(o, _)| here(o)).cloned();
        let title = titled.then(|| format!("h = {} s", words::short(h)));
        Runs {
            title: title.unwrap_or_default(),
            truth: series.truth.as_deref().map(&truth).unwrap_or_default(),
            runs: runs.collect(),
        }
    });
    Some(panels.collect())
}

impl Runs<'_> {
    /// The lines of the truth, which have no outcome, then those of every run in the order they are painted. A
    /// run that ended early has a cross at its end.
    pub fn lines(&self, report: &Report) -> Vec<(Option<&Outcome>, Polyline)> {
        let truth = self.truth.iter().cloned();
        let truth = truth.map(|path| {
            let mut line = Polyline::new(path, palette::TRUTH);
            line.engine = Some(TRUTH_NAME.to_owned());
            (None, line)
        });
        let mut runs: Vec<&(&Outcome, Paths)> = self.runs.iter().collect();
        runs.sort_by_key(|(outcome, _)| layer(report, outcome));
        let runs = runs.into_iter().flat_map(|(outcome, paths)| {
            let stroke = stroke(report, outcome);
            let cross = Symbol::cross(stroke.colour);
            let own = id(report, outcome);
            paths.iter().map(move |path| {
                let mut line = Polyline::new(path.clone(), stroke);
                line.engine = Some(own.clone());
                line.wild = is_wild(outcome);
                line.end = (outcome.status != Status::Completed).then_some(cross);
                (Some(*outcome), line)
            })
        });
        truth.chain(runs).collect()
    }

    /// The range of each run's values along one axis.
    pub fn spans(&self, axis: usize) -> impl Iterator<Item = (&Outcome, [f64; 2])> {
        let runs = self.runs.iter();
        runs.filter_map(move |(outcome, paths)| {
            let span = range(paths.iter().flatten().map(|p| p[axis]))?;
            Some((*outcome, span))
        })
    }

    /// The range shown along one axis: that of the calm runs and of the `fixed` particles, and a little of the wild
    /// runs.
    pub fn shown(&self, axis: usize, fixed: Option<[f64; 2]>) -> [f64; 2] {
        let spans: Vec<_> = self
            .spans(axis)
            .map(|(o, span)| (is_wild(o), span))
            .collect();
        // Where all runs are wild, the fixed particles do not count as calm.
        let calm = fixed.filter(|_| spans.iter().any(|(is_wild, _)| !is_wild));
        let calm = calm.map(|span| (false, span));
        let shown = [tamed(spans.into_iter().chain(calm)), fixed];
        range(shown.into_iter().flatten().flatten()).unwrap_or([0.0, 1.0])
    }
}

/// One path of values over time.
pub fn over_time(t: &[f64], values: &[f64]) -> Paths {
    let points = t.iter().zip(values);
    vec![points.map(|(&t, &value)| [t, value]).collect()]
}

/// Curves over time, with a label at each line's end.
pub fn curves(
    report: &Report,
    [title, y_title]: [&str; 2],
    panels: Vec<Runs>,
    axis: impl Fn(&Runs) -> ChartAxis,
) -> Chart {
    let height = if panels.len() > 1 { 230.0 } else { 340.0 };
    let panels = panels.iter().map(|panel| {
        let marks = panel.lines(report).into_iter().map(|(outcome, mut line)| {
            let text = outcome.map_or(TRUTH_NAME.to_owned(), name);
            line.label = (!line.points.is_empty())
                .then(|| LegendEntry::new(text, Look::Line(line.stroke)).of(line.engine.clone()));
            Mark::Line(line)
        });
        let times = range(panel.spans(0).flat_map(|(_, span)| span));
        let axes = [ChartAxis::linear(times.unwrap_or([0.0, 1.0])), axis(panel)];
        Panel::new(panel.title.clone(), height, axes, marks.collect())
    });
    Chart {
        title: heading(&report.header, title),
        titles: ["time (s)", y_title].map(str::to_owned),
        over_time: true,
        panels: panels.collect(),
        ..Chart::default()
    }
}

/// What links the engine's rows, lines and motion on a page.
pub fn id(report: &Report, outcome: &Outcome) -> String {
    match several_timesteps(report) {
        true => format!("{}@{}", outcome.engine, outcome.timestep),
        false => outcome.engine.clone(),
    }
}

/// The engine's name in labels, with the time it reached if it ended early.
pub fn name(outcome: &Outcome) -> String {
    let name = svg::engine(&engine(outcome));
    match outcome.stopped_at_s {
        Some(t) => format!("{name}, to {} s", words::short(t)),
        None => name,
    }
}

/// The look of the outcome's engine.
pub fn stroke(report: &Report, outcome: &Outcome) -> Stroke {
    let alike = report.outcomes().iter().filter(|o| o.kind == outcome.kind);
    let engines = alike.map(|o| &o.engine);
    let before: BTreeSet<&String> = engines.take_while(|e| **e != outcome.engine).collect();
    let own = report.header.is_own(&outcome.engine);
    let place = palette::place(outcome.kind, &outcome.engine, before.len());
    look(outcome.kind, place, own)
}

/// Whether a run may leave the picture: it is unfinished or gains energy.
pub fn is_wild(outcome: &Outcome) -> bool {
    let class = outcome.energy.as_ref().and_then(|e| e.class);
    outcome.status != Status::Completed || class == Some(EnergyClass::Growing)
}

/// The layer a run is painted in, lowest first: wild runs, other integrators, the scene's own, rapier, whose
/// dashes let the lines below show through.
fn layer(report: &Report, outcome: &Outcome) -> u8 {
    match outcome.kind {
        SolverKind::Rapier => 3,
        _ if is_wild(outcome) => 0,
        _ if report.header.is_own(&outcome.engine) => 2,
        _ => 1,
    }
}
