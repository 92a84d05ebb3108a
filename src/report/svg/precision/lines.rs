//! What the diagrams show: which numbers over which, one line an engine, and the axes that hold them.

use crate::outcome::{Cost, CostCurve, CostPoint, Report, Status};
use crate::report::svg::canvas::{Mark, Stroke};
use crate::report::svg::palette;
use crate::report::svg::range;
use crate::report::svg::scale::Axis;

/// What an axis may hold: nothing overflows within.
pub const SMALLEST: f64 = 1e-250;
const LARGEST: f64 = 1e250;

/// What is drawn over what.
#[derive(Clone, Copy)]
pub struct Diagram {
    pub title: &'static str,
    pub x_title: &'static str,
    pub y_title: &'static str,
    pub cost: fn(&CostPoint) -> Option<f64>,
    pub error: fn(&CostPoint) -> Option<f64>,
    /// Whether the error is the one targets, floor, front and slope are about.
    pub judged: bool,
    /// Whether the cost is a time, which has a spread.
    pub timed: bool,
}

/// Error over time.
pub const TIME: Diagram = Diagram {
    title: "what accuracy costs in time",
    x_title: "wall time of a run, median (s)",
    y_title: "largest error (m)",
    cost: time,
    error: |point| point.error_m,
    judged: true,
    timed: true,
};

/// Error over force evaluations.
pub const EVALUATIONS: Diagram = Diagram {
    title: "what accuracy costs in force evaluations",
    x_title: "force evaluations of a run",
    cost: count,
    timed: false,
    ..TIME
};

/// Energy error over time, or over evaluations where nothing was timed.
pub fn energy(report: &Report) -> Diagram {
    let curves = report.cost.iter().flat_map(|cost| &cost.curves);
    let mut points = curves.flat_map(|curve| &curve.points);
    let base = if points.any(|point| time(point).is_some()) {
        TIME
    } else {
        EVALUATIONS
    };
    Diagram {
        title: "what energy accuracy costs",
        y_title: "largest |B − B(0)| / S",
        error: |point| point.energy_error,
        judged: false,
        ..base
    }
}

fn time(point: &CostPoint) -> Option<f64> {
    point.wall_s.as_ref().map(|wall| wall.median)
}

fn count(point: &CostPoint) -> Option<f64> {
    point.force_evaluations.map(|count| count as f64)
}

/// One engine's line, in values.
pub struct Line<'a> {
    pub curve: &'a CostCurve,
    pub stroke: Stroke,
    pub mark: Mark,
    /// Index into the curve's points, cost, and error.
    pub points: Vec<(usize, [f64; 2])>,
    /// What runs that ended early would have cost.
    pub ended: Vec<f64>,
}

/// Whether some setting has both an error and a cost.
pub fn wanted(report: &Report, diagram: Diagram) -> bool {
    !lines(report, diagram).is_empty()
}

/// The curves with something to show, in their order.
pub fn lines(report: &Report, diagram: Diagram) -> Vec<Line<'_>> {
    let Some(cost) = &report.cost else {
        return Vec::new();
    };
    let looks = palette::marked(report, &cost.curves).into_iter();
    cost.curves
        .iter()
        .zip(looks)
        .filter_map(|(curve, (stroke, mark))| {
            let points = points(curve, diagram);
            (!points.is_empty()).then(|| Line {
                ended: ended(curve, diagram),
                curve,
                stroke,
                mark,
                points,
            })
        })
        .collect()
}

fn points(curve: &CostCurve, diagram: Diagram) -> Vec<(usize, [f64; 2])> {
    let place = |(at, point): (usize, &CostPoint)| {
        let completed = point.status == Status::Completed;
        let cost = (diagram.cost)(point).filter(|cost| *cost > 0.0 && completed)?;
        // An error of 0 lies on the lower edge.
        let error = (diagram.error)(point)?.max(0.0);
        Some((at, [cost.clamp(SMALLEST, LARGEST), error.min(LARGEST)]))
    };
    curve.points.iter().enumerate().filter_map(place).collect()
}

/// What runs that diverged or failed would have cost, by the nearest finer one that completed: a step
/// costs the same.
fn ended(curve: &CostCurve, diagram: Diagram) -> Vec<f64> {
    let cost = |(at, point): (usize, &CostPoint)| {
        let early = matches!(point.status, Status::Diverged | Status::Failed);
        let finer = curve.points.iter().skip(at + 1);
        let (paid, step) = finer
            .filter(|other| other.status == Status::Completed)
            .find_map(|other| Some(((diagram.cost)(other)?, other.timestep)))
            .filter(|_| early)?;
        let cost = paid * (step / point.timestep);
        (cost > SMALLEST && cost < LARGEST).then_some(cost)
    };
    curve.points.iter().enumerate().filter_map(cost).collect()
}

/// Everything of a line that has a place along the cost.
pub fn costs<'a>(line: &'a Line) -> impl Iterator<Item = f64> + 'a {
    let points = line.points.iter().map(|(_, [cost, _])| *cost);
    points.chain(line.ended.iter().copied())
}

/// Half a decade more than the values span, at most; a lone value in the middle of a decade.
pub fn axis(values: impl Iterator<Item = f64>) -> Axis {
    let positive = values.filter(|v| *v > 0.0);
    let [lo, hi] = range::range(positive).unwrap_or([1.0, 1.0]);
    let [lo, hi] = [lo, hi].map(|end| end.clamp(SMALLEST, LARGEST));
    let room = 10_f64.powf((0.04 * (hi.log10() - lo.log10())).clamp(0.05, 0.5));
    let room = if hi < 2.0 * lo { 3.0 } else { room };
    Axis::logarithmic([lo / room, hi * room])
}

/// What the errors and the targets span.
pub fn errors(cost: &Cost, lines: &[Line], diagram: Diagram) -> Axis {
    let errors = lines.iter().flat_map(|line| &line.points);
    let errors = errors.map(|(_, [_, error])| *error);
    let targets = cost.targets.iter().map(|target| target.error_m);
    axis(errors.chain(targets.filter(|_| diagram.judged)))
}
