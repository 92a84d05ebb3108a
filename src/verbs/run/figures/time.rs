//! Figures over time: the scene's `plot`, distance from the truth, energy, lengths of rods.

use super::panels::{Paths, Runs, by_timestep, curves, over_time};
use crate::report::svg::{
    Chart, ChartAxis, FAINT, HUGE, LegendEntry, Look, Mark, Polyline, Scale, Stroke, padded, range,
    shortened,
};
use crate::report::words;
use crate::solvers::Status;
use crate::verbs::Report;
use crate::verbs::run::{Curves, TruthCurves};

/// The largest ratio of two energy amplitudes that a linear axis shows.
const MAX_RATIO: f64 = 50.0;

/// The scene's `plot`, over the range the scene states, else over that of the calm runs.
pub fn plot(report: &Report) -> Option<Chart> {
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
pub fn errors(report: &Report) -> Option<Chart> {
    let floor = 10.0 * report.header.truth.error_bound_m.unwrap_or_default();
    let titles = [
        "distance from the truth over time",
        "largest distance of a particle (m)",
    ];
    sizes(report, titles, floor, |run| &run.errors)
}

/// The error of the rods' lengths over time; what is 0 or below rounding lies on the lower edge.
pub fn rods(report: &Report) -> Option<Chart> {
    let titles = [
        "length of rods off by, over time",
        "largest error of a length (m)",
    ];
    sizes(report, titles, 0.0, |run| &run.rods)
}

/// The size of the energy's error: where lines of the other figure lie on each other, this one tells them apart.
pub fn energy_error(report: &Report) -> Option<Chart> {
    let y_title = match report.header.scene.energy_scale_j {
        Some(_) => "|B − B(0)| / S",
        None => "|B − B(0)|  (J)",
    };
    let titles = ["size of the energy error over time", y_title];
    sizes(report, titles, 0.0, |run| &run.energy)
}

/// Sizes over time on a logarithmic axis, without the start, which is the scene's; a `floor` is drawn where there is one.
fn sizes(
    report: &Report,
    titles: [&str; 2],
    floor: f64,
    values: impl Fn(&Curves) -> &[f64],
) -> Option<Chart> {
    let least = (0.1 * floor).max(LEAST);
    let panels = by_timestep(
        report,
        |_| Paths::new(),
        |run| match values(run) {
            [] | [_] => Paths::new(),
            [_, later @ ..] => {
                let seen: Vec<f64> = later.iter().map(|size| size.abs().max(least)).collect();
                over_time(run.t.get(1..).unwrap_or_default(), &seen)
            }
        },
    )?;
    let mut chart = curves(report, titles, panels, |panel| {
        // What ended early may leave the picture, where others did not.
        let whole = panel
            .spans(1)
            .filter(|(o, _)| o.status == Status::Completed);
        let whole = range(whole.flat_map(|(_, span)| span));
        let [lo, hi] = whole.unwrap_or_else(|| panel.shown(1, None));
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

/// Where errors are those of the truth.
const FLOOR: Stroke = Stroke::new(FAINT, "3 3", 1.0);

/// The smallest size that is drawn.
const LEAST: f64 = 1e-17;

/// Energy over time; its truth is the zero line.
pub fn energy(report: &Report) -> Option<Chart> {
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
