//! Work-precision diagrams: error over cost, both axes logarithmic. Each engine is a line with a point for
//! each setting.

use crate::report::svg::palette::{COLOURS, SHAPES, look, place};
use crate::report::svg::{
    self, Chart, ChartAxis, FAINT, LegendEntry, Look, Mark, Panel, Stroke, Symbol, SymbolShape,
    WHITE, engine, heading, palette, range, shortened,
};
use crate::solvers::{SolverKind, Status};
use crate::verbs::Report;
use crate::verbs::cost::diagram::Diagram;
use crate::verbs::cost::text::{is_timed, metres};
use crate::verbs::cost::{Cost, CostCurve, CostPoint};

/// The values an axis may hold: nothing overflows within.
const SMALLEST: f64 = 1e-250;
const LARGEST: f64 = 1e250;

/// Error over wall time.
pub fn time(report: &Report) -> Option<Chart> {
    let (judged, timed) = (true, true);
    chart(report, Diagram { judged, timed })
}

/// Error over force evaluations.
pub fn evaluations(report: &Report) -> Option<Chart> {
    let (judged, timed) = (true, false);
    chart(report, Diagram { judged, timed })
}

/// Energy error over time, or over evaluations where nothing was timed.
pub fn energy(report: &Report) -> Option<Chart> {
    let (judged, timed) = (false, is_timed(report.cost()?));
    chart(report, Diagram { judged, timed })
}

/// One engine's part of a diagram.
struct EngineLine<'a> {
    curve: &'a CostCurve,
    look: (Stroke, SymbolShape),
    /// Index into the curve's points, and cost and error, of each setting that has both.
    points: Vec<(usize, [f64; 2])>,
    /// The costs that runs which ended early would have had.
    ended: Vec<f64>,
}

/// The diagram, where some setting has both an error and a cost.
fn chart(report: &Report, diagram: Diagram) -> Option<Chart> {
    let cost = report.cost()?;
    let looks = marked(report, &cost.curves);
    let lines = cost
        .curves
        .iter()
        .zip(looks)
        .map(|(curve, look)| EngineLine {
            curve,
            look,
            points: points(curve, diagram),
            ended: ended(curve, diagram),
        });
    let (mut lines, silent): (Vec<_>, Vec<_>) = lines.partition(|line| !line.points.is_empty());
    if lines.is_empty() {
        return None;
    }
    let targets = cost.targets.iter().map(|target| target.error_m);
    let targets = targets.filter(|error| diagram.judged && *error > 0.0);
    let targets: Vec<f64> = targets.collect();
    let placed = || lines.iter().flat_map(|line| &line.points);
    let costs = placed().map(|(_, [cost, _])| *cost);
    let ended = lines.iter().flat_map(|line| &line.ended).copied();
    let errors = placed().map(|(_, [_, error])| *error);
    let errors = errors.chain(targets.iter().copied());
    let axes = [axis(costs.chain(ended)), axis(errors)];
    let mut marks = levels(cost, &targets, axes, diagram);
    // The scene's own comes last, so that its line lies over the others.
    lines.sort_by_key(|line| report.header.is_own(&line.curve.engine));
    marks.extend(lines.iter().flat_map(|line| line.marks(axes, diagram)));
    let legend = legend(diagram, &lines, &marks);
    let silent = silent.iter().map(|line| engine(&line.curve.engine));
    let silent: Vec<String> = silent.collect();
    let note = format!("without numbers for this: {}", silent.join(", "));
    let note = (!silent.is_empty()).then(|| shortened(&note, 130));
    let paid = match diagram.timed {
        true => ["time", "wall time of a run, median (s)"],
        false => ["force evaluations", "force evaluations of a run"],
    };
    let accuracy = format!("what accuracy costs in {}", paid[0]);
    let [title, error] = match diagram.judged {
        true => [&accuracy, "largest error (m)"],
        false => ["what energy accuracy costs", "largest |B − B(0)| / S"],
    };
    Some(Chart {
        title: heading(&report.header, title),
        legend,
        titles: [paid[1], error].map(str::to_owned),
        panels: vec![Panel::new(String::new(), 430.0, axes, marks)],
        note: note.unwrap_or_default(),
        ..Chart::default()
    })
}

/// The width of the bars that show the spread of times, pixels: no other line is as thin.
const WHISKER: f64 = 0.9;

fn points(curve: &CostCurve, diagram: Diagram) -> Vec<(usize, [f64; 2])> {
    let points = curve.points.iter().enumerate();
    let completed = points.filter(|(_, point)| point.status == Status::Completed);
    let placed = completed.filter_map(|(at, point)| {
        let cost = diagram.cost(point).filter(|cost| *cost > 0.0)?;
        let error = diagram.error(point)?.clamp(0.0, LARGEST);
        Some((at, [cost.clamp(SMALLEST, LARGEST), error]))
    });
    placed.collect()
}

/// The costs that runs which diverged or failed would have had. Each is scaled from the nearest finer run
/// that completed: a step costs the same.
fn ended(curve: &CostCurve, diagram: Diagram) -> Vec<f64> {
    let cost = |(at, point): (usize, &CostPoint)| {
        let early = matches!(point.status, Status::Diverged | Status::Failed);
        let finer = curve.points.iter().skip(at + 1);
        let (paid, step) = finer
            .filter(|other| other.status == Status::Completed)
            .find_map(|other| Some((diagram.cost(other)?, other.timestep)))
            .filter(|_| early)?;
        let cost = paid * (step / point.timestep);
        (cost > SMALLEST && cost < LARGEST).then_some(cost)
    };
    curve.points.iter().enumerate().filter_map(cost).collect()
}

/// The axis of these values, with at most half a decade of room on both sides; a lone value stands in the
/// middle of a decade.
fn axis(values: impl Iterator<Item = f64>) -> ChartAxis {
    let positive = values.filter(|v| *v > 0.0);
    let [lo, hi] = range(positive).unwrap_or([1.0, 1.0]);
    let [lo, hi] = [lo, hi].map(|end| end.clamp(SMALLEST, LARGEST));
    let room = 10_f64.powf((0.04 * (hi.log10() - lo.log10())).clamp(0.05, 0.5));
    let room = if hi < 2.0 * lo { 3.0 } else { room };
    ChartAxis::logarithmic([lo / room, hi * room])
}

impl EngineLine<'_> {
    fn marks(&self, [x, y]: [ChartAxis; 2], diagram: Diagram) -> Vec<Mark> {
        let (stroke, shape) = self.look;
        let solid = Symbol::new(shape, stroke.colour, stroke.colour);
        // An error of 0 lies on the lower edge.
        let points = self.points.iter();
        let points = points.map(|(at, [cost, error])| (*at, [*cost, error.max(y.range[0])]));
        let mut line = svg::Polyline::new(points.clone().map(|(_, point)| point), stroke);
        let slope = self.curve.observed_order;
        let slope = slope.filter(|slope| diagram.judged && slope.abs() < 99.5);
        let slope = slope.map_or(String::new(), |slope| format!(", slope {slope:.2}"));
        let name = engine(&self.curve.engine);
        line.label = Some(LegendEntry::new(name + &slope, Look::Marked(stroke, solid)));

        let mut marks = vec![Mark::Line(line)];
        for (at, point) in points {
            let wall = self.curve.points.get(at).and_then(|p| p.wall_s.as_ref());
            if let Some(wall) = wall.filter(|_| diagram.timed) {
                let ends = [wall.min, wall.median + wall.mad.unwrap_or(0.0)];
                let ends = ends.map(|end| end.max(SMALLEST));
                // A whisker shorter than the symbol would not show.
                if x.place(ends[1]) - x.place(ends[0]) > 0.02 {
                    let thin = Stroke::new(stroke.colour, "", WHISKER);
                    marks.push(Mark::line(ends.map(|end| [end, point[1]]), thin));
                }
            }
            let filled = !diagram.judged || self.curve.pareto.contains(&at);
            let fill = if filled { stroke.colour } else { WHITE };
            let symbol = Symbol::new(shape, fill, stroke.colour);
            marks.push(Mark::Symbols(symbol, vec![point]));
        }
        let ended = self.ended.iter().map(|cost| [*cost, y.at(0.985)]);
        marks.push(Mark::Symbols(Symbol::cross(stroke.colour), ended.collect()));
        marks
    }
}

/// A grey area below the floor, and a line for each target.
fn levels(cost: &Cost, targets: &[f64], [x, y]: [ChartAxis; 2], diagram: Diagram) -> Vec<Mark> {
    let [[left, right], [bottom, _]] = [x.range, y.range];
    let mut marks = Vec::new();
    let floor = cost
        .floor_m
        .filter(|floor| diagram.judged && *floor > bottom);
    if let Some(floor) = floor {
        let below = [[left, bottom], [right, floor]];
        marks.push(Mark::Area(palette::BELOW_FLOOR, vec![below]));
    }
    for &error in targets {
        let ends = [[left, error], [right, error]];
        marks.push(Mark::line(ends, palette::TARGET));
        marks.push(Mark::Text(ends[0], format!("{} m", metres(error))));
    }
    marks
}

/// The legend of the symbols, of the whiskers and of the grey area.
fn legend(diagram: Diagram, lines: &[EngineLine], marks: &[Mark]) -> Vec<LegendEntry> {
    let disc = |fill| Look::Symbol(Symbol::new(SymbolShape::Disc, fill, FAINT));
    let fills = |white: bool| {
        let mut symbols = marks.iter().filter_map(|mark| match mark {
            Mark::Symbols(symbol, points) if !points.is_empty() => Some(symbol),
            _ => None,
        });
        symbols.any(|symbol| symbol.shape != SymbolShape::Cross && (symbol.fill == WHITE) == white)
    };
    let whisker = |mark: &Mark| matches!(mark, Mark::Line(line) if line.stroke.width == WHISKER);
    let mut legend = Vec::new();
    let mut add = |shown: bool, text: &str, look| {
        legend.extend(shown.then(|| LegendEntry::new(text, look)));
    };
    let front = "none of its settings beats it in error and evaluations";
    add(diagram.judged && fills(false), front, disc(FAINT));
    add(diagram.judged && fills(true), "beaten", disc(WHITE));
    let early = lines.iter().any(|line| !line.ended.is_empty());
    let cross = Look::Symbol(Symbol::cross(FAINT));
    add(
        early,
        "diverged or failed, at what all its steps would cost",
        cross,
    );
    let spread = "bars: from the shortest run to the median and its deviation";
    add(marks.iter().any(whisker), spread, Look::Remark);
    let below = Look::Fill(palette::BELOW_FLOOR);
    add(true, "below the truth’s own error", below);
    legend
}

/// The stroke and the symbol of each curve. Integrators of one colour differ in their symbols, so that only
/// reference engines are dashed.
fn marked(report: &Report, curves: &[CostCurve]) -> Vec<(Stroke, SymbolShape)> {
    let look = |(at, curve): (usize, &CostCurve)| {
        let before = curves.iter().take(at);
        let among = before.filter(|other| other.kind == curve.kind).count();
        let place = place(curve.kind, &curve.engine, among);
        let own = report.header.is_own(&curve.engine);
        let mut stroke = look(curve.kind, place, own);
        if curve.kind == SolverKind::Integrator {
            stroke.dash = "";
            return (stroke, SHAPES[place / COLOURS.len() % SHAPES.len()]);
        }
        (stroke, SHAPES[place % SHAPES.len()])
    };
    curves.iter().enumerate().map(look).collect()
}
