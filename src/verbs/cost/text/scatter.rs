//! The work-precision diagram in characters: each setting is its engine's letter, both axes are
//! logarithmic.

use super::{answer, is_timed};
use crate::report::svg::{ChartAxis, Scale, range};
use crate::report::terminal::{Tone, clip, mark, wrap};
use crate::report::words;
use crate::verbs::Report;
use crate::verbs::cost::diagram::Diagram;
use crate::verbs::cost::{Cost, CostCurve};

/// Height of the field, characters.
const LINES: usize = 22;
/// Width of the labels right of the field, characters.
const BESIDE: usize = 20;
/// The most engines that are drawn; more cannot be told apart.
const MOST: usize = 8;
/// Width of the labels left of the field, characters.
const LABEL: usize = 7;
/// The fewest characters from one label below the axis to the next.
const MIN_LABEL_GAP: f64 = 10.0;

/// One engine's letter and its settings as logarithms of cost and error.
struct Engine {
    letter: char,
    name: String,
    tone: Option<Tone>,
    points: Vec<[f64; 2]>,
}

/// Whole decades around logarithms; the axis is linear in them.
fn decades(logarithms: impl Iterator<Item = f64>) -> Option<ChartAxis> {
    let [lo, hi] = range(logarithms)?;
    let first = lo.floor();
    Some(ChartAxis {
        scale: Scale::Linear,
        range: [first, hi.ceil().max(first + 1.0)],
    })
}

/// The cell of a logarithm among `count` along the axis; None outside.
fn place(axis: ChartAxis, logarithm: f64, count: usize) -> Option<usize> {
    let part = axis.place(logarithm);
    let inside = (0.0..=1.0).contains(&part);
    inside.then(|| (part * (count - 1) as f64).round() as usize)
}

/// Every n-th decade, so that they stand at least `apart` of `count` characters from each other.
fn labelled(axis: ChartAxis, count: usize, apart: f64) -> impl Iterator<Item = i32> {
    let [first, last] = axis.range.map(|end| end as i32);
    let each = (count - 1) as f64 / f64::from(last - first);
    let every = (apart / each).ceil().max(1.0) as i32;
    (first..=last).filter(move |decade| decade.rem_euclid(every) == 0)
}

/// The characters of the diagram with their tones, the highest row first.
struct Field {
    rows: Vec<Vec<(char, Option<Tone>)>>,
    /// The width of a row, characters.
    width: usize,
    /// The label beside each row.
    beside: [String; LINES],
    axes: [ChartAxis; 2],
}

impl Field {
    fn row(&self, error: f64) -> Option<usize> {
        Some(LINES - 1 - place(self.axes[1], error, LINES)?)
    }

    /// Draws a line across the field. A row keeps its first label.
    fn level(&mut self, error: f64, symbol: char, label: String) {
        if let Some(row) = self.row(error.log10()).filter(|_| error > 0.0) {
            self.rows[row].fill((symbol, Some(Tone::Dim)));
            if self.beside[row].is_empty() {
                self.beside[row] = label;
            }
        }
    }

    /// Names a curve beside the row of its smallest error, or the nearest free one.
    fn name(&mut self, engine: &Engine) {
        let errors = engine.points.iter().map(|[_, error]| *error);
        let end = errors.reduce(f64::min).and_then(|error| self.row(error));
        let free = |row: &usize| self.beside[*row].is_empty();
        let near = |row: &usize| end.map_or(usize::MAX, |end| end.abs_diff(*row));
        if let Some(row) = (0..LINES).filter(free).min_by_key(near) {
            self.beside[row] = format!("{} {}", engine.letter, engine.name);
        }
    }

    /// Draws a letter, unless another stands there.
    fn point(&mut self, [cost, error]: [f64; 2], engine: &Engine) {
        if let Some(column) = place(self.axes[0], cost, self.width)
            && let Some(row) = self.row(error)
        {
            let place = &mut self.rows[row][column];
            if !place.0.is_alphanumeric() {
                *place = (engine.letter, engine.tone);
            }
        }
    }

    /// The rows with the axis of errors. Neighbours of equal tone are one mark.
    fn lines(&self) -> impl Iterator<Item = String> {
        let mut labels = [const { String::new() }; LINES];
        for decade in labelled(self.axes[1], LINES, 2.0) {
            if let Some(row) = self.row(f64::from(decade)) {
                labels[row] = clip(&format!("1e{decade}"), LABEL);
            }
        }
        let rows = self.rows.iter().zip(labels).zip(&self.beside);
        rows.map(|((row, label), beside)| {
            let runs = row.chunk_by(|a, b| a.1 == b.1).map(|run| {
                let text: String = run.iter().map(|(symbol, _)| symbol).collect();
                run[0].1.map_or(text.clone(), |tone| mark(tone, &text))
            });
            let text: String = runs.collect();
            let tick = if label.is_empty() { '│' } else { '┤' };
            let beside = clip(beside, BESIDE);
            let line = format!("{label:>LABEL$}{tick}{text} {}", mark(Tone::Dim, &beside));
            line.trim_end().to_owned()
        })
    }
}

/// The diagram with its legend, in a terminal of this width; nothing where no setting has both an error and a cost.
pub fn plot(report: &Report, cost: &Cost, columns: usize) -> Vec<String> {
    let mut points = cost.curves.iter().flat_map(|curve| &curve.points);
    let judged = points.any(|point| point.error_m.is_some());
    let timed = is_timed(cost);
    let engines = engines(report, cost, Diagram { judged, timed });
    let all = || engines.iter().flat_map(|engine| &engine.points);
    let targets = || cost.targets.iter().filter(|_| judged);
    let marked = targets().map(|target| target.error_m).filter(|e| *e > 0.0);
    let errors = all().map(|p| p[1]).chain(marked.map(f64::log10));
    let [Some(x), Some(y)] = [decades(all().map(|p| p[0])), decades(errors)] else {
        return Vec::new();
    };
    let width = columns.saturating_sub(LABEL + 2 + BESIDE).max(2);
    let mut field = Field {
        rows: vec![vec![(' ', None); width]; LINES],
        width,
        beside: [const { String::new() }; LINES],
        axes: [x, y],
    };
    for target in targets() {
        field.level(target.error_m, '┈', answer::label(target));
    }
    let floor = cost.floor_m.filter(|_| judged);
    if let Some(floor) = floor {
        field.level(floor, '═', "floor".to_owned());
    }
    for engine in &engines {
        for point in &engine.points {
            field.point(*point, engine);
        }
        field.name(engine);
    }
    let error = ["energy error", "error (m)"][usize::from(judged)];
    let over = ["force evaluations", "wall time (median)"][usize::from(timed)];
    let mut lines = vec![String::new(), format!("{error} over {over}")];
    lines.extend(field.lines());
    lines.extend(rule(x, timed, width));
    let measured = |curve: &&CostCurve| curve.points.iter().any(|p| p.error_m.is_some());
    let measured = cost.curves.iter().filter(measured).count();
    let left_out = measured.saturating_sub(engines.len());
    lines.extend(legend(left_out, floor.is_some(), columns));
    lines
}

/// The engines to show, those that matter most: the scene's own, the first of each target's ranking in turn, a
/// reference engine, then the others. They stand as listed, the scene's own first.
fn shown<'a>(report: &Report, cost: &'a Cost) -> Vec<&'a str> {
    let own = cost
        .curves
        .iter()
        .filter(|curve| report.header.is_own(&curve.engine));
    let reference = cost
        .curves
        .iter()
        .filter(|curve| !curve.is_ranked())
        .take(1);
    let ranks = cost.targets.iter().map(|target| target.ranking.len()).max();
    let nth = |place: usize| {
        cost.targets
            .iter()
            .filter_map(move |target| target.ranking.get(place))
    };
    let ranked = (0..ranks.unwrap_or(0))
        .flat_map(nth)
        .map(|rank| rank.engine.as_str());
    let first = own.chain(reference).map(|curve| curve.engine.as_str());
    let all = cost.curves.iter().map(|curve| curve.engine.as_str());
    let mut shown: Vec<&str> = Vec::new();
    for engine in first.chain(ranked).chain(all) {
        if shown.len() < MOST && !shown.contains(&engine) {
            shown.push(engine);
        }
    }
    shown
}

/// The engines that are [`shown`] and have points. Integrators have small letters, reference engines capitals.
fn engines(report: &Report, cost: &Cost, diagram: Diagram) -> Vec<Engine> {
    let own = |curve: &CostCurve| report.header.is_own(&curve.engine);
    let shown = shown(report, cost);
    let curves = cost.curves.iter();
    let mut curves: Vec<&CostCurve> = curves
        .filter(|curve| shown.contains(&curve.engine.as_str()))
        .collect();
    curves.sort_by_key(|curve| !own(curve));
    let (mut small, mut capital) = ('a'..='z', 'A'..='Z');
    let engines = curves.into_iter().filter_map(|curve| {
        let log = |value: f64| (value > 0.0).then(|| value.log10());
        let points = curve.points.iter();
        let points = points.filter_map(|p| Some([log(diagram.cost(p)?)?, log(diagram.error(p)?)?]));
        let points: Vec<[f64; 2]> = points.collect();
        if points.is_empty() {
            return None;
        }
        let (letter, tone) = match curve.is_ranked() {
            true => (small.next(), own(curve).then_some(Tone::Strong)),
            false => (capital.next(), Some(Tone::Warn)),
        };
        Some(Engine {
            letter: letter.unwrap_or('0'),
            name: words::one_line(&curve.engine),
            tone,
            points,
        })
    });
    engines.collect()
}

/// The rule below the field and its labels.
fn rule(x: ChartAxis, timed: bool, width: usize) -> [String; 2] {
    let mut rule = vec!['─'; width];
    let mut labels = String::new();
    for decade in labelled(x, width, MIN_LABEL_GAP) {
        let Some(column) = place(x, f64::from(decade), width) else {
            continue;
        };
        rule[column] = '┴';
        let label = power(decade, timed);
        // The label is centred on its tick, as far as the one before leaves room.
        let middle = (LABEL + 1 + column).saturating_sub(label.chars().count() / 2);
        let gap = middle.saturating_sub(labels.chars().count());
        labels += &" ".repeat(gap);
        labels += &label;
    }
    let rule: String = rule.into_iter().collect();
    [
        format!("{:>LABEL$}└{rule}", ""),
        clip(&labels, LABEL + 1 + width + BESIDE),
    ]
}

/// The label of a power of ten, in seconds or evaluations.
fn power(decade: i32, timed: bool) -> String {
    let unit = match decade.div_euclid(3) {
        -3 => "ns",
        -2 => "µs",
        -1 => "ms",
        0 if decade < 3 => "s",
        _ => "",
    };
    match (timed, unit) {
        (false, _) => format!("1e{decade}"),
        (true, "") => format!("1e{decade} s"),
        (true, unit) => format!("{} {unit}", 10_i32.pow(decade.rem_euclid(3) as u32)),
    }
}

fn legend(left_out: usize, floor: bool, columns: usize) -> Vec<String> {
    let floor = if floor { " | ═ floor" } else { "" };
    let more = match left_out {
        0 => String::new(),
        n => format!(
            " | {} in the report",
            words::plural(n as u64, "more engine")
        ),
    };
    let about = format!("where several meet, the first of them is shown | ┈ target{floor}{more}");
    let about = wrap(&about, columns, "").into_iter();
    about.map(|line| mark(Tone::Dim, &line)).collect()
}
