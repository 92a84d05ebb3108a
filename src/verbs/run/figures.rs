//! The figures of runs: the scene's `plot` and the energy over time, and the paths of a few particles. Each
//! timestep has its own panel, so that lines of one colour never mix.

use crate::measure::EnergyClass;
use crate::report::svg::Figure;
use crate::report::svg::palette::{self, look};
use crate::report::svg::{
    Chart, ChartAxis, FAINT, HUGE, INK, LegendEntry, Look, Mark, Panel, Polyline, Scale, Stroke,
    Symbol, SymbolShape, TRUTH_NAME, WHITE, heading, padded, range, shortened, tamed,
};
use crate::report::{svg, words};
use crate::solvers::{SolverKind, Status};
use crate::verbs::Report;
use crate::verbs::run::text::{engine, several_timesteps};
use crate::verbs::run::{Curves, Outcome, TruthCurves};
use crate::verbs::shape::AXIS_TITLES;
use std::collections::BTreeSet;

/// The number of panels, at most; the table has every timestep.
const MAX_PANELS: usize = 6;
/// The largest ratio of two energy amplitudes that a linear axis shows.
const MAX_RATIO: f64 = 50.0;

/// The lines drawn for one run, as points.
type Paths = Vec<Vec<[f64; 2]>>;

/// The runs one panel shows.
struct Runs<'a> {
    /// Such as `h = 0.05 s`; empty where the report has one timestep only.
    title: String,
    truth: Paths,
    runs: Vec<(&'a Outcome, Paths)>,
}

/// The recorded runs by timestep, in the order they first occur. Beside other solvers, a rapier run at a
/// timestep of its own joins the first panel. None where no run has anything to draw.
fn by_timestep(
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
            truth: series.truth.as_ref().map(&truth).unwrap_or_default(),
            runs: runs.collect(),
        }
    });
    Some(panels.collect())
}

impl Runs<'_> {
    /// The lines of the truth, which have no outcome, then those of every run in the order they are painted. A
    /// run that ended early has a cross at its end.
    fn lines(&self, report: &Report) -> Vec<(Option<&Outcome>, Polyline)> {
        let truth = self.truth.iter().cloned();
        let truth = truth.map(|path| (None, Polyline::new(path, palette::TRUTH)));
        let mut runs: Vec<&(&Outcome, Paths)> = self.runs.iter().collect();
        runs.sort_by_key(|(outcome, _)| layer(report, outcome));
        let runs = runs.into_iter().flat_map(|(outcome, paths)| {
            let stroke = stroke(report, outcome);
            let cross = Symbol::cross(stroke.colour);
            paths.iter().map(move |path| {
                let mut line = Polyline::new(path.clone(), stroke);
                line.wild = is_wild(outcome);
                line.end = (outcome.status != Status::Completed).then_some(cross);
                (Some(*outcome), line)
            })
        });
        truth.chain(runs).collect()
    }

    /// The range of each run's values along one axis.
    fn spans(&self, axis: usize) -> impl Iterator<Item = (&Outcome, [f64; 2])> {
        let runs = self.runs.iter();
        runs.filter_map(move |(outcome, paths)| {
            let span = range(paths.iter().flatten().map(|p| p[axis]))?;
            Some((*outcome, span))
        })
    }

    /// The range shown along one axis: that of the calm runs and of the `fixed` particles, and a little of the wild
    /// runs.
    fn shown(&self, axis: usize, fixed: Option<[f64; 2]>) -> [f64; 2] {
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
fn over_time(t: &[f64], values: &[f64]) -> Paths {
    let points = t.iter().zip(values);
    vec![points.map(|(&t, &value)| [t, value]).collect()]
}

/// Curves over time, with a label at each line's end.
fn curves(
    report: &Report,
    [title, y_title]: [&str; 2],
    panels: Vec<Runs>,
    axis: impl Fn(&Runs) -> ChartAxis,
) -> Chart {
    let height = if panels.len() > 1 { 230.0 } else { 340.0 };
    let panels = panels.iter().map(|panel| {
        let marks = panel.lines(report).into_iter().map(|(outcome, mut line)| {
            let text = outcome.map_or(TRUTH_NAME.to_owned(), name);
            line.label =
                (!line.points.is_empty()).then(|| LegendEntry::new(text, Look::Line(line.stroke)));
            Mark::Line(line)
        });
        let times = range(panel.spans(0).flat_map(|(_, span)| span));
        let axes = [ChartAxis::linear(times.unwrap_or([0.0, 1.0])), axis(panel)];
        Panel::new(panel.title.clone(), height, axes, marks.collect())
    });
    Chart {
        title: heading(&report.header, title),
        titles: ["time (s)", y_title].map(str::to_owned),
        panels: panels.collect(),
        ..Chart::default()
    }
}

/// The scene's `plot`, over the range the scene states, else over that of the calm runs.
fn plot(report: &Report) -> Option<Chart> {
    let stated = report.run_series().plot.as_ref()?;
    let truth = |truth: &TruthCurves| over_time(&truth.t, &truth.plot);
    let panels = by_timestep(report, truth, |run| over_time(&run.t, &run.plot))?;
    let label = shortened(&stated.label, 40);
    let titles = [&format!("{label} over time"), label.as_str()];
    Some(curves(report, titles, panels, |panel| {
        let y_range = stated.y_range.filter(|[lo, hi]| lo < hi);
        ChartAxis::linear(y_range.unwrap_or_else(|| padded(panel.shown(1, None), 0.05)))
    }))
}

/// How far each run is from the truth, over time, up to the truth's horizon. Below the floor, ten times the truth's own
/// error bar, a distance says nothing.
fn errors(report: &Report) -> Option<Chart> {
    let truth = &report.header.truth;
    let floor = 10.0 * truth.error_bound_m.unwrap_or_default();
    let least = (0.1 * floor).max(LEAST_OFF);
    let panels = by_timestep(
        report,
        |_| Paths::new(),
        |run| {
            let seen: Vec<f64> = run.errors.iter().map(|off| off.max(least)).collect();
            let mut paths = over_time(&run.t, &seen);
            // The start is the scene's, and has no error.
            paths
                .iter_mut()
                .for_each(|path| drop(path.drain(..path.len().min(1))));
            paths
        },
    )?;
    let titles = [
        "distance from the truth over time",
        "largest distance of a particle (m)",
    ];
    let mut chart = curves(report, titles, panels, |panel| {
        let [lo, hi] = panel.shown(1, None);
        let lowest = if floor > 0.0 { lo.min(floor) } else { lo };
        ChartAxis {
            scale: Scale::Log,
            range: [
                lowest.clamp(least, HUGE) / 2.0,
                hi.max(10.0 * lowest).clamp(10.0 * least, HUGE) * 2.0,
            ],
        }
    });
    for panel in &mut chart.panels {
        if floor > 0.0 {
            let [from, to] = panel.axes[0].range;
            let mut line = Polyline::new(vec![[from, floor], [to, floor]], FLOOR);
            line.label = Some(LegendEntry::new("floor", Look::Line(FLOOR)));
            panel.marks.insert(0, Mark::Line(line));
        }
    }
    Some(chart)
}

/// The error of the rods' lengths over time; what is 0 or below rounding lies on the lower edge.
fn rods(report: &Report) -> Option<Chart> {
    let panels = by_timestep(
        report,
        |_| Paths::new(),
        |run| match &run.rods[..] {
            [] => Paths::new(),
            off => {
                let seen: Vec<f64> = off.iter().map(|off| off.max(LEAST_OFF)).collect();
                over_time(&run.t, &seen)
            }
        },
    )?;
    let titles = [
        "length of rods off by, over time",
        "largest error of a length (m)",
    ];
    Some(curves(report, titles, panels, |panel| {
        let [lo, hi] = panel.shown(1, None);
        ChartAxis {
            scale: Scale::Log,
            range: [lo.max(LEAST_OFF) / 2.0, hi.max(10.0 * LEAST_OFF) * 2.0],
        }
    }))
}

/// Where errors are those of the truth.
const FLOOR: Stroke = Stroke::new(FAINT, "3 3", 1.0);

/// The smallest error of a length that is drawn, m.
const LEAST_OFF: f64 = 1e-17;

/// Energy over time; its truth is the zero line.
fn energy(report: &Report) -> Option<Chart> {
    let panels = by_timestep(
        report,
        |_| Paths::new(),
        |run| over_time(&run.t, &run.energy),
    )?;
    let y_title = match report.header.scene.energy_scale_j {
        Some(scale) => format!("(B − B(0)) / S,  S = {} J", words::short(scale)),
        None => "B − B(0)  (J)".into(),
    };
    let titles = ["energy balance over time", &y_title];
    Some(curves(report, titles, panels, energy_axis))
}

/// A symmetric-logarithmic axis where the panel shows a small bounded oscillation beside a large growth.
fn energy_axis(panel: &Runs) -> ChartAxis {
    let size = |[lo, hi]: [f64; 2]| f64::max(-lo, hi);
    let finished = panel
        .spans(1)
        .filter(|(o, _)| o.status == Status::Completed);
    let largest = finished.map(|(_, span)| size(span)).reduce(f64::max);
    // Unfinished runs leave through the edge instead of setting it, if there are others.
    let cap = largest.map_or(f64::MAX, |largest| f64::max(100.0 * largest, 1.0));
    let spans = panel
        .spans(1)
        .map(|(_, span)| span.map(|end| end.clamp(-cap, cap)));
    let spans: Vec<[f64; 2]> = spans.collect();
    let sizes: Vec<f64> = spans.iter().copied().map(size).collect();
    // Zero, where every run starts, is always shown.
    let ends = spans.into_iter().flatten().chain([0.0]);
    let [lo, hi] = range(ends).unwrap_or_default();
    let Some(linear) = linear_part(&sizes) else {
        return ChartAxis::linear(padded([lo, hi], 0.06));
    };
    // Half a decade of room on each side.
    let beyond = |end: f64| 3.0 * end.abs().clamp(0.2 * linear, HUGE / 3.0);
    ChartAxis {
        scale: Scale::SymLog { linear },
        range: [-beyond(lo), beyond(hi)],
    }
}

/// The power of ten below the smallest visible amplitude, if the largest exceeds it by more than the ratio a
/// linear axis shows.
fn linear_part(sizes: &[f64]) -> Option<f64> {
    let largest = sizes.iter().copied().fold(0.0, f64::max);
    let smallest = if largest > 1.0 {
        // Something gained more than the scale: a thousandth of it is small, all of it is not.
        sizes.iter().copied().fold(1.0, f64::min).max(1e-3)
    } else {
        let counts = |s: &f64| *s >= 1e-4 * largest;
        let smallest = sizes.iter().copied().filter(counts).fold(largest, f64::min);
        smallest.max(1e-3 * largest)
    };
    let spans = smallest > 1e-290 && largest > MAX_RATIO * smallest;
    spans.then(|| 10_f64.powi(smallest.log10().floor() as i32))
}

/// The paths of a few particles, projected on the plane that shows most of the motion, with their starts and
/// ends and the particles that never move.
fn trajectories(report: &Report) -> Option<Chart> {
    let panels = by_timestep(report, |truth| truth.paths.clone(), |run| run.paths.clone())?;
    let series = report.run_series();
    let height = if panels.len() > 1 { 320.0 } else { 460.0 };
    let titles = series.plane.map(|axis| AXIS_TITLES[axis.min(2)]);
    let start = Symbol::new(SymbolShape::Disc, WHITE, INK);
    let end = |colour| Symbol::new(SymbolShape::Disc, colour, WHITE);
    let still = Symbol::new(SymbolShape::Square, INK, INK);
    let panel = |panel: &Runs| {
        let axes = [0, 1].map(|axis| {
            let fixed = range(series.fixed.iter().map(|p| p[axis]));
            ChartAxis::linear(padded(panel.shown(axis, fixed), 0.06))
        });
        let lines = panel.lines(report).into_iter().map(|(outcome, mut line)| {
            let arrived = outcome.map(|_| end(line.stroke.colour));
            line.end = line.end.or(arrived);
            Mark::Line(line)
        });
        let first = panel.runs.first().into_iter().flat_map(|(_, paths)| paths);
        let starts = first.filter_map(|path| path.first().copied()).collect();
        let marks = [(start, starts), (still, series.fixed.clone())];
        let marks = marks.map(|(symbol, points)| Mark::Symbols(symbol, points));

        let look = |o: &Outcome| Look::Line(stroke(report, o));
        let truth = series.truth.as_ref();
        let truth = truth.map(|_| LegendEntry::new(TRUTH_NAME, Look::Line(palette::TRUTH)));
        let runs = panel
            .runs
            .iter()
            .map(|(o, _)| LegendEntry::new(name(o), look(o)));
        let mut ends = panel.runs.iter().map(|(o, _)| o.status);
        let early = ends.any(|status| status != Status::Completed);
        let symbols = [
            (true, "start", start),
            (true, "end", end(FAINT)),
            (!series.fixed.is_empty(), "fixed", still),
            (early, "ended early", Symbol::cross(FAINT)),
        ];
        let symbols = symbols.into_iter().filter(|(shown, ..)| *shown);
        let symbols = symbols.map(|(_, text, symbol)| LegendEntry::new(text, Look::Symbol(symbol)));
        let marks = lines.chain(marks).collect();
        Panel {
            equal_scales: true,
            keys: truth.into_iter().chain(runs).chain(symbols).collect(),
            ..Panel::new(panel.title.clone(), height, axes, marks)
        }
    };
    Some(Chart {
        title: heading(&report.header, "trajectories"),
        titles: titles.map(str::to_owned),
        panels: panels.iter().map(panel).collect(),
        ..Chart::default()
    })
}

/// The engine's name in labels, with the time it reached if it ended early.
fn name(outcome: &Outcome) -> String {
    let name = svg::engine(&engine(outcome));
    match outcome.stopped_at_s {
        Some(t) => format!("{name}, to {} s", words::short(t)),
        None => name,
    }
}

/// The look of the outcome's engine.
fn stroke(report: &Report, outcome: &Outcome) -> Stroke {
    let alike = report.outcomes().iter().filter(|o| o.kind == outcome.kind);
    let engines = alike.map(|o| &o.engine);
    let before: BTreeSet<&String> = engines.take_while(|e| **e != outcome.engine).collect();
    let own = report.header.is_own(&outcome.engine);
    let place = palette::place(outcome.kind, &outcome.engine, before.len());
    look(outcome.kind, place, own)
}

/// Whether a run may leave the picture: it is unfinished or gains energy.
fn is_wild(outcome: &Outcome) -> bool {
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

/// The figures of `run` and `compare`.
pub const FIGURES: &[Figure<Report>] = &[
    ("plot.svg", "the curve the scene asks for", plot),
    ("error.svg", "distance from the truth over time", errors),
    ("energy.svg", "energy balance over time", energy),
    ("rods.svg", "error of the rods' lengths over time", rods),
    ("trajectories.svg", "trajectories", trajectories),
];
